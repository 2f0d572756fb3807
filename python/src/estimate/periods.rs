//! `frfid.estimate` and `frfid.estimate_bla`.

use frfid_estimate::{FrfEstimate, FrfOptions, Method, estimate_with_distortion};
use frfid_experiment::{Evidence, judge};
use frfid_files::{Cause, Check};
use ndarray::{ArrayView5, Ix5};
use numpy::PyReadonlyArray5;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, real};
use crate::choice::from_python;
use crate::error;
use crate::frf::matrix::Frf;
use crate::size::List;
use crate::threads::detached;

const CAMPAIGN: Axes = &["realization", "experiment", "period", "channel", "sample"];
/// Best linear approximation with its variances, SK15 (13) and (14).
///
/// Without ``r`` the direct estimate; with it the indirect one (joint input-output), which noise on
/// ``u`` does not bias. The noise variance is None with one period, the total variance with one
/// realization.
///
/// Realizations are measured, not believed: those whose phases are one draw, but for a shift in
/// time, count as repetitions of it, and with one draw alone the total variance is None; a failed
/// check names them. A realization that is another bit for bit, as in a simulation without
/// noise or where a recording is given twice, counts once. Lines on which an input is not excited,
/// seen against its noise and against what stands beside it, are NaN; a failed check names them.
///
/// Parameters
/// ----------
/// u, y : array_like, shape (realization, experiment, period, channel, sample)
///     Plant input and output, whole periods in the steady state; at least as many experiments as
///     inputs.
/// sample_time_s : float
///     Sample time in s.
/// harmonics : sequence of int
///     Lines of the DFT of the period to estimate, rising: ``multisine.harmonics``.
/// r : array_like, shape as u, optional
///     Reference.
/// average : {"spectra", "frfs"}, optional
///     What is averaged over periods without ``r``: the spectra, or FRFs as the paper does; where noise
///     on ``u`` biases them, a failed check says so.
/// max_condition : float, optional
///     Largest condition number of U, rows scaled, at which a line is still inverted; others are
///     NaN.
///
/// Returns
/// -------
/// Frf
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit, samples that are not finite, masked arrays, lines off the grid,
///     fewer experiments than inputs.
/// NumericalError
///     If U can be inverted on no line.
#[pyfunction]
#[pyo3(signature = (u, y, *, sample_time_s, harmonics, r = None, average = "spectra", max_condition = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub(crate) fn estimate_bla(
    py: Python<'_>,
    u: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    sample_time_s: f64,
    harmonics: List<usize>,
    r: Option<&Bound<'_, PyAny>>,
    average: &str,
    max_condition: Option<f64>,
) -> PyResult<Frf> {
    let method = match r {
        Some(_) => Method::JointInputOutput,
        None => averaging(average)?,
    };
    estimated(
        py,
        u,
        y,
        sample_time_s,
        &harmonics.0,
        r,
        method,
        max_condition,
    )
}

/// FRF with its variances from whole periods, by the method that is asked for.
///
/// Realizations that are one draw of phases count as repetitions, and lines on which an input is
/// not excited are NaN, both named by failed checks, as in ``estimate_bla``.
///
/// Parameters
/// ----------
/// u, y : array_like, shape (realization, experiment, period, channel, sample)
///     Plant input and output, whole periods in the steady state; at least as many experiments as
///     inputs.
/// sample_time_s : float
///     Sample time in s.
/// harmonics : sequence of int
///     Lines of the DFT of the period to estimate, rising: ``multisine.harmonics``.
/// method : str, optional
///     ``"auto"``, the default: ``"joint-input-output"`` where ``r`` is given, through which noise on
///     ``u`` does not bias, else ``"mean-of-spectra"``. By name also ``"mean-of-frfs"``, the paper's;
///     ``"logarithmic-mean"``, of magnitudes and phases, with less bias by noise on ``u``;
///     ``"least-squares"``, one division by all realizations, where a single one may be conditioned
///     badly; ``"h1"`` and ``"h2"``, through ``u`` and through ``y``. Where noise on what is divided by
///     biases the FRF, a failed check says so.
/// r : array_like, shape as u, optional
///     Reference, for methods that estimate through it.
/// max_condition : float, optional
///     Largest condition number of U, rows scaled, at which a line is still inverted; others are
///     NaN.
///
/// Returns
/// -------
/// Frf
///
/// Raises
/// ------
/// ValueError
///     For a reference that is missing or not used, and as ``estimate_bla``.
/// NumericalError
///     If U can be inverted on no line.
#[pyfunction]
#[pyo3(signature = (u, y, *, sample_time_s, harmonics, method = None, r = None, max_condition = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub(crate) fn estimate(
    py: Python<'_>,
    u: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    sample_time_s: f64,
    harmonics: List<usize>,
    method: Option<&Bound<'_, PyAny>>,
    r: Option<&Bound<'_, PyAny>>,
    max_condition: Option<f64>,
) -> PyResult<Frf> {
    let method = method.map_or_else(|| Ok(Method::Auto), |method| from_python("method", method))?;
    estimated(
        py,
        u,
        y,
        sample_time_s,
        &harmonics.0,
        r,
        method,
        max_condition,
    )
}

#[expect(clippy::too_many_arguments, reason = "those of its two callers")]
fn estimated(
    py: Python<'_>,
    u: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    sample_time_s: f64,
    harmonics: &[usize],
    r: Option<&Bound<'_, PyAny>>,
    method: Method,
    max_condition: Option<f64>,
) -> PyResult<Frf> {
    let options = frf_options(method, max_condition);
    let signals = Signals::of(u, y, r)?;
    let (u, y, r) = signals.arrays();
    let estimate = || estimate_with_distortion(u, y, r, sample_time_s, harmonics, &options);
    let (estimate, distortion) = detached(py, estimate)?.map_err(error::estimate)?;
    let mut result = checked(estimate).result;
    result.distortion = distortion;
    Ok(Frf::of(result))
}

/// Whole periods of input, output and reference.
pub(crate) struct Signals<'py> {
    u: PyReadonlyArray5<'py, f64>,
    y: PyReadonlyArray5<'py, f64>,
    r: Option<PyReadonlyArray5<'py, f64>>,
}

/// The arrays of [`Signals`].
type Arrays<'a> = (
    ArrayView5<'a, f64>,
    ArrayView5<'a, f64>,
    Option<ArrayView5<'a, f64>>,
);

impl<'py> Signals<'py> {
    pub(crate) fn of(
        u: &Bound<'py, PyAny>,
        y: &Bound<'py, PyAny>,
        r: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        Ok(Self {
            u: real::<Ix5>("u", u, &[CAMPAIGN])?,
            y: real::<Ix5>("y", y, &[CAMPAIGN])?,
            r: r.map(|r| real::<Ix5>("r", r, &[CAMPAIGN])).transpose()?,
        })
    }

    pub(crate) fn arrays(&self) -> Arrays<'_> {
        let r = self.r.as_ref().map(|r| r.as_array());
        (self.u.as_array(), self.y.as_array(), r)
    }
}

/// The FRF; what was left out, counted otherwise than given or hides in one draw fails its check.
pub(crate) fn checked(estimate: FrfEstimate) -> Frf {
    let findings = estimate.findings().into_iter();
    let checks = findings.map(|(name, said)| Check {
        name: name.into(),
        passed: said.is_empty(),
        found: said.join("; "),
        needed: "nothing to say".into(),
        advice: String::new(),
    });
    let mut result = Frf::from(estimate.frf).result;
    result.checks = checks.collect();
    let axes = result.output_names.clone();
    let causes = [Cause::Noise, Cause::Distortion];
    judge(&mut result, &axes, &Evidence::default(), &causes);
    Frf::of(result)
}

/// Options of a method, with another largest condition number where one is given.
pub(crate) fn frf_options(method: Method, max_condition: Option<f64>) -> FrfOptions {
    let defaults = FrfOptions::from(method);
    FrfOptions {
        max_condition: max_condition.unwrap_or(defaults.max_condition),
        ..defaults
    }
}

fn averaging(name: &str) -> PyResult<Method> {
    match name {
        "frfs" => Ok(Method::MeanOfFrfs),
        "spectra" => Ok(Method::MeanOfSpectra),
        _ => Err(PyValueError::new_err(format!(
            "average: unknown variant `{name}`, expected one of `frfs`, `spectra`"
        ))),
    }
}
