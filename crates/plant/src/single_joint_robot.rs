//! The single joint as a robot, with its linear truth: what an ideal experiment would find (SK15
//! section 6.1, eqs. (20)-(22)).

use frfid_signals::SignalError;
use nalgebra::DMatrix;

use crate::error::PlantError;
use crate::motion::Moving;
use crate::motion::integrator::Motion;
use crate::robot::Robot;
use crate::single_joint::SingleJoint;
use crate::state_space::StateSpace;
use crate::testbed::recorder::channels;

impl Robot for SingleJoint {
    fn n_axes(&self) -> usize {
        1
    }

    fn check(&self) -> Result<(), SignalError> {
        self.check()
    }

    /// 0.0075 over the fastest rate of the joint, 1e-4 s for the paper's, which keeps the linear
    /// FRF within about 1e-10 of the truth: RK4 errs by (rate step)^4 / 120 of a state.
    fn default_step_s(&self) -> f64 {
        let compliance = 1.0 / self.motor_inertia_kg_m2 + 1.0 / self.link_inertia_kg_m2;
        let resonance = (self
            .stiffness_nm_per_rad
            .max(self.stiffness_beyond_nm_per_rad)
            * compliance)
            .sqrt();
        let decay = self.damping_nms_per_rad * compliance
            + self.viscous_nms_per_rad / self.motor_inertia_kg_m2;
        0.0075 / resonance.max(decay)
    }

    /// Its pose is position 0.
    fn start(
        &self,
        start_rad: &[f64],
        velocity_rad_s: &[f64],
    ) -> Result<Box<dyn Moving>, PlantError> {
        self.check()?;
        let position_rad = channels("start_rad", start_rad)?;
        let velocity_rad_s = channels("velocity_rad_s", velocity_rad_s)?;
        Ok(Box::new(Motion::start(
            self.machine(),
            position_rad,
            velocity_rad_s,
        )))
    }

    /// States (qm, dq, qm', qo').
    fn state_space(&self) -> StateSpace {
        let (k, d, viscous) = (
            self.stiffness_nm_per_rad,
            self.damping_nms_per_rad,
            self.viscous_nms_per_rad,
        );
        let (motor, link) = (self.motor_inertia_kg_m2, self.link_inertia_kg_m2);
        #[rustfmt::skip]
        let a = [
            0.0, 0.0, 1.0, 0.0,
            0.0, 0.0, 1.0, -1.0,
            0.0, -k / motor, -(d + viscous) / motor, d / motor,
            0.0, k / link, d / link, -d / link,
        ];
        StateSpace {
            a: DMatrix::from_row_slice(4, 4, &a),
            b: DMatrix::from_row_slice(4, 1, &[0.0, 0.0, 1.0 / motor, 0.0]),
            c: DMatrix::from_row_slice(2, 4, &[0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
            d: DMatrix::zeros(2, 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::sensor::Velocity;
    use crate::state_space::Hold;

    /// Notch, peak (Hz, dB) of the linear joint: where d|P|/df changes sign, by golden-section
    /// search.
    fn extreme(joint: &SingleJoint, low: f64, high: f64, sign: f64) -> (f64, f64) {
        let level = |f: f64| {
            let frf = joint
                .frf(&[f], Hold::Continuous, 1e-3, Velocity::True)
                .expect("parameters are sound");
            frf.magnitude_db(0, 0)[0]
        };
        let (mut a, mut b) = (low, high);
        let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
        while b - a > 1e-7 {
            let (left, right) = (b - ratio * (b - a), a + ratio * (b - a));
            if sign * level(left) > sign * level(right) {
                b = right
            } else {
                a = left
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
            let joint = SingleJoint {
                stiffness_nm_per_rad,
                ..SingleJoint::default()
            };
            let (notch, peak) = (
                extreme(&joint, 4.0, 8.0, -1.0),
                extreme(&joint, 9.0, 20.0, 1.0),
            );
            for (found, printed) in [notch.0, notch.1, peak.0, peak.1].into_iter().zip(extremes) {
                assert!((found - printed).abs() < 0.5001e-4, "{found} for {printed}");
            }
            let frf = joint
                .frf(&[1.0, 20.0, 60.0], Hold::Continuous, 1e-3, Velocity::True)
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
        let frf = |velocity| {
            joint
                .frf(&[60.0], Hold::Continuous, 1e-3, velocity)
                .expect("sound")
                .response[[0, 0, 0]]
        };
        let ratio = frf(Velocity::Differenced) / frf(Velocity::True);
        assert!((ratio.arg().to_degrees() + 10.8).abs() < 1e-9);
    }

    #[test]
    fn frequencies_without_an_answer_are_refused() {
        let frf = |hz| SingleJoint::default().frf(&[hz], Hold::Zoh, 1e-3, Velocity::True);
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                frf(hz),
                Err(SignalError::Parameter { name: "hz", .. })
            ));
        }
        let joint = SingleJoint::default();
        assert!(joint.frf(&[1.0], Hold::Zoh, 0.0, Velocity::True).is_err());
    }
}
