//! Logs of others, recordings that frfid did not make, to an FRF. Nothing in them is believed unseen:
//! every signal is looked at, every recording is held against the others, runs, period, lines, clock
//! and settling are found in them, realizations are told by their phases.

mod agreement;
mod checks;
mod estimated;
mod evidence;
mod found;
mod outcome;
mod placing;
mod provenance;
mod recording;
mod run;

use std::path::PathBuf;

use frfid_files::LogMap;

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::others::found::Found;
use crate::estimate::others::recording::reading::{Read, hashes, read};
use crate::estimate::outcome::Outcome;

/// Estimates the FRF from recordings of a periodic excitation, one run for each experiment: the
/// columns of U first, then the next realization; runs of one draw of phases are repetitions.
/// Without a reference in the map the input itself is searched.
///
/// # Errors
/// [`ExperimentError`]: recordings none of which can be read, that are not periodic, do not agree or
/// never settle, too few of them for the inputs, a method that needs a reference without one.
pub(crate) fn estimate_others_logs(
    paths: &[PathBuf],
    map: &LogMap,
    options: &EstimateTable,
) -> Result<Outcome, ExperimentError> {
    check_reference(map, options)?;
    let hashes = hashes(paths)?;
    let Read { recordings, unused } = read(paths, map)?;
    let mut found = Found::of(recordings, unused, map)?;
    let estimated = found.estimate(map, options)?;
    let mut outcome = found.outcome(estimated, map, options);
    outcome.result.provenance.extend(hashes);
    Ok(outcome)
}

/// Refuses a method that estimates through a reference that is not there.
fn check_reference(map: &LogMap, options: &EstimateTable) -> Result<(), ExperimentError> {
    let is_needed = options.method().needs_reference() || options.response_but_plant().is_some();
    if !map.r.is_empty() || !is_needed {
        return Ok(());
    }
    Err(ExperimentError::logs(
        "reference",
        "none in the log map",
        "one for each input: the estimate goes through it",
        "name it by --r, r in the map, or estimate without --indirect and --response",
    ))
}
