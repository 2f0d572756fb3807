//! Errors between a description and its result.

use std::path::{Path, PathBuf};

use frfid_estimate::{EstimateError, ShapeError};
use frfid_files::{FileError, Loss};
use frfid_plant::PlantError;
use frfid_signals::format::significant;
use frfid_signals::{Excess, RunId, SignalError, TestbedError};
use thiserror::Error;

use crate::description::text::ConfigError;

/// Errors of the `experiment` crate.
#[derive(Debug, Error)]
pub enum ExperimentError {
    /// The configuration is wrong: file, line, caret, reason and remedy.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A signal, plan or record is not what it should be.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// The robot's model refused.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A run failed on the testbed.
    #[error(transparent)]
    Testbed(#[from] TestbedError),
    /// The records do not give an FRF.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// A recording that does not give an FRF.
    #[error("{}: {source}{}", path.display(), lost.as_deref().map_or(String::new(), |lost| format!(" (lost: {lost})")))]
    Recording {
        /// The recording.
        path: PathBuf,
        /// What is wrong with it.
        source: EstimateError,
        /// What of it is lost, which may be why.
        lost: Option<String>,
    },
    /// Somebody asked to stop.
    #[error(
        "interrupted after {done} of {total} runs; what was done is kept, the same command goes on from there"
    )]
    Interrupted {
        /// Runs done.
        done: usize,
        /// Runs in all.
        total: usize,
    },
    /// A reference that could not be shaped.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Somebody asked to stop a shaping.
    #[error(
        "interrupted in iteration {iteration}; what was done is kept, the same command goes on from there"
    )]
    ShapingInterrupted {
        /// The iteration, from 1, whose runs are not all done.
        iteration: usize,
    },
    /// A file in the folder of a shaping that does not belong to it.
    #[error("{}: found {found}, needed {needed}; {advice}", path.display())]
    Trail {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: String,
        /// What it should be.
        needed: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// The operating system gave no threads.
    #[error("cannot start {jobs} threads: {reason}; ask for fewer with --jobs")]
    Threads {
        /// Threads asked for.
        jobs: usize,
        /// The reason given.
        reason: String,
    },
    /// A run that would take a machine beyond a limit.
    #[error(
        "run {run}, played from rest to rest: the {what} of {joint} reaches {} {}, {} is {}; \
         lower the amplitudes or the constant velocity, or raise the limit",
        significant(excess.found, 4), excess.limit.unit(), excess.limit.key(), significant(excess.allowed, 4)
    )]
    Exceeds {
        /// The run.
        run: RunId,
        /// What exceeds it: the reference, or the predicted motion.
        what: &'static str,
        /// Which joint.
        joint: String,
        /// The limit and the value reached.
        excess: Excess,
    },
    /// A description without a robot, where one is simulated.
    #[error(
        "no robot model: [channels] describe what a machine is driven by, not how it answers; play the plan on the machine \
         (frfid export, frfid run --player, Plan.run(testbed) of Python), or describe a [robot]"
    )]
    NoModel,
    /// A machine that is busy.
    #[error("{}: another frfid, or its player, is still at work; wait for its end", lock.display())]
    AtWork {
        /// The file that it holds.
        lock: PathBuf,
    },
    /// Logs that do not belong together, or not to this plan.
    #[error("{what}: found {found}, needed {needed}; {advice}")]
    Logs {
        /// Which property.
        what: &'static str,
        /// What was found.
        found: String,
        /// What was needed.
        needed: String,
        /// What to do.
        advice: &'static str,
    },
}

impl ExperimentError {
    /// [`ExperimentError::Logs`] in the order in which it is read.
    pub(crate) fn logs(
        what: &'static str,
        found: impl Into<String>,
        needed: impl Into<String>,
        advice: &'static str,
    ) -> Self {
        Self::Logs {
            what,
            found: found.into(),
            needed: needed.into(),
            advice,
        }
    }

    /// The error of an estimate; that no run is left is said with the first of what was lost.
    pub(crate) fn beside(self, lost: Option<&(usize, Loss)>) -> Self {
        let is_empty = matches!(self, Self::Estimate(EstimateError::EmptyList("runs")));
        match lost {
            Some((_, lost)) if is_empty => Self::logs(
                "periods of the logs",
                format!("none that is whole; {lost}"),
                "one at least without a lost sample, in every experiment of a realization",
                "do the runs again, or look into the logs by frfid inspect",
            ),
            _ => self,
        }
    }

    /// [`ExperimentError::Trail`] in the order in which it is read.
    pub(crate) fn trail(
        path: &Path,
        found: impl Into<String>,
        needed: &'static str,
        advice: &'static str,
    ) -> Self {
        Self::Trail {
            path: path.to_owned(),
            found: found.into(),
            needed,
            advice,
        }
    }
}
