//! What one iteration measured and what came of all of them.

use std::fmt;

use frfid_signals::{Excess, Frf, Limit, Peaks, Record};
use ndarray::{Array2, Array3};
use serde::{Deserialize, Serialize, Serializer};

use crate::shape::sticking::{BandMotion, Sticking};

/// One iteration: a reference for every experiment, what was measured, and what it says.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration {
    /// Number, from 1 as in the paper.
    pub number: usize,
    /// The reference that was applied, `(experiment, channel, sample)`, in rad/s.
    pub reference: Array3<f64>,
    /// What was measured, one record per experiment.
    pub records: Vec<Record>,
    /// Damping of the step that led here, mean over lines and channels; `None` for the first
    /// reference.
    pub damping: Option<f64>,
    /// Responses and errors; `None` if a run was stopped before its end.
    pub estimate: Option<Estimate>,
    /// Share of the sweep that each axis was stuck.
    pub stuck_share: Vec<f64>,
    /// Torque and stuck share per axis and band, axis by axis, bands rising.
    pub bands: Vec<BandMotion>,
    /// Peaks that were predicted before the reference was applied; `None` for the first.
    pub predicted: Option<Peaks>,
    /// Peaks that were measured.
    pub peaks: Peaks,
    /// Peaks predicted for the next reference; `None` after the last iteration.
    pub next_predicted: Option<Peaks>,
    /// Whether every run kept all limits to its end: only then can the iteration be the best.
    pub within_limits: bool,
    /// What is worth saying.
    pub notes: Vec<Note>,
}

/// What the whole records of an iteration say, on the lines of the band.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Response from reference to motor torque.
    pub r_to_u: Frf,
    /// Response from reference to motor velocity.
    pub r_to_y: Frf,
    /// `|U - U_des| / |U_des|` of the target over the experiments, `(frequency, channel)`.
    pub error_per_frequency: Array2<f64>,
    /// Rms of it over the band, per channel.
    pub channel_error: Vec<f64>,
    /// Rms of it over band and channels.
    pub error: f64,
    /// Condition number of U per frequency, its channels scaled to equal size: 1 if the experiments
    /// are orthogonal, 2 for the sign flip on three axes.
    pub condition: Vec<f64>,
}

/// Something about an iteration that its reader should know.
#[derive(Debug, Clone, PartialEq)]
pub enum Note {
    /// Every axis was stuck: the response is that of the controller alone.
    AllStuck,
    /// A limit was exceeded; the iteration cannot be the best, the next step is smaller.
    Exceeded(Excess),
    /// A run was stopped before its end.
    Stopped {
        /// Experiment, from 0.
        experiment: usize,
        /// Time in s that it lasted.
        time_s: f64,
        /// Why, as the record says.
        reason: String,
    },
    /// The error is larger than that of the best iteration.
    Rose {
        /// This error.
        found: f64,
        /// That of the best iteration.
        best: f64,
    },
    /// The next reference of an axis grows by the largest allowed factor, less than its step asked
    /// for.
    ChangeLimited {
        /// Axis, from 0.
        axis: usize,
        /// Share of the step that is taken.
        share: f64,
    },
    /// A predicted peak shortens the next step of all axes, around one moment or altogether.
    LimitAhead {
        /// Axis, from 0.
        axis: usize,
        /// Which limit would be exceeded.
        limit: Limit,
        /// Time in s at which it would.
        time_s: f64,
        /// Share of the step that is taken there.
        share: f64,
    },
}

/// Why shaping ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The error is small enough on every channel and no axis sticks for too long.
    GoodEnough,
    /// The desired signal is reached and an axis sticks all the same: it is too weak for the
    /// friction.
    Sticking,
    /// Two iterations in a row brought no smaller error.
    RoseTwice,
    /// The number of iterations is used up.
    AllIterations,
    /// Whoever watched ended it.
    Watcher,
}

/// Peaks of a shaping as its files have them, one value for each axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapePeaks {
    /// Motor torque in N m.
    pub torque_nm: Vec<f64>,
    /// Motor velocity in rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Way from where the runs began in rad.
    pub travel_rad: Vec<f64>,
}

impl From<&Peaks> for ShapePeaks {
    fn from(peaks: &Peaks) -> Self {
        let of = |limit| peaks.get(limit).unwrap_or_default().to_vec();
        Self {
            torque_nm: of(Limit::Torque),
            velocity_rad_s: of(Limit::Velocity),
            travel_rad: of(Limit::Travel),
        }
    }
}

fn peaks_in_files<S: Serializer>(peaks: &Peaks, serializer: S) -> Result<S::Ok, S::Error> {
    ShapePeaks::from(peaks).serialize(serializer)
}

fn predicted_in_files<S: Serializer>(
    peaks: &Option<Peaks>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    peaks.as_ref().map(ShapePeaks::from).serialize(serializer)
}

/// The numbers of an iteration without its signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Number, from 1.
    pub number: usize,
    /// Relative error of the target, rms over band and channels; `None` if a run was stopped.
    pub error: Option<f64>,
    /// The same per channel.
    pub channel_error: Option<Vec<f64>>,
    /// Share of the sweep that each axis was stuck.
    pub stuck_share: Vec<f64>,
    /// Damping of the step that led here.
    pub damping: Option<f64>,
    /// Peaks predicted before.
    #[serde(serialize_with = "predicted_in_files")]
    pub predicted: Option<Peaks>,
    /// Peaks measured.
    #[serde(serialize_with = "peaks_in_files")]
    pub peaks: Peaks,
    /// Whether every run kept all limits to its end.
    pub within_limits: bool,
    /// What is worth saying.
    pub notes: Vec<Note>,
}

/// The result of shaping.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaped {
    /// The iteration with the smallest error that kept all limits: its reference is the excitation
    /// to use.
    pub best: Iteration,
    /// Every iteration in order.
    pub iterations: Vec<Summary>,
    /// Why it ended.
    pub stop: Stop,
    /// Where axes still stick in the best iteration, worst bands merged; empty if none does.
    pub sticking: Vec<Sticking>,
}

impl Iteration {
    /// Relative error of the target, rms over band and channels; `None` if a run was stopped.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        self.estimate.as_ref().map(|estimate| estimate.error)
    }

    /// The numbers without the signals.
    #[must_use]
    pub fn summary(&self) -> Summary {
        Summary {
            number: self.number,
            error: self.error(),
            channel_error: self
                .estimate
                .as_ref()
                .map(|estimate| estimate.channel_error.clone()),
            stuck_share: self.stuck_share.clone(),
            damping: self.damping,
            predicted: self.predicted.clone(),
            peaks: self.peaks.clone(),
            within_limits: self.within_limits,
            notes: self.notes.clone(),
        }
    }
}

/// In words.
impl Serialize for Note {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// In words, axes and experiments from 1.
impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AllStuck => write!(
                f,
                "every axis was stuck: the response is that of the controller alone"
            ),
            Self::Exceeded(Excess {
                axis,
                limit,
                allowed,
                found,
            }) => {
                write!(
                    f,
                    "axis {}: {} in {} reached {found:.4}, the limit is {allowed:.4}",
                    axis + 1,
                    limit.quantity(),
                    limit.unit()
                )
            }
            Self::Stopped {
                experiment,
                time_s,
                reason,
            } => {
                write!(
                    f,
                    "experiment {} was stopped after {time_s:.3} s: {reason}",
                    experiment + 1
                )
            }
            Self::Rose { found, best } => {
                write!(
                    f,
                    "the error rose to {:.1} %, the best is {:.1} %",
                    100.0 * found,
                    100.0 * best
                )
            }
            Self::ChangeLimited { axis, share } => {
                write!(
                    f,
                    "axis {}: the reference grows by the largest factor allowed, {:.0} % of the step",
                    axis + 1,
                    100.0 * share
                )
            }
            Self::LimitAhead {
                axis,
                limit,
                time_s,
                share,
            } => {
                write!(
                    f,
                    "axis {}: its predicted {} in {} at {time_s:.2} s shortens the step to {:.0} %",
                    axis + 1,
                    limit.quantity(),
                    limit.unit(),
                    100.0 * share
                )
            }
        }
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::GoodEnough => "the error is small enough",
            Self::Sticking => "the desired signal is reached and an axis still sticks: it is too weak for the friction",
            Self::RoseTwice => "two iterations in a row brought no smaller error",
            Self::AllIterations => "all iterations are done",
            Self::Watcher => "it was ended from outside",
        })
    }
}
