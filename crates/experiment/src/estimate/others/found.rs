//! Runs found in recordings that belong together, and recordings that are not used.

use crate::error::ExperimentError;
use crate::estimate::others::agreement::{agreeing, keep_common_lines};
use crate::estimate::others::looked::Looked;
use crate::estimate::others::recording::{Recording, Unused};
use crate::estimate::others::run::Run;

/// Recordings that were looked at, with the runs in them that belong together.
pub(super) struct Found {
    /// Number of recordings that were given.
    pub(super) n_given: usize,
    pub(super) recordings: Vec<Recording>,
    pub(super) runs: Vec<Run>,
    pub(super) unused: Vec<Unused>,
    /// Lines that some of the runs do not excite.
    pub(super) not_common: Vec<usize>,
}

impl Found {
    /// The runs of recordings that were looked at.
    ///
    /// # Errors
    /// [`ExperimentError`] where most of them do not agree.
    pub(super) fn of(looked: Looked, runs: Vec<Run>) -> Result<Self, ExperimentError> {
        let Looked {
            n_given,
            recordings,
            mut unused,
        } = looked;
        let mut runs = agreeing(&recordings, runs, &mut unused)?;
        let not_common = keep_common_lines(&mut runs);
        Ok(Self {
            n_given,
            recordings,
            runs,
            unused,
            not_common,
        })
    }

    /// The recording of a run.
    pub(super) fn recording_of(&self, run: &Run) -> &Recording {
        &self.recordings[run.recording]
    }
}
