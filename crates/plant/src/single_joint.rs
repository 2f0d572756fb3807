//! The single flexible joint of the paper's example (SK15 section 6.1): its parameters.

use frfid_signals::SignalError;
use frfid_signals::checks::positive;
use serde::{Deserialize, Serialize};

use crate::joint::flexible_joint::FlexibleJoint;
use crate::joint::ripple::Ripple;
use crate::joint::spring::Spring;
use crate::motion::equations::{Inertia, Machine};

/// One motor and one link with a gear between them; everything on the joint side of the gear.
///
/// J_m qm'' = u - tau_f(qm') - ripple(qm) - tau_s(dq) - d dq', J_o qo'' = tau_s(dq) + d dq', dq =
/// qm - qo (SK15 eqs. (20)-(22)); u is the motor torque, y = qm' the motor velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SingleJoint {
    /// Inertia J_m of the motor in kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Inertia J_o of the link in kg m^2.
    pub link_inertia_kg_m2: f64,
    /// Damping d of the gear in N m s/rad.
    pub damping_nms_per_rad: f64,
    /// Stiffness k1 of the gear in N m/rad up to the knee: the stiffness of the linear truth.
    pub stiffness_nm_per_rad: f64,
    /// Stiffness k2 beyond the knee in N m/rad.
    pub stiffness_beyond_nm_per_rad: f64,
    /// Deflection in rad at which the stiffness changes.
    pub knee_rad: f64,
    /// Coulomb friction F_c of the motor in N m.
    pub coulomb_nm: f64,
    /// Viscous friction of the motor in N m s/rad.
    pub viscous_nms_per_rad: f64,
    /// Harmonics of the torque ripple; empty for none.
    pub ripple: Vec<Ripple>,
}

/// The example of SK15 section 6.1 with its nonlinearities off: F_c = 0, k2 = k1.
impl Default for SingleJoint {
    fn default() -> Self {
        Self {
            motor_inertia_kg_m2: 35.0,
            link_inertia_kg_m2: 150.0,
            damping_nms_per_rad: 400.0,
            stiffness_nm_per_rad: 1.5e5,
            stiffness_beyond_nm_per_rad: 1.5e5,
            knee_rad: 1e-3,
            coulomb_nm: 0.0,
            viscous_nms_per_rad: 0.0,
            ripple: Vec::new(),
        }
    }
}

impl SingleJoint {
    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] naming the first one that is not finite or out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("link_inertia_kg_m2", self.link_inertia_kg_m2)?;
        self.flexible_joint().check()
    }

    /// Motor and gear, without the link.
    #[must_use]
    pub fn flexible_joint(&self) -> FlexibleJoint {
        FlexibleJoint {
            motor_inertia_kg_m2: self.motor_inertia_kg_m2,
            damping_nms_per_rad: self.damping_nms_per_rad,
            stiffness_nm_per_rad: self.stiffness_nm_per_rad,
            stiffness_beyond_nm_per_rad: self.stiffness_beyond_nm_per_rad,
            knee_rad: self.knee_rad,
            coulomb_nm: self.coulomb_nm,
            viscous_nms_per_rad: self.viscous_nms_per_rad,
            ripple: self.ripple.clone(),
        }
    }

    /// The joint as a machine of one axis, ready to move.
    #[must_use]
    pub fn machine(&self) -> Machine<Inertia, 1> {
        Machine {
            drives: [self.flexible_joint().drive()],
            links: Inertia {
                mobility: 1.0 / self.link_inertia_kg_m2,
            },
        }
    }

    /// The gear's spring.
    #[must_use]
    pub fn spring(&self) -> Spring {
        self.flexible_joint().spring()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sets one field of a joint.
    type Setter = fn(&mut SingleJoint, f64);

    #[test]
    fn every_parameter_out_of_range_is_named() {
        assert_eq!(SingleJoint::default().check(), Ok(()));
        let positive: [(&str, Setter); 5] = [
            ("motor_inertia_kg_m2", |joint, x| {
                joint.motor_inertia_kg_m2 = x
            }),
            ("link_inertia_kg_m2", |joint, x| {
                joint.link_inertia_kg_m2 = x
            }),
            ("stiffness_nm_per_rad", |joint, x| {
                joint.stiffness_nm_per_rad = x
            }),
            ("stiffness_beyond_nm_per_rad", |joint, x| {
                joint.stiffness_beyond_nm_per_rad = x
            }),
            ("knee_rad", |joint, x| joint.knee_rad = x),
        ];
        let not_negative: [(&str, Setter); 5] = [
            ("damping_nms_per_rad", |joint, x| {
                joint.damping_nms_per_rad = x
            }),
            ("coulomb_nm", |joint, x| joint.coulomb_nm = x),
            ("viscous_nms_per_rad", |joint, x| {
                joint.viscous_nms_per_rad = x
            }),
            ("cycles_per_turn", |joint, x| {
                joint.ripple.push(Ripple {
                    cycles_per_turn: x,
                    ..RIPPLE
                })
            }),
            ("amplitude_nm", |joint, x| {
                joint.ripple.push(Ripple {
                    amplitude_nm: x,
                    ..RIPPLE
                })
            }),
        ];
        let phase: [(&str, Setter); 1] = [("phase_rad", |joint, x| {
            joint.ripple.push(Ripple {
                phase_rad: x,
                ..RIPPLE
            })
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
                        error
                            .to_string()
                            .starts_with(&format!("{field} is {value}")),
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
}
