//! `Plan.import_recordings`: the runs of a plan in recordings of others.

use std::path::PathBuf;

use frfid_experiment::{ImportOptions, import_recordings, recordings_among};
use pyo3::prelude::*;

use crate::choice::{overwrite_if, to_python};
use crate::error;
use crate::experiment::plan::Plan;
use crate::interrupt::interruptible;
use crate::logs::map::{log_map, paths};
use crate::warnings::warn;

#[pymethods]
impl Plan {
    /// Recognises the runs of this plan in recordings of others and writes them as runs of our own, as
    /// ``frfid import`` does.
    ///
    /// What looks wrong, what was not used and which runs are missing are warnings. ``estimate_logs(folder)`` makes
    /// the FRF of what is written.
    ///
    /// Parameters
    /// ----------
    /// recordings : str or path-like, or sequence of them
    ///     Recordings, or folders of them: one of the whole campaign, or one of each run, in any order.
    /// map : dict or str or path-like
    ///     Which signal is which: the keys of a log map, or its TOML file.
    /// folder : str or path-like
    ///     Where the runs are written, one MCAP each.
    /// rate_hz : float, optional
    ///     Samples a second of the player, where it was not the plan's.
    /// overwrite : bool, optional
    ///     Whether files that exist are replaced.
    /// progress : callable, optional
    ///     Called with (done, total); an exception from it stops the work.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``imported``, a dict for each run (``run``, ``recording``, ``start_s``, ``clock_ppm``, ``likeness``,
    ///     ``rival``, ``n_lost``, ``stopped_s``), ``n_skipped``, ``missing``, ``unused``, ``warnings``, ``excesses``.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If a file cannot be read or written.
    /// ValueError
    ///     For a map that does not fit the plan, and recordings without a run of it.
    #[pyo3(signature = (recordings, map, folder, *, rate_hz = None, overwrite = false, progress = None))]
    #[expect(clippy::too_many_arguments, reason = "options with names")]
    fn import_recordings<'py>(
        &self,
        py: Python<'py>,
        recordings: &Bound<'py, PyAny>,
        map: &Bound<'py, PyAny>,
        folder: PathBuf,
        rate_hz: Option<f64>,
        overwrite: bool,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let recordings = paths(recordings)?;
        recordings
            .iter()
            .try_for_each(|path| error::check_there(path))?;
        let recordings = recordings_among(&recordings).map_err(error::experiment)?;
        let (map, overwrite) = (log_map(map)?, overwrite_if(overwrite));
        let options = ImportOptions { rate_hz, overwrite };
        let summary = interruptible(py, progress, |progress| {
            let report = |done, total| progress.report(done, total);
            import_recordings(&self.planned, &recordings, &map, &folder, &options, &report)
        })?;
        let summary = summary.map_err(error::experiment)?;
        warn(py, summary.told())?;
        to_python(py, &summary)
    }
}
