//! Runs found in recordings that belong together, and recordings that are not used.

use frfid_estimate::EstimateError;
use frfid_files::LogMap;

use crate::error::ExperimentError;
use crate::estimate::others::agreement::{agreeing, keep_common_lines};
use crate::estimate::others::recording::{Odd, Recording, Unused};
use crate::estimate::others::run::{Run, runs_of};

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
    /// Looks at every recording and finds its runs.
    ///
    /// # Errors
    /// [`ExperimentError`] where none of the recordings is of use, or most do not agree.
    pub(super) fn of(
        mut recordings: Vec<Recording>,
        mut unused: Vec<Unused>,
        map: &LogMap,
    ) -> Result<Self, ExperimentError> {
        let n_given = recordings.len() + unused.len();
        recordings.iter_mut().for_each(Recording::look);
        refuse_what_never_moves(&recordings)?;
        let runs = all_runs(&recordings, &mut unused, map)?;
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

/// Why a recording has no runs.
enum NoRuns {
    /// A signal of it says nothing.
    Refused(String),
    /// Nothing repeats, or no lines stand out.
    Estimate(EstimateError),
}

/// The runs of all recordings; those without are not used.
fn all_runs(
    recordings: &[Recording],
    unused: &mut Vec<Unused>,
    map: &LogMap,
) -> Result<Vec<Run>, ExperimentError> {
    let (mut runs, mut first_error) = (Vec::new(), None);
    for (number, recording) in recordings.iter().enumerate() {
        match useful_runs((number, recording), map) {
            Ok(found) => runs.extend(found),
            Err(NoRuns::Refused(reason)) => unused.push(recording.unused(reason)),
            Err(NoRuns::Estimate(error)) => {
                let error = recording.complaint()(error);
                unused.push(recording.unused(&error));
                first_error.get_or_insert(error);
            }
        }
    }
    match first_error {
        Some(error) if runs.is_empty() => Err(error),
        _ => Ok(runs),
    }
}

fn useful_runs((number, recording): (usize, &Recording), map: &LogMap) -> Result<Vec<Run>, NoRuns> {
    match recording.refusal() {
        Some(reason) => Err(NoRuns::Refused(reason)),
        None => runs_of((number, recording), map).map_err(NoRuns::Estimate),
    }
}

/// Refuses a signal that says nothing in any of the recordings.
fn refuse_what_never_moves(recordings: &[Recording]) -> Result<(), ExperimentError> {
    let Some((first, rest)) = recordings.split_first() else {
        return Ok(());
    };
    let everywhere = |odd: &&Odd| rest.iter().all(|recording| recording.has_as_useless(odd));
    let useless = first
        .odd
        .iter()
        .filter(|odd| odd.is_useless())
        .find(everywhere);
    useless.map_or(Ok(()), |odd| Err(never_moves(odd)))
}

fn never_moves(odd: &Odd) -> ExperimentError {
    ExperimentError::logs(
        "signal of the recordings",
        odd.words(),
        "a signal that moves",
        "check that it is the right signal, that its sensor delivers, and that the axis was free to move",
    )
}
