//! FRFs from logs: `frfid.estimate_logs`.

use frfid_experiment::{EstimateOptions, EstimateTable, recordings_among};
use pyo3::prelude::*;

use crate::choice::from_python;
use crate::error;
use crate::frf::matrix::Frf;
use crate::interrupt::interruptible;
use crate::logs::map::{log_map, paths};
use crate::sources::Sources;
use crate::warnings::warn;

/// The FRF from logs, exactly as ``frfid estimate`` makes it.
///
/// What is told on the command line is a warning here; what is judged stands in ``Frf.checks`` and ``Frf.verdicts``.
///
/// Parameters
/// ----------
/// paths : str or path-like, or sequence of them
///     Logs, or folders of them; of foreign recordings one for each experiment, in their order.
/// map : dict or str or path-like, optional
///     Which signal is which, for recordings that frfid did not make: the keys of a log map, or its TOML file.
/// estimate : dict, optional
///     Keys of the ``[estimate]`` table, in place of the one that travelled with the logs.
/// jobs : int, optional
///     Files read at once, 0 for one on each core.
/// progress : callable, optional
///     Called with (done, total); an exception from it stops the work.
///
/// Returns
/// -------
/// Frf
///
/// Raises
/// ------
/// OSError
///     If a file cannot be read.
/// ValueError
///     For logs that do not belong together, are not periodic, or do not fit the map.
/// NumericalError
///     If U can be inverted on no line.
#[pyfunction]
#[pyo3(signature = (paths, *, map = None, estimate = None, jobs = 0, progress = None))]
pub(crate) fn estimate_logs(
    py: Python<'_>,
    paths: &Bound<'_, PyAny>,
    map: Option<&Bound<'_, PyAny>>,
    estimate: Option<&Bound<'_, PyAny>>,
    jobs: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Frf> {
    let paths = self::paths(paths)?;
    paths.iter().try_for_each(|path| error::check_there(path))?;
    let sources = Sources::of(
        recordings_among(&paths)
            .map_err(error::experiment)?
            .into_iter()
            .chain(map.and_then(|map| map.extract().ok())),
    );
    let table = |table| from_python::<EstimateTable>("estimate", table);
    let options = EstimateOptions {
        map: map.map(log_map).transpose()?,
        estimate: estimate.map(table).transpose()?,
        jobs,
    };
    let outcome = interruptible(py, progress, |progress| {
        let report = |done, total| progress.report(done, total);
        frfid_experiment::estimate_logs(&paths, &options, &report)
    })?;
    let outcome = outcome.map_err(error::experiment)?;
    warn(py, outcome.warnings)?;
    Ok(Frf::read_from(outcome.result, sources))
}
