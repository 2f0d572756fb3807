//! Single flexible joint of the paper's example (SK15 section 6.1, eqs. (20)-(22)).

use frfid_signals::SignalError;
use frfid_signals::checks::{channels, positive};

use crate::error::PlantError;
use crate::joint::flexible_joint::FlexibleJoint;
use crate::joint::friction::Friction;
use crate::joint::spring::Spring;
use crate::motion::Motion;
use crate::motion::equations::Machine;
use crate::motion::exact::Exact;
use crate::motion::integrator::Integrator;
use crate::motion::links::SingleLink;
use crate::motion::mechanics::Mechanics;
use crate::robot::Robot;
use crate::state_space::StateSpace;

/// One motor and one link with a gear between them; everything on the joint side of the gear.
///
/// J_m qm'' = u - tau_f(qm') - ripple(qm) - tau_s(dq) - d dq', J_o qo'' = tau_s(dq) + d dq', dq = qm
/// - qo (SK15 eqs. (20)-(22)); u is the motor torque, y = qm' the motor velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct SingleJoint {
    /// Motor and gear.
    pub joint: FlexibleJoint,
    /// Inertia J_o of the link in kg m^2.
    pub link_inertia_kg_m2: f64,
}

/// The example of SK15 section 6.1 with its nonlinearities off: F_c = 0, k2 = k1.
impl Default for SingleJoint {
    fn default() -> Self {
        Self {
            joint: FlexibleJoint {
                motor_inertia_kg_m2: 35.0,
                damping_nms_per_rad: 400.0,
                spring: Spring::default(),
                friction: Friction {
                    coulomb_nm: 0.0,
                    viscous_nms_per_rad: 0.0,
                },
                ripple: Vec::new(),
            },
            link_inertia_kg_m2: 150.0,
        }
    }
}

impl SingleJoint {
    /// The joint as a machine of one axis, ready to move.
    pub(crate) fn machine(&self) -> Machine<SingleLink, 1> {
        Machine {
            joints: [self.joint.clone()],
            links: SingleLink {
                mobility: 1.0 / self.link_inertia_kg_m2,
            },
        }
    }
}

impl Robot for SingleJoint {
    fn n_axes(&self) -> usize {
        1
    }

    fn check(&self) -> Result<(), SignalError> {
        positive("link_inertia_kg_m2", self.link_inertia_kg_m2)?;
        self.joint.check()
    }

    fn fastest_rad_s(&self) -> f64 {
        let FlexibleJoint {
            motor_inertia_kg_m2,
            damping_nms_per_rad,
            spring,
            friction,
            ..
        } = &self.joint;
        let compliance = 1.0 / motor_inertia_kg_m2 + 1.0 / self.link_inertia_kg_m2;
        let resonance = (spring.stiffest_nm_per_rad() * compliance).sqrt();
        let viscous = friction.viscous_nms_per_rad / motor_inertia_kg_m2;
        let decay = damping_nms_per_rad * compliance + viscous;
        resonance.max(decay)
    }

    /// 0.0075 over the fastest rate of the joint, 1e-4 s for the paper's, which keeps the linear FRF
    /// within about 1e-10 of the truth: RK4 errs by (rate step)^4 / 120 of a state.
    fn default_step_s(&self) -> f64 {
        0.0075 / self.fastest_rad_s()
    }

    /// Its pose is position 0.
    fn start(
        &self,
        start_rad: &[f64],
        velocity_rad_s: &[f64],
    ) -> Result<Box<dyn Motion>, PlantError> {
        self.check()?;
        let position_rad = channels("start_rad", start_rad)?;
        let velocity_rad_s = channels("velocity_rad_s", velocity_rad_s)?;
        Ok(Box::new(Integrator::start(
            self.machine(),
            position_rad,
            velocity_rad_s,
        )))
    }

    fn start_exact(
        &self,
        start_rad: &[f64],
        velocity_rad_s: &[f64],
        step_s: f64,
    ) -> Result<Box<dyn Motion>, PlantError> {
        self.check()?;
        if !self.joint.ripple.is_empty() {
            let found = "this joint has torque ripple";
            return Err(PlantError::NotExact { found });
        }
        let position_rad = channels("start_rad", start_rad)?;
        let velocity_rad_s = channels("velocity_rad_s", velocity_rad_s)?;
        let machine = self.machine();
        let exact = Exact::of(&machine, self.fastest_rad_s(), step_s)?;
        let motion = Integrator::start_by(exact, machine, position_rad, velocity_rad_s);
        Ok(Box::new(motion))
    }

    fn state_space(&self) -> StateSpace {
        (&self.machine() as &dyn Mechanics).state_space(&[0.0])
    }

    fn coulomb_nm(&self) -> Vec<f64> {
        vec![self.joint.friction.coulomb_nm]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::sensor::Sensor;
    use crate::joint::ripple::Ripple;
    use crate::state_space::Hold;

    /// Sets one field of a joint.
    type Setter = fn(&mut SingleJoint, f64);

    #[test]
    fn every_parameter_out_of_range_is_named() {
        assert_eq!(SingleJoint::default().check(), Ok(()));
        let positive: [(&str, Setter); 5] = [
            ("motor_inertia_kg_m2", |joint, x| {
                joint.joint.motor_inertia_kg_m2 = x;
            }),
            ("link_inertia_kg_m2", |joint, x| {
                joint.link_inertia_kg_m2 = x;
            }),
            ("stiffness_nm_per_rad", |joint, x| {
                joint.joint.spring.stiffness_nm_per_rad = x;
            }),
            ("stiffness_beyond_nm_per_rad", |joint, x| {
                joint.joint.spring.stiffness_beyond_nm_per_rad = x;
            }),
            ("knee_rad", |joint, x| joint.joint.spring.knee_rad = x),
        ];
        let not_negative: [(&str, Setter); 5] = [
            ("damping_nms_per_rad", |joint, x| {
                joint.joint.damping_nms_per_rad = x;
            }),
            ("coulomb_nm", |joint, x| joint.joint.friction.coulomb_nm = x),
            ("viscous_nms_per_rad", |joint, x| {
                joint.joint.friction.viscous_nms_per_rad = x;
            }),
            ("cycles_per_turn", |joint, x| {
                joint.joint.ripple.push(Ripple {
                    cycles_per_turn: x,
                    ..RIPPLE
                });
            }),
            ("amplitude_nm", |joint, x| {
                joint.joint.ripple.push(Ripple {
                    amplitude_nm: x,
                    ..RIPPLE
                });
            }),
        ];
        let phase: [(&str, Setter); 1] = [("phase_rad", |joint, x| {
            joint.joint.ripple.push(Ripple {
                phase_rad: x,
                ..RIPPLE
            });
        })];
        let bad = [f64::NAN, f64::INFINITY, -1.0, 0.0];
        for (fields, bad) in [
            (&positive[..], &bad[..]),
            (&not_negative, &bad[..3]),
            (&phase, &bad[..2]),
        ] {
            for (field, set) in fields {
                for &value in bad {
                    let mut joint = SingleJoint::default();
                    set(&mut joint, value);
                    let error = joint.check().expect_err(field);
                    assert!(
                        error.path().last() == Some(field)
                            && error.to_string().contains(&format!("{field} is {value}")),
                        "{error}"
                    );
                }
            }
        }
    }

    const RIPPLE: Ripple = Ripple {
        cycles_per_turn: 1.0,
        amplitude_nm: 1.0,
        phase_rad: 0.0,
    };

    /// Notch, peak (Hz, dB) of the linear joint: where d|P|/df changes sign, by golden-section
    /// search.
    fn extreme(joint: &SingleJoint, low: f64, high: f64, sign: f64) -> (f64, f64) {
        let level = |f: f64| {
            let frf = joint
                .frf(&[f], Hold::Continuous, 1e-3)
                .expect("parameters are sound");
            frf.magnitude_db(0, 0)[0]
        };
        let (mut a, mut b) = (low, high);
        let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
        while b - a > 1e-7 {
            let (left, right) = (b - ratio * (b - a), a + ratio * (b - a));
            if sign * level(left) > sign * level(right) {
                b = right;
            } else {
                a = left;
            }
        }
        (a, level(a))
    }

    #[test]
    fn the_table_of_the_paper_s_example_holds_to_its_printed_digits() {
        let rows = [
            (
                1.5e5,
                [5.0289, -95.0507, 11.6211, -55.6669],
                [-61.5917, -70.0134, -82.1464],
                [-89.968, -81.728, -88.184],
            ),
            (
                2.55e5,
                [6.5590, -99.6399, 15.1254, -55.6740],
                [-61.4729, -66.8261, -81.9519],
                [-89.989, -76.774, -88.125],
            ),
        ];
        for (stiffness_nm_per_rad, extremes, level, phase) in rows {
            let mut joint = SingleJoint::default();
            joint.joint.spring.stiffness_nm_per_rad = stiffness_nm_per_rad;
            let (notch, peak) = (
                extreme(&joint, 4.0, 8.0, -1.0),
                extreme(&joint, 9.0, 20.0, 1.0),
            );
            for (found, printed) in [notch.0, notch.1, peak.0, peak.1].into_iter().zip(extremes) {
                assert!((found - printed).abs() < 0.5001e-4, "{found} for {printed}");
            }
            let frf = joint
                .frf(&[1.0, 20.0, 60.0], Hold::Continuous, 1e-3)
                .expect("sound");
            for (found, printed) in frf.magnitude_db(0, 0).into_iter().zip(level) {
                assert!((found - printed).abs() < 0.5001e-4, "{found} for {printed}");
            }
            for (found, printed) in frf.phase_deg(0, 0).into_iter().zip(phase) {
                assert!((found - printed).abs() < 0.5001e-3, "{found} for {printed}");
            }
        }
    }

    #[test]
    fn differencing_turns_the_phase_by_half_a_sample() {
        let joint = SingleJoint::default();
        let frf = |velocity_by_differencing| {
            let sensor = Sensor {
                velocity_by_differencing,
                ..Sensor::default()
            };
            let frf = joint.frf_through_sensors(&[60.0], Hold::Continuous, 1e-3, &[sensor]);
            frf.expect("sound").response[[0, 0, 0]]
        };
        let ratio = frf(true) / frf(false);
        assert!((ratio.arg().to_degrees() + 10.8).abs() < 1e-9);
    }

    #[test]
    fn frequencies_without_an_answer_are_refused() {
        let frf = |hz| SingleJoint::default().frf(&[hz], Hold::Zoh, 1e-3);
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                frf(hz),
                Err(SignalError::Parameter { key: "hz", .. })
            ));
        }
        let joint = SingleJoint::default();
        assert!(matches!(
            joint.frf(&[1.0], Hold::Zoh, 0.0),
            Err(SignalError::Parameter {
                key: "sample_time_s",
                ..
            })
        ));
    }
}
