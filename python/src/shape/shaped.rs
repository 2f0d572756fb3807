//! `frfid.Shaped`: what came of iterative shaping.

use std::fmt::Write as _;

use frfid_estimate::{OctaveError, Shaped as Shaping, Summary};
use ndarray::Array1;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::choice::to_python;
use crate::frf::matrix::Frf;
use crate::signals::record::Record;

/// A shaped excitation: the best iteration, and what every iteration found; made by
/// ``frfid.shape``. Printed, it is a table.
#[pyclass(frozen, module = "frfid")]
pub(crate) struct Shaped {
    shaping: Shaping,
    /// Records of the best iteration, one for each experiment.
    #[pyo3(get)]
    records: Vec<Py<Record>>,
}

#[pymethods]
impl Shaped {
    /// The reference to use, in rad/s, shape (experiment, channel, sample): that of the best
    /// iteration.
    #[getter]
    fn reference<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        c_ordered(py, self.shaping.best.reference.clone())
    }

    /// Number of the best iteration, from 1.
    #[getter]
    fn number(&self) -> usize {
        self.shaping.best.number
    }

    /// Relative error of the best iteration, rms over band and channels.
    #[getter]
    fn error(&self) -> Option<f64> {
        self.shaping.best.error()
    }

    /// The same of every iteration; None where a run was stopped before its end.
    #[getter]
    fn errors(&self) -> Vec<Option<f64>> {
        self.shaping
            .iterations
            .iter()
            .map(|iteration| iteration.error)
            .collect()
    }

    /// Relative error of the best iteration, shape (frequency, channel), at the frequencies of
    /// ``r_to_u``.
    #[getter]
    fn error_per_frequency<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.shaping
            .best
            .estimate
            .as_ref()
            .map(|estimate| c_ordered(py, estimate.error_per_frequency.clone()))
    }

    /// Response from reference to torque in the best iteration.
    #[getter]
    fn r_to_u(&self) -> Option<Frf> {
        self.shaping
            .best
            .estimate
            .as_ref()
            .map(|estimate| estimate.r_to_u.clone().into())
    }

    /// Response from reference to velocity in the best iteration.
    #[getter]
    fn r_to_y(&self) -> Option<Frf> {
        self.shaping
            .best
            .estimate
            .as_ref()
            .map(|estimate| estimate.r_to_y.clone().into())
    }

    /// Condition number of U in the best iteration, every channel relative to its desired size,
    /// shape (frequency,).
    #[getter]
    fn condition<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.shaping
            .best
            .estimate
            .as_ref()
            .map(|estimate| c_ordered(py, Array1::from(estimate.condition.clone())))
    }

    /// Share of the sweep that each axis was stuck in the best iteration.
    #[getter]
    fn stuck_share(&self) -> Vec<f64> {
        self.shaping.best.stuck_share.clone()
    }

    /// Where axes still stick in the best iteration, in sentences; empty if none does.
    #[getter]
    fn sticking(&self) -> Vec<String> {
        self.shaping
            .sticking
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    /// Every iteration as a dict: errors over the band and octave by octave, stuck share, damping, peaks predicted and measured,
    /// notes.
    #[getter]
    fn iterations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.shaping.iterations)
    }

    /// What is worth saying of the iterations, in sentences.
    #[getter]
    fn notes(&self) -> Vec<String> {
        let of = |iteration: &Summary| {
            let number = iteration.number;
            iteration
                .notes
                .iter()
                .map(|note| format!("iteration {number}: {note}"))
                .collect::<Vec<_>>()
        };
        self.shaping.iterations.iter().flat_map(of).collect()
    }

    /// Why it ended.
    #[getter]
    fn stop(&self) -> String {
        self.shaping.stop.to_string()
    }

    fn __str__(&self) -> String {
        let mut text = String::from("iteration  error %  stuck % per axis");
        for iteration in &self.shaping.iterations {
            let error = iteration
                .error
                .map_or("-".into(), |error| format!("{:.1}", 100.0 * error));
            let stuck: Vec<String> = iteration
                .stuck_share
                .iter()
                .map(|share| format!("{:.0}", 100.0 * share))
                .collect();
            let _ = write!(
                text,
                "\n{:>9}  {error:>7}  {}",
                iteration.number,
                stuck.join(" ")
            ); // a String takes everything
        }
        let _ = write!(
            text,
            "\n{}; the best is iteration {}",
            self.shaping.stop,
            self.number()
        );
        let estimate = self.shaping.best.estimate.as_ref();
        if let Some(worst) =
            estimate.and_then(|best| OctaveError::worst_in_words(&best.octave_error))
        {
            let _ = write!(text, "\noff {worst}");
        }
        self.sticking()
            .iter()
            .for_each(|line| text += &format!("\n{line}"));
        text
    }

    /// The same, which nothing changes.
    fn __copy__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __deepcopy__<'py>(slf: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        slf
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "a shaped excitation is not pickled: pickle what is needed of it, its reference, records, iterations",
        ))
    }

    fn __repr__(&self) -> String {
        let error = self
            .error()
            .map_or("unknown".into(), |error| format!("{:.1} %", 100.0 * error));
        let (best, of) = (self.number(), self.shaping.iterations.len());
        format!("<frfid.Shaped: iteration {best} of {of}, error {error}>")
    }
}

impl Shaped {
    /// The result with its records as Python sees them.
    pub(crate) fn of(py: Python<'_>, mut shaping: Shaping) -> PyResult<Self> {
        let records = std::mem::take(&mut shaping.best.records).into_iter();
        let records = records
            .map(|record| Py::new(py, Record::of(py, vec![record], false)?))
            .collect::<PyResult<_>>()?;
        Ok(Self { shaping, records })
    }
}
