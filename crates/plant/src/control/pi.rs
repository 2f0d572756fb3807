//! A sampled PI controller of the motor velocity: the K of SK15 figure 2.

use std::collections::VecDeque;

use frfid_signals::checks::{not_negative, one_per_axis, positive};
use frfid_signals::{Limit, SignalError};
use serde::{Deserialize, Serialize};

use crate::control::watch::Reached;

/// u = gain e + integral, the integral growing by integral_gain e T per sample T; one value per
/// axis.
///
/// The error is e = r - y, r and y the reference and the reading of the motor velocity. A position
/// loop adds position_gain (q_ref - q) to it, q the reading of the motor position and
/// `q_ref[k] = q_ref[0] + T (r[0] + ... + r[k-1])` the exact integral of a reference held between
/// samples, from where the motor starts.
///
/// The torque stays within its largest value and changes from sample to sample by no more than its
/// largest rate. While either binds, the integral stands still if the error would push it further
/// beyond (anti-windup by conditional integration; Astrom, Hagglund, PID Controllers, 1995, section
/// 3.5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PiController {
    /// Proportional gain in N m s/rad.
    pub gain: Vec<f64>,
    /// Integral gain in N m/rad.
    pub integral_gain: Vec<f64>,
    /// Gain of the position loop in 1/s; `None` for no position loop.
    pub position_gain: Option<Vec<f64>>,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Whole samples between reading the velocity at t_k and the torque's acting, at most 100; 0:
    /// from t_k on.
    pub delay_samples: usize,
    /// Largest torque in N m; `None` for no limit.
    pub max_torque_nm: Option<Vec<f64>>,
    /// Largest change of the torque in N m/s; `None` for no limit.
    pub max_torque_rate_nm_per_s: Option<Vec<f64>>,
}

/// Most samples of delay: a tenth of a second at 1 kHz, in which no loop could do anything.
const MOST_DELAY: usize = 100;

/// The controller of one axis in numbers: its linear part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gains {
    /// Proportional gain in N m s/rad.
    pub proportional: f64,
    /// Growth of the integral in N m per sample and rad/s of error.
    pub integral_step: f64,
    /// Gain of the position loop in 1/s, 0 for none.
    pub position: f64,
}

/// The controller at work on one axis.
#[derive(Debug, Clone)]
pub(crate) struct PiAxis {
    gains: Gains,
    sample_time_s: f64,
    /// Largest torque in N m, infinite for none.
    max_torque_nm: f64,
    /// Largest change of the torque in N m/s, infinite for none.
    max_rate_nm_per_s: f64,
    /// The limit that bound the torque at the sample before.
    bound: Option<Limit>,
    integral_nm: f64,
    /// q_ref in rad.
    position_rad: f64,
    /// Torque in N m that was commanded at the sample before.
    torque_nm: f64,
    /// Torques in N m on their way.
    delay: VecDeque<f64>,
}

impl PiController {
    /// Checks every parameter for a robot of `n_axes`.
    ///
    /// # Errors
    /// [`SignalError::Shape`] for another number of axes, [`SignalError::Parameter`] for a gain
    /// that is negative, a limit or sample time that is not above 0, a delay of more than 100
    /// samples, or a number that is not finite.
    pub fn check(&self, n_axes: usize) -> Result<(), SignalError> {
        positive("sample_time_s", self.sample_time_s)?;
        if self.delay_samples > MOST_DELAY {
            let (key, found) = ("delay_samples", self.delay_samples as f64);
            return Err(SignalError::Parameter {
                key,
                found,
                needed: "at most 100",
            });
        }
        let Self {
            gain,
            integral_gain,
            position_gain,
            max_torque_nm,
            max_torque_rate_nm_per_s,
            ..
        } = self;
        one_per_axis("gain", Some(gain), n_axes, not_negative)?;
        one_per_axis("integral_gain", Some(integral_gain), n_axes, not_negative)?;
        one_per_axis(
            "position_gain",
            position_gain.as_deref(),
            n_axes,
            not_negative,
        )?;
        one_per_axis("max_torque_nm", max_torque_nm.as_deref(), n_axes, positive)?;
        one_per_axis(
            "max_torque_rate_nm_per_s",
            max_torque_rate_nm_per_s.as_deref(),
            n_axes,
            positive,
        )
    }

    /// The gains of an axis.
    pub(crate) fn gains(&self, axis: usize) -> Gains {
        Gains {
            proportional: self.gain[axis],
            integral_step: self.integral_gain[axis] * self.sample_time_s,
            position: self.position_gain.as_ref().map_or(0.0, |gains| gains[axis]),
        }
    }

    /// The controller of an axis, holding a torque in N m at a motor position in rad until the
    /// error says otherwise.
    pub(crate) fn axis(&self, axis: usize, holding_nm: f64, position_rad: f64) -> PiAxis {
        let limit = |limits: &Option<Vec<f64>>| {
            limits.as_ref().map_or(f64::INFINITY, |limits| limits[axis])
        };
        let max_torque_nm = limit(&self.max_torque_nm);
        let torque_nm = holding_nm.clamp(-max_torque_nm, max_torque_nm);
        PiAxis {
            gains: self.gains(axis),
            sample_time_s: self.sample_time_s,
            max_torque_nm,
            max_rate_nm_per_s: limit(&self.max_torque_rate_nm_per_s),
            bound: None,
            integral_nm: holding_nm,
            position_rad,
            torque_nm,
            delay: std::iter::repeat_n(torque_nm, self.delay_samples).collect(),
        }
    }
}

/// What the controller does at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PiOutput {
    /// Torque in N m to act next.
    pub torque_nm: f64,
    /// The limit that has just been reached.
    pub reached: Option<Reached>,
}

impl PiAxis {
    /// Takes the reference in rad/s and the readings of position in rad and velocity in rad/s of
    /// this sample.
    pub fn step(
        &mut self,
        reference_rad_s: f64,
        position_rad: f64,
        velocity_rad_s: f64,
    ) -> PiOutput {
        let Gains {
            proportional,
            integral_step,
            position,
        } = self.gains;
        let error_rad_s =
            reference_rad_s + position * (self.position_rad - position_rad) - velocity_rad_s;
        self.position_rad += reference_rad_s * self.sample_time_s;
        let asked_nm = proportional * error_rad_s + self.integral_nm;
        let (torque_nm, reached) = self.limited(asked_nm);
        if error_rad_s * (asked_nm - torque_nm) <= 0.0 {
            self.integral_nm += integral_step * error_rad_s;
        }
        self.torque_nm = torque_nm;
        self.delay.push_back(torque_nm);
        PiOutput {
            torque_nm: self.delay.pop_front().unwrap_or(torque_nm),
            reached,
        }
    }

    /// The torque in N m that is asked for, as far as the limits allow it, and the limit that it
    /// has just reached.
    fn limited(&mut self, asked_nm: f64) -> (f64, Option<Reached>) {
        let (max_nm, max_change_nm) = (
            self.max_torque_nm,
            self.max_rate_nm_per_s * self.sample_time_s,
        );
        // max and min where clamp would panic: a diverging loop can ask for infinitely much
        let within_nm = asked_nm.max(-max_nm).min(max_nm);
        let torque_nm = within_nm
            .max(self.torque_nm - max_change_nm)
            .min(self.torque_nm + max_change_nm);
        let bound = if torque_nm != within_nm {
            let rate_nm_per_s = (within_nm - self.torque_nm) / self.sample_time_s;
            Some(Reached {
                limit: Limit::TorqueRate,
                value: rate_nm_per_s,
                allowed: self.max_rate_nm_per_s,
            })
        } else if within_nm != asked_nm {
            Some(Reached {
                limit: Limit::Torque,
                value: asked_nm,
                allowed: max_nm,
            })
        } else {
            None
        };
        let before = std::mem::replace(&mut self.bound, bound.map(|bound| bound.limit));
        (torque_nm, bound.filter(|bound| before != Some(bound.limit)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controller() -> PiController {
        PiController {
            gain: vec![2.0],
            integral_gain: vec![1000.0],
            position_gain: None,
            sample_time_s: 1e-3,
            delay_samples: 0,
            max_torque_nm: Some(vec![10.0]),
            max_torque_rate_nm_per_s: None,
        }
    }

    fn torques<const N: usize>(axis: &mut PiAxis, references: [f64; N]) -> [f64; N] {
        references.map(|reference| axis.step(reference, 0.0, 0.0).torque_nm)
    }

    #[test]
    fn the_torque_is_proportional_plus_integral() {
        assert_eq!(
            torques(&mut controller().axis(0, 5.0, 0.0), [1.0, 1.0, -0.5]),
            [7.0, 8.0, 6.0]
        );
    }

    #[test]
    fn the_position_loop_asks_for_the_way_that_the_reference_has_gone() {
        let controller = PiController {
            position_gain: Some(vec![100.0]),
            integral_gain: vec![0.0],
            ..controller()
        };
        let mut axis = controller.axis(0, 0.0, 7.0);
        // at rest at 7 rad: after two samples of 2 rad/s the motor should be 4 mrad ahead, worth
        // 0.4 rad/s
        let torques = [2.0, 2.0, 0.0].map(|reference| axis.step(reference, 7.0, 0.0).torque_nm);
        assert!(
            torques
                .iter()
                .zip([4.0, 4.4, 0.8])
                .all(|(found, asked)| (found - asked).abs() < 1e-12),
            "{torques:?}"
        );
    }

    #[test]
    fn at_its_limit_the_integral_stands_still_and_lets_go_at_once() {
        let mut axis = controller().axis(0, 0.0, 0.0);
        assert_eq!(torques(&mut axis, [20.0; 1000]), [10.0; 1000]);
        assert_eq!(torques(&mut axis, [-1.0]), [-2.0]);
    }

    #[test]
    fn the_torque_changes_no_faster_than_its_rate_and_the_integral_waits_for_it() {
        let mut axis = PiController {
            max_torque_rate_nm_per_s: Some(vec![1000.0]),
            ..controller()
        }
        .axis(0, 0.0, 0.0);
        let first = axis.step(3.0, 0.0, 0.0);
        let reached = Reached {
            limit: Limit::TorqueRate,
            value: 6000.0,
            allowed: 1000.0,
        };
        assert_eq!(
            first,
            PiOutput {
                torque_nm: 1.0,
                reached: Some(reached)
            }
        );
        assert_eq!(torques(&mut axis, [3.0; 4]), [2.0, 3.0, 4.0, 5.0]); // no second event, no integral
        assert_eq!(
            torques(&mut axis, [2.5, 0.0, 0.0, 0.0]),
            [5.0, 4.0, 3.0, 2.5]
        ); // gain 2 x 2.5, integral 2.5 from there
    }

    #[test]
    fn a_torque_that_is_asked_to_be_infinite_is_at_its_limit() {
        let limited = PiController {
            max_torque_rate_nm_per_s: Some(vec![1000.0]),
            ..controller()
        };
        let mut axis = limited.axis(0, 0.0, 0.0);
        assert_eq!(
            [f64::NEG_INFINITY, f64::INFINITY].map(|y| axis.step(0.0, 0.0, y).torque_nm),
            [1.0, 0.0]
        );
        let mut free = PiController {
            max_torque_nm: None,
            ..controller()
        }
        .axis(0, 0.0, 0.0);
        assert_eq!(
            [f64::NEG_INFINITY; 2].map(|y| free.step(0.0, 0.0, y).torque_nm),
            [f64::INFINITY; 2]
        );
    }

    #[test]
    fn the_delay_holds_the_torque_back_by_whole_samples() {
        let mut axis = PiController {
            delay_samples: 2,
            ..controller()
        }
        .axis(0, 5.0, 0.0);
        assert_eq!(torques(&mut axis, [1.0, 0.0, 0.0]), [5.0, 5.0, 7.0]);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        assert_eq!(controller().check(1), Ok(()));
        assert!(matches!(
            controller().check(2),
            Err(SignalError::Shape { name: "gain", .. })
        ));
        for (name, bad) in [
            (
                "gain",
                PiController {
                    gain: vec![f64::NAN],
                    ..controller()
                },
            ),
            (
                "integral_gain",
                PiController {
                    integral_gain: vec![-1.0],
                    ..controller()
                },
            ),
            (
                "position_gain",
                PiController {
                    position_gain: Some(vec![-1.0]),
                    ..controller()
                },
            ),
            (
                "sample_time_s",
                PiController {
                    sample_time_s: 0.0,
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
            assert!(bad.check(1).expect_err(name).to_string().starts_with(name));
        }
    }
}
