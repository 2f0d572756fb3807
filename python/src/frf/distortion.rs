//! Distortion levels of a `frfid.Frf` as dicts.

use frfid_signals::{Distortion, Frf as Response};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::choice::{from_python, to_python};
use crate::frf::matrix::Frf;

#[pymethods]
impl Frf {
    /// Levels of noise and of odd and even nonlinear distortion, from lines of a multisine that are not excited; None
    /// where there are none, or one that is excited is even.
    ///
    /// A dict of ``inputs`` and ``outputs``, one dict for each with ``odd`` and ``even``: lists of groups of lines with
    /// ``frequency_hz``, ``n_lines``, and rms of a line in one realization, in the unit of the signal: ``excited``,
    /// ``noise`` of one period (None with one period), ``level`` without the noise where that is known (None where it
    /// does not stand out) and the ends ``low`` and ``high`` of its 95 % interval.
    #[getter]
    fn distortion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.result.distortion)
    }
}

/// Levels of distortion of as many channels as the FRF has.
pub(crate) fn levels(given: &Bound<'_, PyAny>, frf: &Response) -> PyResult<Distortion> {
    let levels: Distortion = from_python("distortion", given)?;
    let (found, needed) = (
        (levels.inputs.len(), levels.outputs.len()),
        (frf.n_inputs(), frf.n_outputs()),
    );
    if found == needed {
        return Ok(levels);
    }
    Err(PyValueError::new_err(format!(
        "distortion is of {} inputs and {} outputs, needed {} and {}",
        found.0, found.1, needed.0, needed.1
    )))
}
