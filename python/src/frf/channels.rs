//! Names and units of an FRF's channels, its checks and where it comes from.

use pyo3::prelude::*;

use crate::choice::to_python;
use crate::frf::matrix::Frf;

#[pymethods]
impl Frf {
    /// Names of the inputs.
    #[getter]
    fn input_names(&self) -> Vec<String> {
        self.result.input_names.clone()
    }

    /// Names of the outputs.
    #[getter]
    fn output_names(&self) -> Vec<String> {
        self.result.output_names.clone()
    }

    /// SI units of the inputs; empty where they are not known.
    #[getter]
    fn input_units(&self) -> Vec<String> {
        self.result.input_units.clone()
    }

    /// SI units of the outputs; empty where they are not known.
    #[getter]
    fn output_units(&self) -> Vec<String> {
        self.result.output_units.clone()
    }

    /// What each axis suffers from: a list of dicts with ``axis``, ``cause`` ("noise", "distortion",
    /// "sticking", "ripple", "transient", "condition", "clipping"), the share ``found`` (None where it was
    /// not measured) and the largest good one, ``limit``. Empty where nobody judged.
    #[getter]
    fn verdicts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.result.verdicts)
    }

    /// What was checked: a list of dicts with ``name``, ``passed``, ``found``, ``needed`` and
    /// ``advice``.
    #[getter]
    fn checks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.result.checks)
    }

    /// Where it comes from, a dict of strings: versions, seeds, hashes, amplitudes, limits.
    #[getter]
    fn provenance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.result.provenance)
    }
}
