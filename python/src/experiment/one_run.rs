//! One run of a plan and its log: `frfid.run_experiment`, for job arrays.

use std::path::PathBuf;

use frfid_experiment::{PlannedRuns, RunOptions, run_path, run_to_folder};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::error;
use crate::interrupt::interruptible;

/// Does one run of a plan in simulation and writes its log, as ``frfid run --index``.
///
/// Plain types in and out, no state, noise drawn from the plan's seed and the run alone: any scheduler can
/// call it, in any order, as often as it likes. A log that is there and belongs to the plan is left as
/// it is.
///
/// Parameters
/// ----------
/// plan : str or path-like
///     A plan file, or the description of an experiment (``.toml``).
/// index : int
///     Which run, from 0, in the order of ``Plan.names``.
/// folder : str or path-like
///     Where the logs are; it is made if it does not exist.
///
/// Returns
/// -------
/// str
///     The path of the log.
///
/// Raises
/// ------
/// OSError
///     If the plan cannot be read or the log not written.
/// IndexError
///     If the plan has no such run.
/// ValueError
///     For a plan that is damaged, and a file in the way that is not this run's.
/// NumericalError
///     If the simulation diverges.
#[pyfunction]
pub(crate) fn run_experiment(
    py: Python<'_>,
    plan: PathBuf,
    index: usize,
    folder: PathBuf,
) -> PyResult<PathBuf> {
    error::check_there(&plan)?;
    let planned = PlannedRuns::load(&plan).map_err(error::experiment)?;
    let ids = planned.run_ids();
    let Some(&id) = ids.get(index) else {
        let n_runs = ids.len();
        return Err(PyIndexError::new_err(format!(
            "index is {index}, the plan has {n_runs} runs, from 0"
        )));
    };
    let options = RunOptions {
        jobs: 1,
        index: Some(index),
        ..RunOptions::default()
    };
    let done = interruptible(py, None, |progress| {
        let report = |done, total| progress.report(done, total);
        run_to_folder(&planned, None, &folder, &options, &report)
    })?;
    done.map_err(error::experiment)?;
    Ok(run_path(&folder, id))
}
