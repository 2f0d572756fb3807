//! The linear truth of the single joint: what an ideal experiment would find (SK15 section 6.1, eqs. (20)-(22)).

use std::f64::consts::TAU;

use frfid_signals::{Frf, SignalError};
use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::{Hold, SingleJoint, StateSpace, Velocity};

impl SingleJoint {
    /// The linear model from motor torque to motor velocity and motor position, states (qm, dq, qm', qo'). Gear damping
    /// and viscous friction are in it; Coulomb friction, ripple and the stiffness beyond the knee are not.
    #[must_use]
    pub fn state_space(&self) -> StateSpace {
        let (k, d, viscous) = (self.stiffness_nm_per_rad, self.damping_nms_per_rad, self.viscous_nms_per_rad);
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

    /// The exact FRF in rad/s per N m from motor torque to the velocity reading, through a hold of `sample_time_s`.
    ///
    /// A differenced velocity is the FRF of the position times (1 - e^{-s T}) / T, which is exact under every hold.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a parameter of the joint, a frequency or a sample time out of range.
    pub fn frf(&self, hz: &[f64], hold: Hold, sample_time_s: f64, velocity: Velocity) -> Result<Frf, SignalError> {
        self.check()?;
        let StateSpace { a, b, c, d } = self.state_space();
        let output = match velocity {
            Velocity::True => 0,
            Velocity::Differenced => 1,
        };
        let model = StateSpace { a, b, c: c.rows(output, 1).into_owned(), d: d.rows(output, 1).into_owned() };
        let mut frf = model.frf(hz, hold, sample_time_s)?;
        if velocity == Velocity::Differenced {
            for (value, f) in frf.response.iter_mut().zip(hz) {
                *value *= (1.0 - Complex64::cis(-TAU * f * sample_time_s)) / sample_time_s;
            }
        }
        Ok(frf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Notch, peak (Hz, dB) of the linear joint: where d|P|/df changes sign, by golden-section search.
    fn extreme(joint: &SingleJoint, low: f64, high: f64, sign: f64) -> (f64, f64) {
        let level = |f: f64| {
            let frf = joint.frf(&[f], Hold::Continuous, 1e-3, Velocity::True).expect("parameters are sound");
            frf.magnitude_db(0, 0)[0]
        };
        let (mut a, mut b) = (low, high);
        let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
        while b - a > 1e-7 {
            let (left, right) = (b - ratio * (b - a), a + ratio * (b - a));
            if sign * level(left) > sign * level(right) { b = right } else { a = left }
        }
        (a, level(a))
    }

    #[test]
    fn the_table_of_the_paper_s_example_holds_to_its_printed_digits() {
        let rows = [
            (1.5e5, [5.0289, -95.0507, 11.6211, -55.6669], [-61.5917, -70.0134, -82.1464], [-89.968, -81.728, -88.184]),
            (
                2.55e5,
                [6.5590, -99.6399, 15.1254, -55.6740],
                [-61.4729, -66.8261, -81.9519],
                [-89.989, -76.774, -88.125],
            ),
        ];
        for (stiffness_nm_per_rad, extremes, level, phase) in rows {
            let joint = SingleJoint { stiffness_nm_per_rad, ..SingleJoint::default() };
            let (notch, peak) = (extreme(&joint, 4.0, 8.0, -1.0), extreme(&joint, 9.0, 20.0, 1.0));
            for (found, printed) in [notch.0, notch.1, peak.0, peak.1].into_iter().zip(extremes) {
                assert!((found - printed).abs() < 0.5001e-4, "{found} for {printed}");
            }
            let frf = joint.frf(&[1.0, 20.0, 60.0], Hold::Continuous, 1e-3, Velocity::True).expect("sound");
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
        let frf = |velocity| joint.frf(&[60.0], Hold::Continuous, 1e-3, velocity).expect("sound").response[[0, 0, 0]];
        let ratio = frf(Velocity::Differenced) / frf(Velocity::True);
        assert!((ratio.arg().to_degrees() + 10.8).abs() < 1e-9);
    }

    #[test]
    fn frequencies_without_an_answer_are_refused() {
        let frf = |hz| SingleJoint::default().frf(&[hz], Hold::Zoh, 1e-3, Velocity::True);
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(frf(hz), Err(SignalError::Parameter { name: "hz", .. })));
        }
        let joint = SingleJoint::default();
        assert!(joint.frf(&[1.0], Hold::Zoh, 0.0, Velocity::True).is_err());
    }
}
