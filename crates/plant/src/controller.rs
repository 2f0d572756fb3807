//! A sampled PI controller of the motor velocity: the K of SK15 figure 2.

use std::collections::VecDeque;

use frfid_signals::SignalError;
use serde::{Deserialize, Serialize};

use crate::recorder::of_axes;
use frfid_signals::range::{not_negative, positive};

/// u = gain (r - y) + integral, the integral growing by integral_gain (r - y) sample_time_s per sample; one value per axis.
///
/// With a torque limit the integral stands still while the torque is at its limit and the error pushes it further
/// (anti-windup by conditional integration; Astrom, Hagglund, PID Controllers, 1995, section 3.5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PiController {
    /// Proportional gain in N m s/rad.
    pub gain: Vec<f64>,
    /// Integral gain in N m/rad.
    pub integral_gain: Vec<f64>,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Whole samples between reading the velocity at t_k and the torque's acting; 0: from t_k on.
    pub delay_samples: usize,
    /// Largest torque in N m; `None` for no limit.
    pub max_torque_nm: Option<Vec<f64>>,
}

/// The controller at work on one axis.
#[derive(Debug, Clone)]
pub(crate) struct PiAxis {
    gain: f64,
    /// Growth of the integral per sample and unit of error.
    integral_step: f64,
    /// Largest torque in N m, infinite for none.
    max_torque_nm: f64,
    limited: bool,
    integral_nm: f64,
    /// Torques in N m on their way.
    delay: VecDeque<f64>,
}

impl PiController {
    /// Checks every parameter for a robot of `n_axes`.
    ///
    /// # Errors
    /// [`SignalError::Shape`] for another number of axes, [`SignalError::Parameter`] for a gain that is negative, a limit or
    /// sample time that is not above 0, or a number that is not finite.
    pub fn check(&self, n_axes: usize) -> Result<(), SignalError> {
        for (name, gains) in [("gain", &self.gain), ("integral_gain", &self.integral_gain)] {
            of_axes(name, gains, n_axes)?.iter().try_for_each(|&gain| not_negative(name, gain))?;
        }
        positive("sample_time_s", self.sample_time_s)?;
        if let Some(limits) = &self.max_torque_nm {
            of_axes("max_torque_nm", limits, n_axes)?.iter().try_for_each(|&limit| positive("max_torque_nm", limit))?;
        }
        Ok(())
    }

    /// The controller of an axis, holding a torque in N m until the error says otherwise.
    pub(crate) fn axis(&self, axis: usize, holding_nm: f64) -> PiAxis {
        PiAxis {
            gain: self.gain[axis],
            integral_step: self.integral_gain[axis] * self.sample_time_s,
            max_torque_nm: self.max_torque_nm.as_ref().map_or(f64::INFINITY, |limits| limits[axis]),
            limited: false,
            integral_nm: holding_nm,
            delay: std::iter::repeat_n(holding_nm, self.delay_samples).collect(),
        }
    }
}

/// What the controller does at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PiOutput {
    /// Torque in N m to act next.
    pub torque_nm: f64,
    /// Torque in N m asked for now, before the limit.
    pub asked_nm: f64,
    /// The limit in N m.
    pub max_torque_nm: f64,
    /// Whether the torque has just reached its limit.
    pub limit_reached: bool,
}

impl PiAxis {
    /// Takes the error of this sample in rad/s.
    pub fn step(&mut self, error_rad_s: f64) -> PiOutput {
        let asked_nm = self.gain * error_rad_s + self.integral_nm;
        let torque = asked_nm.clamp(-self.max_torque_nm, self.max_torque_nm);
        let limited = torque != asked_nm;
        if !limited || error_rad_s * asked_nm <= 0.0 {
            self.integral_nm += self.integral_step * error_rad_s;
        }
        let limit_reached = limited && !self.limited;
        self.limited = limited;
        self.delay.push_back(torque);
        let torque_nm = self.delay.pop_front().unwrap_or(torque);
        PiOutput { torque_nm, asked_nm, max_torque_nm: self.max_torque_nm, limit_reached }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controller() -> PiController {
        PiController {
            gain: vec![2.0],
            integral_gain: vec![1000.0],
            sample_time_s: 1e-3,
            delay_samples: 0,
            max_torque_nm: Some(vec![10.0]),
        }
    }

    #[test]
    fn the_torque_is_proportional_plus_integral() {
        let mut axis = controller().axis(0, 5.0);
        assert_eq!([1.0, 1.0, -0.5].map(|error| axis.step(error).torque_nm), [7.0, 8.0, 6.0]);
    }

    #[test]
    fn at_its_limit_the_integral_stands_still_and_lets_go_at_once() {
        let mut axis = controller().axis(0, 0.0);
        for _ in 0..1000 {
            assert_eq!(axis.step(20.0).torque_nm, 10.0);
        }
        assert_eq!(axis.step(-1.0).torque_nm, -2.0);
    }

    #[test]
    fn the_delay_holds_the_torque_back_by_whole_samples() {
        let mut axis = PiController { delay_samples: 2, ..controller() }.axis(0, 5.0);
        assert_eq!([1.0, 0.0, 0.0].map(|error| axis.step(error).torque_nm), [5.0, 5.0, 7.0]);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        assert_eq!(controller().check(1), Ok(()));
        assert!(matches!(controller().check(2), Err(SignalError::Shape { name: "gain", .. })));
        for (name, bad) in [
            ("gain", PiController { gain: vec![f64::NAN], ..controller() }),
            ("integral_gain", PiController { integral_gain: vec![-1.0], ..controller() }),
            ("sample_time_s", PiController { sample_time_s: 0.0, ..controller() }),
            ("max_torque_nm", PiController { max_torque_nm: Some(vec![0.0]), ..controller() }),
        ] {
            assert!(bad.check(1).expect_err(name).to_string().starts_with(name));
        }
    }
}
