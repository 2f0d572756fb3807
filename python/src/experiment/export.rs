//! `Plan.export`: the runs of a plan in the files that the players of robots take.

use std::path::{Path, PathBuf};

use frfid_experiment::PlayOptions;
use frfid_files::{Exported, Overwrite, PlayFormat, TableForm, check_free, write_bytes};
use frfid_report::{PLAN_PAGE, plan_page};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::choice::{choice, overwrite_if, to_python};
use crate::error;
use crate::experiment::plan::Plan;
use crate::interrupt::interruptible;
use crate::size::List;

#[pymethods]
impl Plan {
    /// Writes every run from rest to rest, for the player of a robot, once all of them keep the limits.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     A folder, which gets the runs, ``runs.csv`` with their order, and ``plan.html``: read it before anything
    ///     moves. Or a file with the format's ending, for one reference or ``campaign``.
    /// to : {"csv", "mat", "joint-trajectory", "float64-array"}, optional
    ///     The format.
    /// rate_hz : float, optional
    ///     The player's samples a second; the plan's own if left out.
    /// campaign : bool, optional
    ///     One file with all runs in order, repetitions, moves and rests between them included.
    /// separator : {"comma", "semicolon", "tab"}, optional
    ///     Between the columns of a CSV.
    /// decimal : {"point", "comma"}, optional
    ///     Before the decimals of a CSV.
    /// angle : {"rad", "deg", "turn", "rpm"}, optional
    ///     Unit of a table's angles.
    /// gear_ratio : sequence of float, optional
    ///     Turns of the motor for a turn of the joint, of either sign: a table on the motor side.
    /// jobs : int, optional
    ///     Threads for the check of the limits, 0 for one on each core.
    /// overwrite : bool, optional
    ///     Whether files that exist are replaced.
    /// progress : callable, optional
    ///     Called with (done, total), from (0, total) on; an exception from it stops the work.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``files``, ``plan_id``, ``rate_hz``, ``n_runs`` and ``duration_s``.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If there is a file of that name, or it is the one that the plan is read from.
    /// ValueError
    ///     If a run exceeds a limit or cannot be played, or the options do not fit.
    /// OSError
    ///     If a file cannot be written.
    #[pyo3(signature = (path, to = "csv", *, rate_hz = None, campaign = false, separator = "comma", decimal = "point", angle = "rad", gear_ratio = None, jobs = 0, overwrite = false, progress = None))]
    #[expect(clippy::too_many_arguments, reason = "options with names")]
    fn export<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        to: &str,
        rate_hz: Option<f64>,
        campaign: bool,
        separator: &str,
        decimal: &str,
        angle: &str,
        gear_ratio: Option<List<f64>>,
        jobs: usize,
        overwrite: bool,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = PlayOptions {
            format: PlayFormat::named(to).map_err(error::file)?,
            rate_hz,
            form: TableForm {
                separator: choice("separator", separator)?,
                decimal: choice("decimal", decimal)?,
                angle: choice("angle", angle)?,
                gear_ratio: gear_ratio.map_or_else(Vec::new, |List(ratios)| ratios),
            },
            is_campaign: campaign,
            jobs,
            overwrite: overwrite_if(overwrite),
        };
        self.exported(py, path, &options, progress)
    }
}

impl Plan {
    /// Writes the files and the page beside them.
    fn exported<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        options: &PlayOptions,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.planned
            .check_output(&path)
            .map_err(error::experiment)?;
        let page = (!options.format.is_ending_of(&path)).then(|| path.join(PLAN_PAGE));
        let mut pages = page.iter();
        let free = pages.try_for_each(|page| check_free(page, options.overwrite));
        free.map_err(error::file)?;
        let exported = interruptible(py, progress, |progress| {
            let report = |done, total| progress.report(done, total);
            self.planned.export(&path, options, &report)
        })?;
        let exported = exported.map_err(error::experiment)?;
        page.map_or(Ok(()), |page| {
            write_page(&page, &exported, options.overwrite)
        })?;
        told(py, &exported)
    }
}

fn write_page(page: &Path, exported: &Exported, overwrite: Overwrite) -> PyResult<()> {
    let html = plan_page(exported).map_err(error::report)?;
    write_bytes(page, overwrite, html.as_bytes()).map_err(error::file)
}

fn told<'py>(py: Python<'py>, exported: &Exported) -> PyResult<Bound<'py, PyAny>> {
    to_python(py, &as_json(exported))
}

fn as_json(exported: &Exported) -> Value {
    json!({
        "files": exported.files,
        "plan_id": exported.plan_id,
        "rate_hz": exported.player.rate_hz,
        "n_runs": exported.n_runs(),
        "duration_s": exported.duration_s(),
    })
}
