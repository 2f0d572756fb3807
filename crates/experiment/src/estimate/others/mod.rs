//! Logs of others, recordings that frfid did not make, to an FRF. Nothing in them is believed unseen:
//! every signal is looked at, every recording is held against the others, runs, period, lines, clock
//! and settling are found in them, realizations are told by their phases.

mod agreement;
mod checks;
mod estimated;
mod evidence;
mod found;
mod local;
mod looked;
mod outcome;
mod placing;
mod provenance;
mod recording;
mod run;

use std::path::PathBuf;

use frfid_estimate::{Aperiodic, EstimateError};
use frfid_files::LogMap;

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::others::found::Found;
use crate::estimate::others::local::by_local_models;
use crate::estimate::others::looked::Looked;
use crate::estimate::others::recording::reading::{Read, hashes, read};
use crate::estimate::others::run::Run;
use crate::estimate::outcome::Outcome;

/// Estimates the FRF from recordings of a periodic excitation, one run for each experiment: the
/// columns of U first, then the next realization; runs of one draw of phases are repetitions.
/// Without a reference in the map the input itself is searched. Where nothing repeats, by local models.
///
/// # Errors
/// [`ExperimentError`]: recordings none of which can be read, that repeat in part, do not agree or
/// never settle, too few of them for the inputs, a method that needs a reference without one.
pub(crate) fn estimate_others_logs(
    paths: &[PathBuf],
    map: &LogMap,
    options: &EstimateTable,
) -> Result<Outcome, ExperimentError> {
    check_reference(map, options)?;
    check_friction(options)?;
    let hashes = hashes(paths)?;
    let Read { recordings, unused } = read(paths, map)?;
    let mut looked = Looked::of(recordings, unused)?;
    let mut outcome = match runs_or_none(&mut looked, map, options)? {
        Some(runs) => of_runs(Found::of(looked, runs)?, map, options)?,
        None => by_local_models(looked, map, options)?,
    };
    outcome.result.provenance.extend(hashes);
    Ok(outcome)
}

/// The runs of recordings; `None` where nothing repeats, and nothing was asked for that only periods give.
fn runs_or_none(
    looked: &mut Looked,
    map: &LogMap,
    options: &EstimateTable,
) -> Result<Option<Vec<Run>>, ExperimentError> {
    let is_stated = map.period_s.is_some() || map.lines.is_some() || map.realization_of.is_some();
    let of_periods = is_stated || options.is_of_periods();
    match (map.aperiodic, of_periods) {
        (true, true) => Err(periods_of_nothing()),
        (true, false) => Ok(None),
        (false, _) => match looked.runs(map) {
            Err(error) if !of_periods && repeats_nothing(&error) => Ok(None),
            runs => runs.map(Some),
        },
    }
}

fn periods_of_nothing() -> ExperimentError {
    ExperimentError::logs(
        "recordings that are aperiodic",
        "a period, lines, realizations, a method that averages periods, or a response of the loop",
        "none of these: local models estimate the plant from whole records",
        "leave them out, or leave out aperiodic",
    )
}

fn repeats_nothing(error: &ExperimentError) -> bool {
    let ExperimentError::Recording { source, .. } = error else {
        return false;
    };
    let EstimateError::NotPeriodic { cause, .. } = source else {
        return false;
    };
    matches!(cause, Aperiodic::Nothing | Aperiodic::SingleSweep)
}

fn of_runs(
    mut found: Found,
    map: &LogMap,
    options: &EstimateTable,
) -> Result<Outcome, ExperimentError> {
    let estimated = found.estimate(map, options)?;
    Ok(found.outcome(estimated, map, options))
}

/// Refuses what is done for the runs of a plan alone.
fn check_friction(options: &EstimateTable) -> Result<(), ExperimentError> {
    if !options.subtract_friction {
        return Ok(());
    }
    Err(ExperimentError::logs(
        "recordings",
        "such that are not runs of a plan",
        "runs of a plan, whose band and rests are known, to take friction off",
        "give the plan by --plan, or leave subtract_friction out",
    ))
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
