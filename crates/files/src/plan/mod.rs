//! Plan files: the references of every run, one after the other on one time axis, so that a
//! player on the robot's side can send them: `/joint_commands` (effort or velocity), and the start
//! of every run on `/frfid/events`.

pub(crate) mod read;
#[cfg(test)]
mod tests;
pub(crate) mod write;

use std::collections::BTreeMap;
use std::path::PathBuf;

use frfid_signals::{Injection, Run, RunId};
use serde::{Deserialize, Serialize};

/// What all runs of a plan have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanHead {
    /// Joint of every row of the references.
    pub joint_names: Vec<String>,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// What the references stand for.
    pub injection: Injection,
    /// Samples before the first measured period of every run.
    pub lead_in_samples: usize,
    /// Samples of one period.
    pub period_samples: usize,
    /// Measured periods back to back in each run.
    pub n_periods: usize,
    /// Provenance: version, seed, hashes, ... (the metadata record `frfid`).
    #[serde(skip)]
    pub metadata: BTreeMap<String, String>,
    /// The experiment's description (the attachment `experiment.toml`).
    #[serde(skip)]
    pub experiment_toml: String,
}

/// One reference, to be played `n_repetitions` times.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// The first of the repetitions.
    pub run: Run,
    /// How often it is done.
    pub n_repetitions: usize,
}

/// Where a planned run is in the file; announced on `/frfid/events` at its start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanEntry {
    /// The first of the repetitions.
    pub id: RunId,
    /// How often it is done.
    pub n_repetitions: usize,
    /// First sample on the file's time axis.
    pub start_sample: usize,
    /// Number of samples.
    pub n_samples: usize,
    /// Constant velocity in rad/s on which it rides, per joint.
    pub velocity_rad_s: Vec<f64>,
    /// Where it starts, in rad from the pose, per joint.
    pub start_rad: Vec<f64>,
}

/// A plan on the disk: its description in memory, the references where they are.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFile {
    /// What all runs have in common.
    pub head: PlanHead,
    /// The runs, in the order in which they are done.
    pub runs: Vec<PlanEntry>,
    pub(crate) path: PathBuf,
}

/// The metadata record `frfid.plan`.
#[derive(Serialize, Deserialize)]
pub(crate) struct PlanStructure<H> {
    pub(crate) version: u32,
    #[serde(flatten)]
    pub(crate) head: H,
}

/// The metadata record `frfid.plan.runs` at the end of the file.
#[derive(Serialize, Deserialize)]
pub(crate) struct PlanIndex {
    pub(crate) runs: Vec<PlanEntry>,
}

pub(crate) const VERSION: u32 = 1;
pub(crate) const INDEX: &str = "frfid.plan.runs";
