//! `frfid.Frf`: its numbers.

use frfid_files::ResultFile;
use frfid_signals::Frf as Response;
use ndarray::Array1;
use pyo3::prelude::*;

use crate::array::complex;
use crate::choice::from_python;
use crate::error;
use crate::frf::distortion::levels;
use crate::frf::harmonics::of_dict;
use crate::frf::load::described;
use crate::frf::parts::{Arrays, PARTS, degrees_of_freedom, per_frequency, replace, uncertainty};
use crate::pickle::{Reduced, attributes};
use crate::size::{List, copied};
use crate::sources::Sources;

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
/// noise_degrees_of_freedom, total_degrees_of_freedom : float, optional
///     Complex degrees of freedom behind them.
/// condition : array_like, shape (frequency,), optional
///     Condition number of U.
/// relative_resolution : float, optional
///     Half width, relative to the frequency, of the band over which a value blurs the response,
///     in the middle of a chirp's band.
/// torque_rms_nm : sequence of float, optional
///     Rms of the motor torque of each input in N m: which of two results had the stronger
///     excitation.
/// flagged : sequence of bool, optional
///     Whether what remains of the torque ripple exceeds the noise, frequency by frequency.
/// distortion : dict, optional
///     Levels of noise and nonlinear distortion, as the attribute.
/// harmonics : dict, optional
///     Harmonics of a chirp, as the attribute.
/// input_names, output_names, input_units, output_units : list of str, optional
///     Names and SI units of the channels.
/// verdicts : list of dict, optional
///     What each axis suffers from: ``axis``, ``cause``, ``found`` (a share, None if not measured), ``limit``.
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
pub(crate) struct Frf {
    pub result: ResultFile,
    pub sources: Sources,
    pub(super) arrays: Arrays,
}

#[pymethods]
impl Frf {
    // longer than 40 lines: a line for each keyword
    #[new]
    #[pyo3(signature = (*, frequency_hz, response, noise_covariance = None, noise_degrees_of_freedom = None,
                        total_covariance = None, total_degrees_of_freedom = None, condition = None,
                        relative_resolution = None, torque_rms_nm = None, flagged = None, distortion = None, harmonics = None, input_names = None, output_names = None, input_units = None,
                        output_units = None, verdicts = None, checks = None, provenance = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn new(
        frequency_hz: &Bound<'_, PyAny>,
        response: &Bound<'_, PyAny>,
        noise_covariance: Option<&Bound<'_, PyAny>>,
        noise_degrees_of_freedom: Option<f64>,
        total_covariance: Option<&Bound<'_, PyAny>>,
        total_degrees_of_freedom: Option<f64>,
        condition: Option<&Bound<'_, PyAny>>,
        relative_resolution: Option<f64>,
        torque_rms_nm: Option<List<f64>>,
        flagged: Option<List<bool>>,
        distortion: Option<&Bound<'_, PyAny>>,
        harmonics: Option<&Bound<'_, PyAny>>,
        input_names: Option<List<String>>,
        output_names: Option<List<String>>,
        input_units: Option<List<String>>,
        output_units: Option<List<String>>,
        verdicts: Option<&Bound<'_, PyAny>>,
        checks: Option<&Bound<'_, PyAny>>,
        provenance: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let frf = Response {
            frequency_hz: per_frequency("frequency_hz", frequency_hz)?,
            response: copied(
                &complex("response", response, &[&["frequency", "output", "input"]])?.as_array(),
            )?,
            noise: uncertainty("noise", noise_covariance, noise_degrees_of_freedom)?,
            total: uncertainty("total", total_covariance, total_degrees_of_freedom)?,
            condition: condition
                .map(|condition| per_frequency("condition", condition))
                .transpose()?,
            relative_resolution,
        };
        frf.check().map_err(error::signal)?;
        let mut result = Self::from(frf).result;
        for (name, list, given) in [
            ("input_names", &mut result.input_names, input_names),
            ("output_names", &mut result.output_names, output_names),
            ("input_units", &mut result.input_units, input_units),
            ("output_units", &mut result.output_units, output_units),
        ] {
            replace(name, list, given)?;
        }
        if torque_rms_nm.is_some() {
            let list = result
                .torque_rms_nm
                .insert(vec![0.0; result.input_names.len()]);
            replace("torque_rms_nm", list, torque_rms_nm)?;
        }
        if flagged.is_some() {
            let list = result
                .flagged
                .insert(vec![false; result.frf.n_frequencies()]);
            replace("flagged", list, flagged)?;
        }
        if let Some(distortion) = distortion {
            result.distortion = Some(levels(distortion, &result.frf)?);
        }
        if let Some(harmonics) = harmonics {
            result.harmonics = Some(of_dict(harmonics, &result.frf)?);
        }
        if let Some(verdicts) = verdicts {
            result.verdicts = from_python("verdicts", verdicts)?;
        }
        if let Some(checks) = checks {
            result.checks = from_python("checks", checks)?;
        }
        if let Some(provenance) = provenance {
            result.provenance = from_python("provenance", provenance)?;
        }
        Ok(Self::of(result))
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
    pub(crate) fn response<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
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

    /// Level of the stochastic nonlinear distortion of one realization, n_p (total - noise), shape
    /// (frequency, output, input); None unless both variances were measured. Its mean is 0 on a linear
    /// machine, so that it may be negative.
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
    fn noise_degrees_of_freedom(&self) -> Option<f64> {
        degrees_of_freedom(&self.result.frf.noise)
    }

    /// Complex degrees of freedom of the total variance; None if not measured.
    #[getter]
    fn total_degrees_of_freedom(&self) -> Option<f64> {
        degrees_of_freedom(&self.result.frf.total)
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

    /// Rms of the motor torque of each input in N m; None where it was not measured.
    #[getter]
    fn torque_rms_nm(&self) -> Option<Vec<f64>> {
        self.result.torque_rms_nm.clone()
    }

    /// Whether what remains of the torque ripple exceeds the noise, frequency by frequency; None
    /// where that cannot be told.
    #[getter]
    fn flagged(&self) -> Option<Vec<bool>> {
        self.result.flagged.clone()
    }

    /// Shape of the response, (frequency, output, input).
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        self.result.frf.response.dim()
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

    fn __repr__(&self) -> String {
        described(&self.result.frf)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        attributes(slf, &PARTS)
    }
}
