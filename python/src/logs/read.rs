//! Logs in memory: `frfid.read` and `frfid.inspect`.

use std::path::PathBuf;

use frfid_experiment::inspect_recording;
use frfid_files::{read_log, read_run};
use frfid_signals::Record as Measured;
use pyo3::prelude::*;

use crate::choice::to_python;
use crate::error;
use crate::interrupt::interruptible;
use crate::logs::map::log_map;
use crate::signals::record::Record;
use crate::threads::detached;
use crate::warnings::warn;

/// Reads the log of one run: of frfid itself, or with a map a recording of any make.
///
/// What is told on the command line is a warning here: damage, jitter, delays, units that a name contradicts.
///
/// Parameters
/// ----------
/// path : str or path-like
///     A run that frfid wrote; with a map an MCAP, a rosbag2 folder or ``.db3``, a CSV, MAT or NPZ, each of them
///     as ``.zst``, too.
/// map : dict or str or path-like, optional
///     Which signal is which: the keys of a log map, ``{"u": [{"source": "i", "unit": "A"}], "y": [...], "time":
///     {...}}``, or the TOML file of one.
///
/// Returns
/// -------
/// Record
///     In SI units on an even grid; samples that are lost are NaN.
///
/// Raises
/// ------
/// OSError
///     If the file cannot be read.
/// ValueError
///     For another kind of file, signals that are not there, units that are not known, a clock that is not even.
#[pyfunction]
#[pyo3(signature = (path, *, map = None))]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    map: Option<&Bound<'_, PyAny>>,
) -> PyResult<Record> {
    let map = map.map(log_map).transpose()?;
    error::check_there(&path)?;
    let read = detached(py, || match &map {
        Some(map) => read_log(&path, map).map(|log| (log.record, log.losses, log.warnings)),
        None => read_run(&path).map(|(run, losses)| (run.record, losses, Vec::new())),
    })?;
    let (record, losses, warnings): (Measured, _, Vec<String>) = read.map_err(error::file)?;
    warn(py, losses.iter().map(ToString::to_string).chain(warnings))?;
    Record::read_from(py, record, path)
}

/// What is in a recording, how it is sampled, what is odd about its signals, and a guessed log map.
///
/// Parameters
/// ----------
/// path : str or path-like
///     A recording of any make.
///
/// Returns
/// -------
/// dict
///     ``listing``, the groups of signals that are sampled together; ``looks``, one for each group: sample time,
///     jitter, losses, and every signal with its range and what is odd; ``map``, None or the guessed map with
///     where its units come from.
///
/// Raises
/// ------
/// OSError
///     If the file cannot be read.
/// ValueError
///     If it is no recording.
#[pyfunction]
pub(crate) fn inspect<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Bound<'py, PyAny>> {
    error::check_there(&path)?;
    let inspection = interruptible(py, None, |_| inspect_recording(&path))?;
    to_python(py, &inspection.map_err(error::experiment)?)
}
