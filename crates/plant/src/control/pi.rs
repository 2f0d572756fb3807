//! PI controller of the motor velocity, with or without a position loop around it.

use std::collections::VecDeque;
use std::iter::repeat_n;

use frfid_signals::SignalError;
use frfid_signals::checks::{not_negative, one_per_axis, positive, require};
use nalgebra::{DMatrix, DVector, RowDVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::control::biquad::Biquad;
use crate::control::controller::{Controller, ControllerAxis, ControllerOutput, LinearController};
use crate::control::torque_limits::TorqueLimits;

/// A sampled PI controller of the motor velocity: the reference is a velocity then.
///
/// u = gain e + integral, the integral growing by integral_gain e T per sample T. While the torque
/// or its rate is at a limit, the integral stands still if the error would push it further beyond
/// (anti-windup by conditional integration; Astrom, Hagglund, PID Controllers, 1995, section 3.5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PiController {
    /// Proportional gain in N m s/rad, one for each axis.
    pub gain_nms_per_rad: Vec<f64>,
    /// Integral gain in N m/rad, one for each axis.
    pub integral_gain_nm_per_rad: Vec<f64>,
    /// Whole samples from reading the velocity to the torque's acting, at most 100.
    #[serde(default)]
    pub delay_samples: usize,
    /// Torque limit in N m, one for each axis; none without it.
    pub max_torque_nm: Option<Vec<f64>>,
    /// Largest change of the torque in N m/s, one for each axis; none without it.
    pub max_torque_rate_nm_per_s: Option<Vec<f64>>,
    /// Gain of a position loop around the velocity loop in 1/s, one for each axis; no position loop
    /// without it.
    pub position_gain_per_s: Option<Vec<f64>>,
}

/// Most samples of delay: a tenth of a second at 1 kHz, in which no loop could do anything.
const MOST_DELAY: usize = 100;

/// The controller at work on one axis, with filters on its torque. It is limited before them, lest
/// their memory winds up, and behind them, as they overshoot.
struct PiAxis {
    gain_nms_per_rad: f64,
    /// Growth of the integral in N m per sample and rad/s of error.
    integral_step: f64,
    integral_nm: f64,
    before_filters: TorqueLimits,
    filters: Vec<Biquad>,
    behind_filters: TorqueLimits,
    /// Torques in N m on their way.
    delay: VecDeque<f64>,
}

impl PiController {
    /// A controller of these gains in N m s/rad and N m/rad, one for each axis, without delay,
    /// limits and position loop.
    #[must_use]
    pub fn new(gain_nms_per_rad: Vec<f64>, integral_gain_nm_per_rad: Vec<f64>) -> Self {
        Self {
            gain_nms_per_rad,
            integral_gain_nm_per_rad,
            delay_samples: 0,
            max_torque_nm: None,
            max_torque_rate_nm_per_s: None,
            position_gain_per_s: None,
        }
    }

    /// Growth of an axis' integral in N m per sample and rad/s of error.
    fn integral_step(&self, axis: usize, sample_time_s: f64) -> f64 {
        self.integral_gain_nm_per_rad[axis] * sample_time_s
    }

    /// The controller of an axis at work, the torque that it asks for filtered before it is
    /// limited.
    pub(crate) fn filtered_axis(
        &self,
        axis: usize,
        sample_time_s: f64,
        holding_nm: f64,
        mut filters: Vec<Biquad>,
    ) -> Box<dyn ControllerAxis> {
        let of_axis = |values: &Option<Vec<f64>>| values.as_ref().map(|values| values[axis]);
        let limits = TorqueLimits::holding(
            holding_nm,
            sample_time_s,
            of_axis(&self.max_torque_nm),
            of_axis(&self.max_torque_rate_nm_per_s),
        );
        let torque_nm = limits.torque_nm();
        for filter in &mut filters {
            filter.settle(torque_nm);
        }
        Box::new(PiAxis {
            gain_nms_per_rad: self.gain_nms_per_rad[axis],
            integral_step: self.integral_step(axis, sample_time_s),
            integral_nm: holding_nm,
            before_filters: limits.clone(),
            filters,
            behind_filters: limits,
            delay: repeat_n(torque_nm, self.delay_samples).collect(),
        })
    }
}

impl Controller for PiController {
    fn check(&self, n_axes: usize, sample_time_s: f64) -> Result<(), SignalError> {
        positive("sample_time_s", sample_time_s)?;
        let (delay, fits) = (self.delay_samples, self.delay_samples <= MOST_DELAY);
        require("delay_samples", delay as f64, fits, "at most 100")?;
        let checked = |key, values: Option<&Vec<f64>>, check| {
            one_per_axis(key, values.map(Vec::as_slice), n_axes, check)
        };
        checked(
            "gain_nms_per_rad",
            Some(&self.gain_nms_per_rad),
            not_negative,
        )?;
        checked(
            "integral_gain_nm_per_rad",
            Some(&self.integral_gain_nm_per_rad),
            not_negative,
        )?;
        checked(
            "position_gain_per_s",
            self.position_gain_per_s.as_ref(),
            not_negative,
        )?;
        checked("max_torque_nm", self.max_torque_nm.as_ref(), positive)?;
        checked(
            "max_torque_rate_nm_per_s",
            self.max_torque_rate_nm_per_s.as_ref(),
            positive,
        )
    }

    fn axis(&self, axis: usize, sample_time_s: f64, holding_nm: f64) -> Box<dyn ControllerAxis> {
        self.filtered_axis(axis, sample_time_s, holding_nm, Vec::new())
    }

    /// One state, the integral.
    fn linear(&self, axis: usize, sample_time_s: f64) -> LinearController {
        LinearController {
            a: DMatrix::identity(1, 1),
            b: DVector::from_element(1, self.integral_step(axis, sample_time_s)),
            c: RowDVector::from_element(1, 1.0),
            d: self.gain_nms_per_rad[axis],
            delay_samples: self.delay_samples,
        }
    }

    fn position_gain_per_s(&self, axis: usize) -> f64 {
        let gains = self.position_gain_per_s.as_ref();
        gains.map_or(0.0, |gains| gains[axis])
    }

    fn gain_nms_per_rad(&self) -> &[f64] {
        &self.gain_nms_per_rad
    }
}

impl ControllerAxis for PiAxis {
    fn step(&mut self, error_rad_s: f64) -> ControllerOutput {
        let asked_nm = self.gain_nms_per_rad * error_rad_s + self.integral_nm;
        let (unfiltered_nm, reached_before) = self.before_filters.limited(asked_nm);
        let filters = self.filters.iter_mut();
        let filtered_nm = filters.fold(unfiltered_nm, |torque_nm, filter| filter.step(torque_nm));
        let (torque_nm, reached_behind) = self.behind_filters.limited(filtered_nm);
        let is_free = |asked_nm, limited_nm| error_rad_s * (asked_nm - limited_nm) <= 0.0;
        if is_free(asked_nm, unfiltered_nm) && is_free(filtered_nm, torque_nm) {
            self.integral_nm += self.integral_step * error_rad_s;
        }
        self.delay.push_back(torque_nm);
        ControllerOutput {
            torque_nm: self.delay.pop_front().unwrap_or(torque_nm),
            reached: reached_before.or(reached_behind),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::watch::Reached;
    use frfid_signals::Limit;

    fn controller() -> PiController {
        PiController {
            gain_nms_per_rad: vec![2.0],
            integral_gain_nm_per_rad: vec![1000.0],
            position_gain_per_s: None,
            delay_samples: 0,
            max_torque_nm: Some(vec![10.0]),
            max_torque_rate_nm_per_s: None,
        }
    }

    const T: f64 = 1e-3;

    fn torques<const N: usize>(axis: &mut dyn ControllerAxis, errors: [f64; N]) -> [f64; N] {
        errors.map(|error| axis.step(error).torque_nm)
    }

    #[test]
    fn the_torque_is_proportional_plus_integral() {
        assert_eq!(
            torques(&mut *controller().axis(0, T, 5.0), [1.0, 1.0, -0.5]),
            [7.0, 8.0, 6.0]
        );
    }

    #[test]
    fn at_its_limit_the_integral_stands_still_and_lets_go_at_once() {
        let mut axis = controller().axis(0, T, 0.0);
        assert_eq!(torques(&mut *axis, [20.0; 1000]), [10.0; 1000]);
        assert_eq!(torques(&mut *axis, [-1.0]), [-2.0]);
    }

    #[test]
    fn the_torque_changes_no_faster_than_its_rate_and_the_integral_waits_for_it() {
        let mut axis = PiController {
            max_torque_rate_nm_per_s: Some(vec![1000.0]),
            ..controller()
        }
        .axis(0, T, 0.0);
        let first = axis.step(3.0);
        let reached = Reached {
            limit: Limit::TorqueRate,
            value: 6000.0,
            allowed: 1000.0,
        };
        assert_eq!(
            first,
            ControllerOutput {
                torque_nm: 1.0,
                reached: Some(reached)
            }
        );
        assert_eq!(torques(&mut *axis, [3.0; 4]), [2.0, 3.0, 4.0, 5.0]); // no second event, no integral
        assert_eq!(
            torques(&mut *axis, [2.5, 0.0, 0.0, 0.0]),
            [5.0, 4.0, 3.0, 2.5]
        ); // gain 2 x 2.5, integral 2.5 from there
    }

    #[test]
    fn a_torque_that_is_asked_to_be_infinite_is_at_its_limit() {
        let limited = PiController {
            max_torque_rate_nm_per_s: Some(vec![1000.0]),
            ..controller()
        };
        let mut axis = limited.axis(0, T, 0.0);
        assert_eq!(
            [f64::NEG_INFINITY, f64::INFINITY].map(|y| axis.step(-y).torque_nm),
            [1.0, 0.0]
        );
        let mut free = PiController {
            max_torque_nm: None,
            ..controller()
        }
        .axis(0, T, 0.0);
        assert_eq!(
            [f64::NEG_INFINITY; 2].map(|y| free.step(-y).torque_nm),
            [f64::INFINITY; 2]
        );
    }

    #[test]
    fn the_delay_holds_the_torque_back_by_whole_samples() {
        let mut axis = PiController {
            delay_samples: 2,
            ..controller()
        }
        .axis(0, T, 5.0);
        assert_eq!(torques(&mut *axis, [1.0, 0.0, 0.0]), [5.0, 5.0, 7.0]);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        assert!(matches!(
            controller().check(1, 0.0),
            Err(SignalError::Parameter {
                key: "sample_time_s",
                ..
            })
        ));
        assert_eq!(controller().check(1, T), Ok(()));
        assert!(matches!(
            controller().check(2, T),
            Err(SignalError::Shape {
                name: "gain_nms_per_rad",
                ..
            })
        ));
        for (name, bad) in [
            (
                "gain_nms_per_rad",
                PiController {
                    gain_nms_per_rad: vec![f64::NAN],
                    ..controller()
                },
            ),
            (
                "integral_gain_nm_per_rad",
                PiController {
                    integral_gain_nm_per_rad: vec![-1.0],
                    ..controller()
                },
            ),
            (
                "position_gain_per_s",
                PiController {
                    position_gain_per_s: Some(vec![-1.0]),
                    ..controller()
                },
            ),
            (
                "delay_samples",
                PiController {
                    delay_samples: usize::MAX,
                    ..controller()
                },
            ),
            (
                "max_torque_nm",
                PiController {
                    max_torque_nm: Some(vec![0.0]),
                    ..controller()
                },
            ),
            (
                "max_torque_rate_nm_per_s",
                PiController {
                    max_torque_rate_nm_per_s: Some(vec![]),
                    ..controller()
                },
            ),
        ] {
            assert!(
                bad.check(1, T)
                    .expect_err(name)
                    .to_string()
                    .starts_with(name)
            );
        }
    }
}
