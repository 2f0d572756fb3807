//! `frfid.Plan`: the runs of an experiment, done on any testbed, and the FRF from their records.

use std::path::PathBuf;

use frfid_experiment::{Guarded, PlannedRuns};
use frfid_signals::{GoOn, RunId, Testbed};
use numpy::PyArray2;
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::choice::{overwrite_if, to_python};
use crate::error;
use crate::frf::matrix::Frf;
use crate::interrupt::interruptible;
use crate::signals::record::Record;
use crate::signals::run::Run;
use crate::size::List;
use crate::testbed::runs::{measured, one_by_one, records_of};
use crate::threads::detached;
use crate::warnings::warn;

/// Every run of an experiment; made by ``Experiment.design``, or read by ``Plan.load``.
#[pyclass(frozen, module = "frfid")]
pub(crate) struct Plan {
    pub(super) planned: PlannedRuns,
}

#[pymethods]
impl Plan {
    /// Reads a plan: what ``save`` or ``frfid design`` wrote.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The MCAP file.
    ///
    /// Returns
    /// -------
    /// Plan
    ///     Its references are those of the file.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     If it is no plan, cut or damaged: a plan moves a robot.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        error::check_there(&path)?;
        let planned = detached(py, || PlannedRuns::load(&path))?;
        Ok(Self {
            planned: planned.map_err(error::experiment)?,
        })
    }

    /// Writes the plan as ``frfid design`` does: every reference, for a player on the robot's side.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The MCAP file to write.
    /// overwrite : bool, optional
    ///     Whether a file of that name is replaced.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If there is a file of that name, or it is the one that the plan is read from.
    /// OSError
    ///     If it cannot be written.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn save(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        let overwrite = overwrite_if(overwrite);
        let written = interruptible(py, None, |progress| {
            let report = |done, total| progress.report(done, total);
            self.planned.write(&path, overwrite, &report)
        })?;
        written.map_err(error::experiment)
    }

    /// Names of the runs in the order in which they are done, glides first: ``"p000-m0-q0"`` is
    /// realization 0, experiment 0, repetition 0.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.ids().iter().map(RunId::to_string).collect()
    }

    /// Time on the robot in s, without the way back to the start.
    #[getter]
    fn robot_time_s(&self) -> PyResult<f64> {
        self.description()
            .plan()
            .robot_time_s()
            .map_err(error::signal)
    }

    /// Reference of one run, from lead-in to end.
    ///
    /// Parameters
    /// ----------
    /// index : int
    ///     Number of the run, its place in ``names``.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape (channel, sample)
    ///     Motor torques in N m in open loop, velocities in rad/s in closed loop; for ``[channels]`` in
    ///     their unit.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there is no such run.
    fn reference<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let ids = self.ids();
        let needed = || {
            PyValueError::new_err(format!(
                "index is {index}, needed a run from 0 to {}",
                ids.len() - 1
            ))
        };
        let id = *ids.get(index).ok_or_else(needed)?;
        Ok(c_ordered(py, self.drawn(py, id)?.reference))
    }

    /// What the runs will ask of the robot, found by doing each of them once on its model.
    ///
    /// Parameters
    /// ----------
    /// progress : callable, optional
    ///     Called with (done, total), from (0, total) on; an exception from it stops the work.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``peaks`` of torque, its rate, velocity and travel per axis, ``crest_factor``, and
    ///     ``excesses`` over the limits.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no robot is described.
    /// NumericalError
    ///     If a run diverges.
    #[pyo3(signature = (*, progress = None))]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let prediction = interruptible(py, progress, |progress| {
            self.planned
                .predict(0, &|done, total| progress.report(done, total))
        })?;
        to_python(py, &prediction.map_err(error::experiment)?)
    }

    /// Does every run.
    ///
    /// An exception, or Ctrl-C, ends it without records; with ``folder`` every run that was done is kept there, and the
    /// next call goes on behind it.
    ///
    /// Parameters
    /// ----------
    /// testbed : object, optional
    ///     Anything with ``run(run: Run) -> Record``, called on this thread for one run after the
    ///     other; the simulated robot of the experiment if left out. A method written as
    ///     ``run(reference)`` gets the array alone, and is refused for runs on a constant velocity.
    /// progress : callable, optional
    ///     Called with (done, total), from (0, total) on; an exception from it stops the work.
    /// jobs : int, optional
    ///     Threads for the simulation, 0 for one on each core.
    /// folder : str or path-like, optional
    ///     Where every record is written as soon as it is measured, as ``frfid run`` does; runs that are there are read,
    ///     not done again.
    /// overwrite : bool, optional
    ///     Whether runs in ``folder`` that were stopped before their end are done again.
    ///
    /// Returns
    /// -------
    /// list of Record
    ///     In the order of ``names``.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no robot is described, or a record does not fit the plan.
    /// OSError
    ///     If a record cannot be written.
    /// NumericalError
    ///     If a simulation diverges.
    #[pyo3(signature = (testbed = None, progress = None, *, jobs = 0, folder = None, overwrite = false))]
    fn run(
        &self,
        py: Python<'_>,
        testbed: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
        jobs: usize,
        folder: Option<PathBuf>,
        overwrite: bool,
    ) -> PyResult<Vec<Record>> {
        let (ids, run) = (self.ids(), |id, go_on: GoOn| {
            self.planned.run_while(id, go_on)
        });
        if testbed.is_none() {
            self.description().model().map_err(error::experiment)?;
        }
        let model = self.description().testbed();
        let machine = testbed
            .map(|object| self.python_testbed(object))
            .transpose()?;
        let machine = machine.as_ref().map(|machine| machine as &dyn Testbed);
        let guarded = machine.map(|machine| Guarded::of(self.description(), machine));
        let bed = guarded
            .as_ref()
            .map_or(&*model, |guarded| guarded as &dyn Testbed);
        let kept = folder
            .as_deref()
            .map(|folder| self.kept(bed, folder, overwrite))
            .transpose()?;
        let bed = kept.as_ref().map_or(bed, |kept| kept);
        let records = match machine {
            Some(_) => one_by_one(py, &ids, &run, bed, progress)?,
            None => records_of(py, &ids, &run, bed, jobs, progress)?,
        };
        records
            .into_iter()
            .map(|record| Record::of(py, vec![record], false))
            .collect()
    }

    /// The FRF from the records of all runs.
    ///
    /// Parameters
    /// ----------
    /// records : sequence of Record or None
    ///     In the order of ``names``; None for a run that is missing. Periods of which an
    ///     experiment is missing are left out, with a warning.
    ///
    /// Returns
    /// -------
    /// Frf
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For another number of records than runs, or records that do not fit the plan.
    /// NumericalError
    ///     For frequencies at which U cannot be inverted.
    fn estimate(&self, py: Python<'_>, records: List<Option<Bound<'_, Record>>>) -> PyResult<Frf> {
        let measured = measured(py, self.ids(), &records.0)?;
        let outcome = interruptible(py, None, |_| self.description().estimate(&measured))?;
        let outcome = outcome.map_err(error::experiment)?;
        warn(py, outcome.warnings)?;
        Ok(Frf::of(outcome.result))
    }

    /// One run: ``plan[0]``; ``for run in plan`` goes through all of them.
    fn __getitem__(&self, py: Python<'_>, index: isize) -> PyResult<Run> {
        let ids = self.ids();
        let place = if index < 0 {
            index + ids.len() as isize
        } else {
            index
        };
        let id = usize::try_from(place).ok().and_then(|place| ids.get(place));
        let id = *id.ok_or_else(|| {
            PyIndexError::new_err(format!("{index}: the plan has {} runs", ids.len()))
        })?;
        let planned = self.drawn(py, id)?;
        Ok(Run::of(py, planned, self.limits(), &self.reference_unit()))
    }

    fn __len__(&self) -> usize {
        self.description().plan().n_runs()
    }

    fn __repr__(&self) -> PyResult<String> {
        let (runs, time_s) = (self.description().plan().n_runs(), self.robot_time_s()?);
        Ok(format!(
            "<frfid.Plan: {runs} runs, {time_s:.1} s on the robot>"
        ))
    }
}
