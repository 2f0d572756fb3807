//! One iteration of a shaping: its reference, its records, and what they say.

use frfid_signals::{Frf, Peaks, Record};
use ndarray::{Array2, Array3};

use crate::shape::measure::octave_error::OctaveError;
use crate::shape::note::Note;
use crate::shape::options::Target;
use crate::shape::sticking::BandMotion;

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
    /// What its reader should know.
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
    /// Rms of it over every octave of the band, per channel.
    pub octave_error: Vec<OctaveError>,
    /// Rms of it over band and channels.
    pub error: f64,
    /// Condition number of U per frequency, its channels scaled to equal size: 1 if the experiments
    /// are orthogonal, 2 for the sign flip on three axes.
    pub condition: Vec<f64>,
}

impl Estimate {
    /// Response from reference to the target.
    pub(super) fn response_of(&self, target: Target) -> &Frf {
        match target {
            Target::Torque => &self.r_to_u,
            Target::Velocity => &self.r_to_y,
        }
    }
}

impl Iteration {
    /// Relative error of the target, rms over band and channels; `None` if a run was stopped.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        self.estimate.as_ref().map(|estimate| estimate.error)
    }
}
