//! Table `[shape]`: what a reference is shaped towards.

use frfid_estimate::{ShapeOptions, Step, Target};
use frfid_signals::Amplitude;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Iterative shaping of a chirp in closed loop (SK15 section 5.3): from the reference of `[chirp]`
/// to one whose answer is as desired. Exactly one of `desired_nm` and `desired_rad_s` is needed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShapeTable {
    /// Desired amplitude of the motor torque in N m, one for each axis: a number, or points [[Hz,
    /// value], ...].
    pub desired_nm: Option<Vec<Amplitude>>,
    /// Desired amplitude of the motor velocity in rad/s instead, likewise.
    pub desired_rad_s: Option<Vec<Amplitude>>,
    /// How the next reference is made: damped, or as in the paper.
    #[serde(default)]
    pub step: StepName,
    /// Share of what is missing that one damped step makes up for, above 0 and at most 1.
    #[serde(default = "damping")]
    pub damping: f64,
    /// Lines over which a damped step smooths the response from the reference.
    #[serde(default = "smoothing_bins")]
    pub smoothing_bins: usize,
    /// Most iterations, the first with the initial reference included.
    #[serde(default = "n_iterations")]
    pub n_iterations: usize,
    /// Relative error, rms over the band, that is good enough on every axis.
    #[serde(default = "good_enough")]
    pub good_enough: f64,
    /// Largest growth of a reference from one iteration to the next, as a factor.
    #[serde(default = "largest_change")]
    pub largest_change: f64,
    /// Largest share of the sweep that an axis may be stuck.
    #[serde(default = "max_stuck_share")]
    pub max_stuck_share: f64,
    /// Factor by which a quantity may change more than predicted without exceeding its limit.
    #[serde(default = "margin")]
    pub margin: f64,
}

/// How the next reference is made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StepName {
    /// The smoothed step times a damping that shrinks when the error rises.
    #[default]
    Damped,
    /// The paper's fixed point (18), which friction pushes apart.
    Paper,
}

impl ShapeTable {
    /// Which signal is to follow, the key of its amplitudes and these; `None` unless one of the two is given.
    pub(crate) fn desired(&self) -> Option<(Target, &'static str, &[Amplitude])> {
        match (&self.desired_nm, &self.desired_rad_s) {
            (Some(torque), None) => Some((Target::Torque, "desired_nm", torque)),
            (None, Some(velocity)) => Some((Target::Velocity, "desired_rad_s", velocity)),
            _ => None,
        }
    }

    /// The step.
    #[must_use]
    pub fn step(&self) -> Step {
        match self.step {
            StepName::Paper => Step::Paper,
            StepName::Damped => Step::Damped {
                damping: self.damping,
                smoothing_bins: self.smoothing_bins,
                adaptive: true,
            },
        }
    }
}

fn damping() -> f64 {
    match Step::default() {
        Step::Damped { damping, .. } => damping,
        Step::Paper => 1.0,
    }
}

fn smoothing_bins() -> usize {
    match Step::default() {
        Step::Damped { smoothing_bins, .. } => smoothing_bins,
        Step::Paper => 1,
    }
}

fn n_iterations() -> usize {
    ShapeOptions::default().n_iterations
}

fn good_enough() -> f64 {
    ShapeOptions::default().good_enough
}

fn largest_change() -> f64 {
    ShapeOptions::default().largest_change
}

fn max_stuck_share() -> f64 {
    ShapeOptions::default().max_stuck_share
}

fn margin() -> f64 {
    ShapeOptions::default().margin
}
