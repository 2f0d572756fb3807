//! Result of a shaping: its best iteration, a summary of every one, and why it ended.

use std::fmt;

use frfid_signals::{Limit, Peaks};
use serde::{Deserialize, Serialize, Serializer};

use crate::shape::iteration::Iteration;
use crate::shape::measure::octave_error::OctaveError;
use crate::shape::note::Note;
use crate::shape::sticking::Sticking;

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
    /// The watcher ended it.
    Watcher,
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

/// The numbers of an iteration without its signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Number, from 1.
    pub number: usize,
    /// Relative error of the target, rms over band and channels; `None` if a run was stopped.
    pub error: Option<f64>,
    /// The same per channel.
    pub channel_error: Option<Vec<f64>>,
    /// The same per octave of the band.
    pub octave_error: Option<Vec<OctaveError>>,
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
    /// What its reader should know.
    pub notes: Vec<Note>,
}

impl Iteration {
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
            octave_error: self
                .estimate
                .as_ref()
                .map(|estimate| estimate.octave_error.clone()),
            stuck_share: self.stuck_share.clone(),
            damping: self.damping,
            predicted: self.predicted.clone(),
            peaks: self.peaks.clone(),
            within_limits: self.within_limits,
            notes: self.notes.clone(),
        }
    }
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
