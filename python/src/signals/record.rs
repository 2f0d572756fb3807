//! `frfid.Record`: one run or a batch of runs.

use std::path::PathBuf;

use frfid_files::{RunFile, read_run, write_run};
use frfid_signals::room::room;
use frfid_signals::{Event, Injection, InputKind, Record as Run, RunId};
use ndarray::{Array2, Axis, Ix2};
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::choice::{choice, overwrite_if, to_python};
use crate::error;
use crate::pickle::{Reduced, attributes};
use crate::signals::channels::{events_of_runs, signal, signal_like};
use crate::size::List;
use crate::sources::Sources;
use crate::threads::detached;
use crate::warnings::warn;

/// What one run measured, or a batch of runs.
///
/// ``y[..., k]`` is what the sensor says at ``k * sample_time_s``, just before ``u[..., k]`` acts.
///
/// Parameters
/// ----------
/// sample_time_s : float
///     Sample time in s.
/// u, y : array_like, shape (channel, sample) or (batch, channel, sample)
///     Plant input (motor torque in N m) and output (motor velocity in rad/s).
/// r, position_rad : array_like, same number of samples, optional
///     Reference that was injected, and motor position in rad.
/// input_kind : {"commanded", "measured"}, optional
///     Whether ``u`` is the command or a measurement.
/// events : list of dict, optional
///     What happened, in order of time: ``{"time_s": 0.5, "event": "stopped", "reason": "..."}``; a
///     list of these per run for a batch.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit together and samples that are not finite.
#[pyclass(frozen, module = "frfid")]
pub(crate) struct Record {
    /// Sample time in s.
    #[pyo3(get)]
    sample_time_s: f64,
    /// Plant input, shape (channel, sample) or (batch, channel, sample).
    #[pyo3(get)]
    u: Py<PyArrayDyn<f64>>,
    /// Plant output, shape (channel, sample) or (batch, channel, sample).
    #[pyo3(get)]
    y: Py<PyArrayDyn<f64>>,
    /// Reference, shape (channel, sample) or (batch, channel, sample), or None.
    #[pyo3(get)]
    r: Option<Py<PyArrayDyn<f64>>>,
    /// Motor position in rad, shape (channel, sample) or (batch, channel, sample), or None.
    #[pyo3(get)]
    position_rad: Option<Py<PyArrayDyn<f64>>>,
    input_kind: InputKind,
    events: Vec<Vec<Event>>,
    sources: Sources,
}

#[pymethods]
impl Record {
    #[new]
    #[pyo3(signature = (*, sample_time_s, u, y, r = None, position_rad = None, input_kind = "commanded", events = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn new(
        py: Python<'_>,
        sample_time_s: f64,
        u: &Bound<'_, PyAny>,
        y: &Bound<'_, PyAny>,
        r: Option<&Bound<'_, PyAny>>,
        position_rad: Option<&Bound<'_, PyAny>>,
        input_kind: &str,
        events: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let u = signal("u", u)?;
        let shape = u.bind(py).shape();
        let batch = shape.len() == 3;
        let n_runs = if batch { shape[0] } else { 1 };
        let like_u = |name: &str, value| signal_like(name, value, shape);
        let record = Self {
            sample_time_s,
            y: like_u("y", y)?,
            r: r.map(|r| like_u("r", r)).transpose()?,
            position_rad: position_rad
                .map(|position| like_u("position_rad", position))
                .transpose()?,
            input_kind: choice("input_kind", input_kind)?,
            events: events_of_runs(events, batch, n_runs)?,
            sources: Sources::default(),
            u,
        };
        let checked = record.runs(py).iter().try_for_each(Run::check);
        checked.map_err(error::signal)?;
        Ok(record)
    }

    /// Reads a run that ``save`` or ``frfid run`` wrote.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The MCAP file.
    ///
    /// Returns
    /// -------
    /// Record
    ///     Samples that are lost are NaN, and told in a warning.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     If it is no run of frfid; ``frfid.read`` reads other recordings.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        error::check_there(&path)?;
        let (run, losses) = detached(py, || read_run(&path))?.map_err(error::file)?;
        warn(py, losses.iter().map(ToString::to_string))?;
        Self::read_from(py, run.record, path)
    }

    /// Writes one run as ``frfid run`` does: an MCAP of JointState messages, which Foxglove and PlotJuggler open.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The file to write.
    /// joint_names : sequence of str, optional
    ///     A name for each axis; numbered without.
    /// overwrite : bool, optional
    ///     Whether a file of that name is replaced.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If there is a file of that name, or it is the one that the record was read from.
    /// OSError
    ///     If it cannot be written.
    /// ValueError
    ///     For a batch of runs, or names that are not as many as axes.
    #[pyo3(signature = (path, *, joint_names = None, overwrite = false))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        joint_names: Option<List<String>>,
        overwrite: bool,
    ) -> PyResult<()> {
        self.sources.check(&path)?;
        let Ok([record]) = <[Run; 1]>::try_from(self.runs(py)) else {
            return Err(PyValueError::new_err(
                "a batch of runs: save them one by one",
            ));
        };
        let n_joints = record.u.nrows().max(record.y.nrows());
        let numbered = || {
            (1..=n_joints)
                .map(|joint| format!("joint {joint}"))
                .collect()
        };
        let file = RunFile {
            joint_names: joint_names.map_or_else(numbered, |List(names)| names),
            run: RunId::excitation(0, 0, 0),
            injection: Injection::default(),
            record,
            metadata: [(
                "frfid_version".to_owned(),
                env!("CARGO_PKG_VERSION").to_owned(),
            )]
            .into(),
            experiment_toml: String::new(),
        };
        let written = detached(py, || write_run(&path, overwrite_if(overwrite), &file))?;
        written.map_err(error::file)
    }

    /// Whether ``u`` is the command ("commanded") or a measurement ("measured").
    #[getter]
    fn input_kind<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.input_kind)
    }

    /// What happened, in order of time: a list of dicts, or a list of such lists for a batch.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        if self.is_batch(py) {
            to_python(py, &self.events)
        } else {
            to_python(py, &self.events[0])
        }
    }

    /// Number of samples of one run.
    #[getter]
    fn n_samples(&self, py: Python<'_>) -> usize {
        self.u.bind(py).shape().last().copied().unwrap_or_default()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let (u, y) = (self.u.bind(py).shape(), self.y.bind(py).shape());
        format!(
            "<frfid.Record: u {u:?}, y {y:?}, {} s per sample>",
            self.sample_time_s
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        attributes(
            slf,
            &[
                "sample_time_s",
                "u",
                "y",
                "r",
                "position_rad",
                "input_kind",
                "events",
            ],
        )
    }
}

impl Record {
    /// What the crates measured: one run, or a batch of runs `stacked` on an axis of their own.
    pub(crate) fn of(py: Python<'_>, runs: Vec<Run>, stacked: bool) -> PyResult<Self> {
        let [first, ..] = runs.as_slice() else {
            return Err(PyValueError::new_err("no run was done"));
        };
        let (sample_time_s, input_kind) = (first.sample_time_s, first.input_kind);
        let events = runs.iter().map(|run| run.events.clone()).collect();
        let stack =
            |of: &dyn Fn(&Run) -> Option<&Array2<f64>>| -> PyResult<Option<Py<PyArrayDyn<f64>>>> {
                let Some(signals) = runs.iter().map(of).collect::<Option<Vec<_>>>() else {
                    return Ok(None);
                };
                let array = if stacked {
                    room::<f64>(signals.iter().map(|signal| signal.len()).sum())
                        .map_err(error::signal)?;
                    let views: Vec<_> = signals.iter().map(|signal| signal.view()).collect();
                    ndarray::stack(Axis(0), &views)
                        .map_err(|error| PyValueError::new_err(error.to_string()))?
                        .into_dyn()
                } else {
                    signals[0].clone().into_dyn()
                };
                Ok(Some(c_ordered(py, array).unbind()))
            };
        let always = "every record has u and y";
        Ok(Self {
            sample_time_s,
            u: stack(&|run| Some(&run.u))?.expect(always),
            y: stack(&|run| Some(&run.y))?.expect(always),
            r: stack(&|run| run.r.as_ref())?,
            position_rad: stack(&|run| run.position_rad.as_ref())?,
            input_kind,
            events,
            sources: Sources::default(),
        })
    }

    /// The run of a file.
    pub(crate) fn read_from(py: Python<'_>, run: Run, path: PathBuf) -> PyResult<Self> {
        Ok(Self {
            sources: Sources::of([path]),
            ..Self::of(py, vec![run], false)?
        })
    }

    /// Every run as the crates know it.
    pub(crate) fn runs(&self, py: Python<'_>) -> Vec<Run> {
        let of = |signal: &Py<PyArrayDyn<f64>>| -> Vec<Array2<f64>> {
            let array = signal.bind(py).to_owned_array();
            let stacked = if array.ndim() == 2 {
                array.insert_axis(Axis(0))
            } else {
                array
            };
            let two_axes = |run: ndarray::ArrayViewD<'_, f64>| {
                run.into_dimensionality::<Ix2>().map(|run| run.to_owned())
            };
            stacked
                .axis_iter(Axis(0))
                .map(two_axes)
                .collect::<Result<_, _>>()
                .expect("`signal` let 2 or 3 axes pass")
        };
        let (u, y, r, position) = (
            of(&self.u),
            of(&self.y),
            self.r.as_ref().map(of),
            self.position_rad.as_ref().map(of),
        );
        let run = |k: usize| Run {
            sample_time_s: self.sample_time_s,
            u: u[k].clone(),
            y: y[k].clone(),
            r: r.as_ref().map(|r| r[k].clone()),
            position_rad: position.as_ref().map(|position| position[k].clone()),
            input_kind: self.input_kind,
            events: self.events[k].clone(),
        };
        (0..u.len()).map(run).collect()
    }

    /// Whether the runs have an axis of their own.
    pub(crate) fn is_batch(&self, py: Python<'_>) -> bool {
        self.u.bind(py).ndim() == 3
    }
}
