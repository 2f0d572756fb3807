//! `frfid.Frf`.

use std::path::PathBuf;

use frfid_files::{Overwrite, ResultFile, write_result};
use frfid_report::result_figure;
use frfid_signals::Frf as Response;
use ndarray::Array1;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;

use crate::array::complex;
use crate::choice::{from_python, to_python};
use crate::error;
use crate::frf_parts::{Arrays, PARTS, channels, per_frequency, uncertainty};
use crate::pickle::{NewArguments, attributes};
use crate::result::described;

/// A frequency response matrix with what is known about its uncertainty.
///
/// It is its response where numpy asks for an array. All arrays are read-only. A variance that was
/// not measured is None. Variances are those of the averaged response, E|dG|^2, real and imaginary
/// part together.
///
/// Parameters
/// ----------
/// frequency_hz : array_like, shape (frequency,)
///     Frequencies in Hz.
/// response : array_like, shape (frequency, output, input)
///     Response; rad/s per N m for motor torque to motor velocity.
/// noise_covariance, total_covariance : array_like, shape (frequency, n_outputs * n_inputs, same), optional
///     Covariance of vec(G), its columns stacked, from noise alone, and from noise and nonlinear
///     distortion.
/// noise_degrees_of_freedom, total_degrees_of_freedom : int, optional
///     Complex degrees of freedom behind them.
/// condition : array_like, shape (frequency,), optional
///     Condition number of U.
/// relative_resolution : float, optional
///     Half width, relative to the frequency, of the band over which each value blurs the response.
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

impl Frf {
    /// A result with everything that belongs to it.
    pub fn of(result: ResultFile) -> Self {
        Self {
            result,
            arrays: Arrays::default(),
        }
    }
}

#[pymethods]
impl Frf {
    #[new]
    #[pyo3(signature = (*, frequency_hz, response, noise_covariance = None, noise_degrees_of_freedom = None,
                        total_covariance = None, total_degrees_of_freedom = None, condition = None,
                        relative_resolution = None, input_names = None, output_names = None, input_units = None,
                        output_units = None, checks = None, provenance = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn new(
        frequency_hz: &Bound<'_, PyAny>,
        response: &Bound<'_, PyAny>,
        noise_covariance: Option<&Bound<'_, PyAny>>,
        noise_degrees_of_freedom: Option<usize>,
        total_covariance: Option<&Bound<'_, PyAny>>,
        total_degrees_of_freedom: Option<usize>,
        condition: Option<&Bound<'_, PyAny>>,
        relative_resolution: Option<f64>,
        input_names: Option<Vec<String>>,
        output_names: Option<Vec<String>>,
        input_units: Option<Vec<String>>,
        output_units: Option<Vec<String>>,
        checks: Option<&Bound<'_, PyAny>>,
        provenance: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let frf = Response {
            frequency_hz: per_frequency("frequency_hz", frequency_hz)?,
            response: complex("response", response, &[&["frequency", "output", "input"]])?
                .as_array()
                .to_owned(),
            noise: uncertainty("noise", noise_covariance, noise_degrees_of_freedom)?,
            total: uncertainty("total", total_covariance, total_degrees_of_freedom)?,
            condition: condition
                .map(|condition| per_frequency("condition", condition))
                .transpose()?,
            relative_resolution,
        };
        frf.check().map_err(error::signal)?;
        let unnamed = Self::from(frf).result;
        let (n_inputs, n_outputs) = (unnamed.input_names.len(), unnamed.output_names.len());
        Ok(Self::of(ResultFile {
            input_names: channels("input_names", input_names, unnamed.input_names, n_inputs)?,
            output_names: channels(
                "output_names",
                output_names,
                unnamed.output_names,
                n_outputs,
            )?,
            input_units: channels("input_units", input_units, unnamed.input_units, n_inputs)?,
            output_units: channels(
                "output_units",
                output_units,
                unnamed.output_units,
                n_outputs,
            )?,
            checks: checks
                .map_or_else(|| Ok(Vec::new()), |checks| from_python("checks", checks))?,
            provenance: provenance
                .map_or_else(|| Ok(unnamed.provenance), |p| from_python("provenance", p))?,
            torque_rms_nm: None,
            flagged: None,
            frf: unnamed.frf,
        }))
    }

    /// Frequencies in Hz, shape (frequency,).
    #[getter]
    fn frequency_hz<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays.frequency_hz.get(py, || {
            Some(Array1::from(self.result.frf.frequency_hz.clone()))
        })
    }

    /// Response, complex128, shape (frequency, output, input).
    #[getter]
    fn response<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays
            .response
            .get(py, || Some(self.result.frf.response.clone()))
    }

    /// Noise variance of each entry of the averaged response, shape (frequency, output, input);
    /// None if not measured.
    #[getter]
    fn noise_variance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays
            .noise_variance
            .get(py, || self.result.frf.noise_variance())
    }

    /// Variance of each entry from noise and nonlinear distortion, shape (frequency, output,
    /// input); None if not measured.
    #[getter]
    fn total_variance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays
            .total_variance
            .get(py, || self.result.frf.total_variance())
    }

    /// Level of the stochastic nonlinear distortion of one realization, shape (frequency, output,
    /// input); None unless both variances were measured.
    #[getter]
    fn nonlinear_variance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays
            .nonlinear_variance
            .get(py, || self.result.frf.nonlinear_variance())
    }

    /// Covariance of vec(G), its columns stacked (index ``input * n_outputs + output``): the total
    /// one if it was measured, else that of the noise, else None. Shape (frequency, n_outputs *
    /// n_inputs, n_outputs * n_inputs).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.total_covariance(py)
            .or_else(|| self.noise_covariance(py))
    }

    /// Covariance of vec(G) from noise alone; None if not measured.
    #[getter]
    fn noise_covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays.noise_covariance.get(py, || {
            Some(self.result.frf.noise.as_ref()?.covariance.clone())
        })
    }

    /// Covariance of vec(G) from noise and nonlinear distortion; None if not measured.
    #[getter]
    fn total_covariance<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays.total_covariance.get(py, || {
            Some(self.result.frf.total.as_ref()?.covariance.clone())
        })
    }

    /// Complex degrees of freedom of the noise variance; None if not measured.
    #[getter]
    fn noise_degrees_of_freedom(&self) -> Option<usize> {
        self.result
            .frf
            .noise
            .as_ref()
            .map(|known| known.degrees_of_freedom)
    }

    /// Complex degrees of freedom of the total variance; None if not measured.
    #[getter]
    fn total_degrees_of_freedom(&self) -> Option<usize> {
        self.result
            .frf
            .total
            .as_ref()
            .map(|known| known.degrees_of_freedom)
    }

    /// Condition number of U at each frequency, shape (frequency,); None where no U was inverted.
    #[getter]
    fn condition<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.arrays.condition.get(py, || {
            Some(Array1::from(self.result.frf.condition.clone()?))
        })
    }

    /// Half width, relative to the frequency, of the band over which each value blurs the response:
    /// 1/8 for excerpts of four periods of a chirp; ``None`` for lines of a period.
    #[getter]
    fn relative_resolution(&self) -> Option<f64> {
        self.result.frf.relative_resolution
    }

    /// Shape of the response, (frequency, output, input).
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        self.result.frf.response.dim()
    }

    /// Part of the response: ``frf[key]`` is ``frf.response[key]``.
    fn __getitem__<'py>(
        slf: &Bound<'py, Self>,
        key: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.as_any().getattr("response")?.get_item(key)
    }

    /// The response, where numpy asks for an array.
    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (numpy, response) = (py.import("numpy")?, self.response(py));
        match copy {
            None => numpy.call_method1("asarray", (response, dtype)), // numpy 1 knows no copy=None
            Some(copy) => numpy.call_method(
                "array",
                (response, dtype),
                Some(&[("copy", copy)].into_py_dict(py)?),
            ),
        }
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
        let overwrite = if overwrite {
            Overwrite::Replace
        } else {
            Overwrite::Refuse
        };
        py.detach(|| write_result(&path, overwrite, &self.result))
            .map_err(error::file)
    }

    /// The FRF as ``control.FRD``: rad/s, response (output, input, frequency). It has no room for
    /// the uncertainty.
    fn to_control<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "to_control")
    }

    /// The FRF as ``xarray.Dataset`` with dimensions frequency, output and input; variances only
    /// where measured.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "to_xarray")
    }

    /// The Bode diagram as an SVG document, with the 95 % region of the largest variance that was
    /// measured.
    ///
    /// Returns
    /// -------
    /// str
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a frequency that is not above 0.
    fn to_svg(&self, py: Python<'_>) -> PyResult<String> {
        let figure = py.detach(|| result_figure("G", &self.result));
        Ok(figure.map_err(error::report)?.svg())
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
        described(&self.result.frf)
    }

    fn __getnewargs_ex__<'py>(slf: &Bound<'py, Self>) -> PyResult<NewArguments<'py>> {
        attributes(slf, &PARTS)
    }
}

/// What needs another Python package is written in Python.
fn in_python<'py>(frf: &Bound<'py, Frf>, function: &str) -> PyResult<Bound<'py, PyAny>> {
    frf.py()
        .import("frfid._frf")?
        .call_method1(function, (frf,))
}
