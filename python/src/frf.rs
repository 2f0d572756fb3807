//! `frfid.Frf` and `frfid.load`.

use std::path::PathBuf;

use frfid_files::{Overwrite, ResultFile, read_result, write_result};
use frfid_signals::{Frf as Response, Uncertainty};
use ndarray::{Array1, Ix1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

use crate::array::{Axes, Shared, complex, real};
use crate::choice::{from_python, to_python};
use crate::error;

const ENTRIES: Axes = &["frequency", "output * input", "output * input"];

/// A frequency response matrix with what is known about its uncertainty.
///
/// It is its response where numpy asks for an array. All arrays are read-only. A variance that was not measured is None.
/// Variances are those of the averaged response, E|dG|^2, real and imaginary part together.
///
/// Parameters
/// ----------
/// frequency_hz : array_like, shape (frequency,)
///     Frequencies in Hz.
/// response : array_like, shape (frequency, output, input)
///     Response; rad/s per N m for motor torque to motor velocity.
/// noise_covariance, total_covariance : array_like, shape (frequency, n_outputs * n_inputs, same), optional
///     Covariance of vec(G), its columns stacked, from noise alone, and from noise and nonlinear distortion.
/// noise_degrees_of_freedom, total_degrees_of_freedom : int, optional
///     Complex degrees of freedom behind them.
/// condition : array_like, shape (frequency,), optional
///     Condition number of U.
/// input_names, output_names, input_units, output_units : list of str, optional
///     Names and SI units of the channels.
/// checks : list of dict, optional
///     What was checked: ``name``, ``passed``, ``found``, ``needed`` and ``advice``.
/// provenance : dict of str, optional
///     Where it comes from: versions, seeds, hashes, amplitudes, limits.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit together, or a covariance without its degrees of freedom.
#[pyclass(frozen, module = "frfid")]
pub struct Frf {
    pub result: ResultFile,
    arrays: Arrays,
}

#[derive(Default)]
struct Arrays {
    frequency_hz: Shared,
    response: Shared,
    noise_variance: Shared,
    total_variance: Shared,
    nonlinear_variance: Shared,
    noise_covariance: Shared,
    total_covariance: Shared,
    condition: Shared,
}

#[pymethods]
impl Frf {
    #[new]
    #[pyo3(signature = (*, frequency_hz, response, noise_covariance = None, noise_degrees_of_freedom = None,
                        total_covariance = None, total_degrees_of_freedom = None, condition = None,
                        input_names = None, output_names = None, input_units = None, output_units = None,
                        checks = None, provenance = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn new(
        frequency_hz: &Bound<'_, PyAny>,
        response: &Bound<'_, PyAny>,
        noise_covariance: Option<&Bound<'_, PyAny>>,
        noise_degrees_of_freedom: Option<usize>,
        total_covariance: Option<&Bound<'_, PyAny>>,
        total_degrees_of_freedom: Option<usize>,
        condition: Option<&Bound<'_, PyAny>>,
        input_names: Option<Vec<String>>,
        output_names: Option<Vec<String>>,
        input_units: Option<Vec<String>>,
        output_units: Option<Vec<String>>,
        checks: Option<&Bound<'_, PyAny>>,
        provenance: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let frf = Response {
            frequency_hz: per_frequency("frequency_hz", frequency_hz)?,
            response: complex("response", response, &[&["frequency", "output", "input"]])?.as_array().to_owned(),
            noise: uncertainty("noise", noise_covariance, noise_degrees_of_freedom)?,
            total: uncertainty("total", total_covariance, total_degrees_of_freedom)?,
            condition: condition.map(|condition| per_frequency("condition", condition)).transpose()?,
        };
        frf.check().map_err(error::signal)?;
        let unnamed = Self::from(frf).result;
        let (n_inputs, n_outputs) = (unnamed.input_names.len(), unnamed.output_names.len());
        Ok(Self::of(ResultFile {
            input_names: channels("input_names", input_names, unnamed.input_names, n_inputs)?,
            output_names: channels("output_names", output_names, unnamed.output_names, n_outputs)?,
            input_units: channels("input_units", input_units, unnamed.input_units, n_inputs)?,
            output_units: channels("output_units", output_units, unnamed.output_units, n_outputs)?,
            checks: checks.map_or_else(|| Ok(Vec::new()), |checks| from_python("checks", checks))?,
            provenance: provenance.map_or_else(|| Ok(unnamed.provenance), |p| from_python("provenance", p))?,
            frf: unnamed.frf,
        }))
    }

    /// Frequencies in Hz, shape (frequency,).
    #[getter]
    fn frequency_hz<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.arrays.frequency_hz.get(py, || Array1::from(self.result.frf.frequency_hz.clone()))
    }

    /// Response, complex128, shape (frequency, output, input).
    #[getter]
    fn response<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.arrays.response.get(py, || self.result.frf.response.clone())
    }

    /// Noise variance of each entry of the averaged response, shape (frequency, output, input); None if not measured.
    #[getter]
    fn noise_variance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.result.frf.noise_variance().map(|variance| self.arrays.noise_variance.get(py, || variance))
    }

    /// Variance of each entry from noise and nonlinear distortion, shape (frequency, output, input); None if not measured.
    #[getter]
    fn total_variance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.result.frf.total_variance().map(|variance| self.arrays.total_variance.get(py, || variance))
    }

    /// Level of the stochastic nonlinear distortion of one realization, shape (frequency, output, input); None unless both
    /// variances were measured.
    #[getter]
    fn nonlinear_variance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.result.frf.nonlinear_variance().map(|variance| self.arrays.nonlinear_variance.get(py, || variance))
    }

    /// Covariance of vec(G), its columns stacked (index ``input * n_outputs + output``): the total one if it was measured,
    /// else that of the noise, else None. Shape (frequency, n_outputs * n_inputs, n_outputs * n_inputs).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.total_covariance(py).or_else(|| self.noise_covariance(py))
    }

    /// Covariance of vec(G) from noise alone; None if not measured.
    #[getter]
    fn noise_covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        let known = self.result.frf.noise.as_ref()?;
        Some(self.arrays.noise_covariance.get(py, || known.covariance.clone()))
    }

    /// Covariance of vec(G) from noise and nonlinear distortion; None if not measured.
    #[getter]
    fn total_covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        let known = self.result.frf.total.as_ref()?;
        Some(self.arrays.total_covariance.get(py, || known.covariance.clone()))
    }

    /// Complex degrees of freedom of the noise variance; None if not measured.
    #[getter]
    fn noise_degrees_of_freedom(&self) -> Option<usize> {
        self.result.frf.noise.as_ref().map(|known| known.degrees_of_freedom)
    }

    /// Complex degrees of freedom of the total variance; None if not measured.
    #[getter]
    fn total_degrees_of_freedom(&self) -> Option<usize> {
        self.result.frf.total.as_ref().map(|known| known.degrees_of_freedom)
    }

    /// Condition number of U at each frequency, shape (frequency,); None where no U was inverted.
    #[getter]
    fn condition<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        let condition = self.result.frf.condition.as_ref()?;
        Some(self.arrays.condition.get(py, || Array1::from(condition.clone())))
    }

    /// Shape of the response, (frequency, output, input).
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        self.result.frf.response.dim()
    }

    /// Part of the response: ``frf[key]`` is ``frf.response[key]``.
    fn __getitem__<'py>(&self, key: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.response(key.py()).get_item(key)
    }

    /// The response, where numpy asks for an array.
    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let keywords = [("copy", copy)].into_py_dict(py)?;
        py.import("numpy")?.call_method("array", (self.response(py), dtype), Some(&keywords))
    }

    /// Number of outputs.
    #[getter]
    fn n_outputs(&self) -> usize {
        self.result.frf.n_outputs()
    }

    /// Number of inputs.
    #[getter]
    fn n_inputs(&self) -> usize {
        self.result.frf.n_inputs()
    }

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

    /// What was checked: a list of dicts with ``name``, ``passed``, ``found``, ``needed`` and ``advice``.
    #[getter]
    fn checks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.result.checks)
    }

    /// Where it comes from, a dict of strings: versions, seeds, hashes, amplitudes, limits.
    #[getter]
    fn provenance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.result.provenance)
    }

    /// Writes the result as JSON, first beside ``path`` and renamed when it is complete.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The file.
    /// overwrite : bool, optional
    ///     Whether a file of this name may be replaced.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If the file exists and may not be replaced.
    /// OSError
    ///     If it cannot be written.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn save(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        let overwrite = if overwrite { Overwrite::Replace } else { Overwrite::Refuse };
        py.detach(|| write_result(&path, overwrite, &self.result)).map_err(error::file)
    }

    /// The FRF as ``control.FRD``: rad/s, response (output, input, frequency). It has no room for the uncertainty.
    fn to_control<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "to_control")
    }

    /// The FRF as ``xarray.Dataset`` with dimensions frequency, output and input; variances only where measured.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "to_xarray")
    }

    /// Plots: ``frf.plot.bode()``, with matplotlib.
    #[getter]
    fn plot<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "Plot")
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "repr_html")
    }

    fn __repr__(&self) -> String {
        let hz = &self.result.frf.frequency_hz;
        let (low, high) = (hz.first().copied().unwrap_or(f64::NAN), hz.last().copied().unwrap_or(f64::NAN));
        let measured = |known: &Option<Uncertainty>| if known.is_some() { "measured" } else { "None" };
        format!(
            "<frfid.Frf: {} outputs x {} inputs at {} frequencies from {low:.4} Hz to {high:.4} Hz, noise variance {}, \
             total variance {}>",
            self.n_outputs(),
            self.n_inputs(),
            hz.len(),
            measured(&self.result.frf.noise),
            measured(&self.result.frf.total)
        )
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let keywords = PyDict::new(py);
        keywords.set_item("frequency_hz", self.frequency_hz(py))?;
        keywords.set_item("response", self.response(py))?;
        keywords.set_item("noise_covariance", self.noise_covariance(py))?;
        keywords.set_item("noise_degrees_of_freedom", self.noise_degrees_of_freedom())?;
        keywords.set_item("total_covariance", self.total_covariance(py))?;
        keywords.set_item("total_degrees_of_freedom", self.total_degrees_of_freedom())?;
        keywords.set_item("condition", self.condition(py))?;
        keywords.set_item("input_names", &self.result.input_names)?;
        keywords.set_item("output_names", &self.result.output_names)?;
        keywords.set_item("input_units", &self.result.input_units)?;
        keywords.set_item("output_units", &self.result.output_units)?;
        keywords.set_item("checks", self.checks(py)?)?;
        keywords.set_item("provenance", self.provenance(py)?)?;
        Ok((PyTuple::empty(py), keywords))
    }
}

impl Frf {
    /// A result with everything that belongs to it.
    pub fn of(result: ResultFile) -> Self {
        Self { result, arrays: Arrays::default() }
    }
}

/// An FRF of which only the numbers are known: channels are numbered, their units empty.
impl From<Response> for Frf {
    fn from(frf: Response) -> Self {
        let (n_inputs, n_outputs) = (frf.n_inputs(), frf.n_outputs());
        let numbered = |word: &str, count: usize| (1..=count).map(|channel| format!("{word} {channel}")).collect();
        Self::of(ResultFile {
            frf,
            input_names: numbered("input", n_inputs),
            output_names: numbered("output", n_outputs),
            input_units: vec![String::new(); n_inputs],
            output_units: vec![String::new(); n_outputs],
            checks: Vec::new(),
            provenance: [("frfid_version".to_owned(), env!("CARGO_PKG_VERSION").to_owned())].into(),
        })
    }
}

/// Reads a result: what ``Frf.save`` or ``frfid estimate`` wrote.
///
/// Parameters
/// ----------
/// path : str or path-like
///     The JSON file.
///
/// Returns
/// -------
/// Frf
///
/// Raises
/// ------
/// OSError
///     If the file cannot be read.
/// ValueError
///     If it is no result, or contradicts itself.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<Frf> {
    path.metadata()?;
    Ok(Frf::of(py.detach(|| read_result(&path)).map_err(error::file)?))
}

/// What needs another Python package is written in Python.
fn in_python<'py>(frf: &Bound<'py, Frf>, function: &str) -> PyResult<Bound<'py, PyAny>> {
    frf.py().import("frfid._frf")?.call_method1(function, (frf,))
}

fn uncertainty(
    name: &str,
    covariance: Option<&Bound<'_, PyAny>>,
    degrees: Option<usize>,
) -> PyResult<Option<Uncertainty>> {
    match (covariance, degrees) {
        (None, None) => Ok(None),
        (Some(covariance), Some(degrees_of_freedom)) => {
            let covariance = complex(&format!("{name}_covariance"), covariance, &[ENTRIES])?.as_array().to_owned();
            Ok(Some(Uncertainty { covariance, degrees_of_freedom }))
        }
        _ => Err(PyValueError::new_err(format!(
            "{name}_covariance and {name}_degrees_of_freedom belong together: only one of them was given"
        ))),
    }
}

fn channels(name: &str, given: Option<Vec<String>>, default: Vec<String>, needed: usize) -> PyResult<Vec<String>> {
    match given {
        None => Ok(default),
        Some(list) if list.len() == needed => Ok(list),
        Some(list) => Err(PyValueError::new_err(format!("{name} has {} entries, needed {needed}", list.len()))),
    }
}

fn per_frequency(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    Ok(real::<Ix1>(name, value, &[&["frequency"]])?.as_array().to_vec())
}
