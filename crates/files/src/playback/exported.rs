//! Exported plan: its runs with their peaks, and where they were written.

use std::path::PathBuf;
use std::sync::Arc;

use frfid_signals::{Peaks, Playback, Player, RunId};

/// A reference that was held against the limits and keeps them.
#[derive(Debug, Clone, PartialEq)]
pub struct Rehearsal {
    /// The first of its repetitions.
    pub id: RunId,
    /// How often it is played, one after the other.
    pub n_repetitions: usize,
    /// Samples of each repetition, from rest to rest.
    pub n_samples: usize,
    /// Sample at which the run itself begins.
    pub first_sample: usize,
    /// Samples of the run itself.
    pub run_samples: usize,
    /// Duration of each repetition in s.
    pub duration_s: f64,
    /// What is commanded at most.
    pub commanded: Peaks,
    /// What the model predicts at most; `None` without a model.
    pub predicted: Option<Peaks>,
}

/// A plan that was exported.
#[derive(Debug, Clone)]
pub struct Exported {
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// The player that it is for.
    pub player: Player,
    /// What recordings bring back to tell which plan was played.
    pub plan_id: u32,
    /// The runs, in the order in which they are played.
    pub runs: Vec<Rehearsal>,
    /// The files with the runs.
    pub files: Vec<PathBuf>,
    /// The list of runs, where a folder was written.
    pub order: Option<PathBuf>,
    /// A run to be shown: the first with an excitation.
    pub shown: Arc<Playback>,
}

impl Exported {
    /// Runs to be played, repetitions included.
    #[must_use]
    pub fn n_runs(&self) -> usize {
        self.runs.iter().map(|run| run.n_repetitions).sum()
    }

    /// Time on the robot in s, rests and moves included.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        let times = self.runs.iter();
        times
            .map(|run| run.n_repetitions as f64 * run.duration_s)
            .sum()
    }
}
