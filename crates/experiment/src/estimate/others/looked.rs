//! Recordings that were looked at: what of them is of use, and what repeats in them.

use frfid_estimate::EstimateError;
use frfid_files::LogMap;

use crate::error::ExperimentError;
use crate::estimate::others::recording::{Odd, Recording, Unused};
use crate::estimate::others::run::{Run, runs_of};

/// Recordings that were looked at.
pub(super) struct Looked {
    /// Number of recordings that were given.
    pub(super) n_given: usize,
    pub(super) recordings: Vec<Recording>,
    pub(super) unused: Vec<Unused>,
}

impl Looked {
    /// Looks at every recording.
    ///
    /// # Errors
    /// [`ExperimentError`] where a signal says nothing in any of them.
    pub(super) fn of(
        mut recordings: Vec<Recording>,
        unused: Vec<Unused>,
    ) -> Result<Self, ExperimentError> {
        let n_given = recordings.len() + unused.len();
        recordings.iter_mut().for_each(Recording::look);
        refuse_what_never_moves(&recordings)?;
        Ok(Self {
            n_given,
            recordings,
            unused,
        })
    }

    /// The runs of all recordings; those without are not used.
    ///
    /// # Errors
    /// [`ExperimentError`] of the first recording where none has any; all are then as before.
    pub(super) fn runs(&mut self, map: &LogMap) -> Result<Vec<Run>, ExperimentError> {
        let (mut runs, mut unused, mut first_error) = (Vec::new(), Vec::new(), None);
        for (number, recording) in self.recordings.iter().enumerate() {
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
            _ => {
                self.unused.extend(unused);
                Ok(runs)
            }
        }
    }
}

/// Why a recording has no runs.
enum NoRuns {
    /// A signal of it says nothing.
    Refused(String),
    /// Nothing repeats, or no lines stand out.
    Estimate(EstimateError),
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
