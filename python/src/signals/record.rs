//! `frfid.Record`: one run or a batch of runs.

use std::path::PathBuf;

use frfid_files::{RunFile, read_run, write_run};
use frfid_signals::{Event, Injection, InputKind, Record as Run, RunId};
use numpy::{PyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

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
    pub(super) sample_time_s: f64,
    /// Plant input, shape (channel, sample) or (batch, channel, sample).
    #[pyo3(get)]
    pub(super) u: Py<PyArrayDyn<f64>>,
    /// Plant output, shape (channel, sample) or (batch, channel, sample).
    #[pyo3(get)]
    pub(super) y: Py<PyArrayDyn<f64>>,
    /// Reference, shape (channel, sample) or (batch, channel, sample), or None.
    #[pyo3(get)]
    pub(super) r: Option<Py<PyArrayDyn<f64>>>,
    /// Motor position in rad, shape (channel, sample) or (batch, channel, sample), or None.
    #[pyo3(get)]
    pub(super) position_rad: Option<Py<PyArrayDyn<f64>>>,
    pub(super) input_kind: InputKind,
    pub(super) events: Vec<Vec<Event>>,
    pub(super) sources: Sources,
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
