//! Campaign of whole periods, what else it tells: `frfid.estimate_loop`, `frfid.coherence` and
//! `frfid.spectra_covariance`.

use std::collections::BTreeMap;

use frfid_estimate::{
    Campaign, Coherence, Entry, FrfOptions, Method, Response, SpectraCovariance,
    campaign_of_periods,
};
use num_complex::Complex64;
use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::choice::from_python;
use crate::error;
use crate::estimate::periods::Signals;
use crate::frf::matrix::Frf;
use crate::size::List;
use crate::threads::detached;

/// Spectra of periods in the arrays that the functions take.
fn campaign(
    py: Python<'_>,
    [u, y]: [&Bound<'_, PyAny>; 2],
    r: Option<&Bound<'_, PyAny>>,
    sample_time_s: f64,
    harmonics: &[usize],
) -> PyResult<Campaign> {
    let signals = Signals::of(u, y, r)?;
    let (u, y, r) = signals.arrays();
    let found = detached(py, || {
        campaign_of_periods(u, y, r, sample_time_s, harmonics)
    })?;
    found.map_err(error::estimate)
}

/// The closed loop from one campaign: every response with its covariances.
///
/// Parameters
/// ----------
/// u, y, r : array_like, shape (realization, experiment, period, channel, sample)
///     Plant input, plant output and reference, whole periods in the steady state; as many channels of r as of
///     u.
/// sample_time_s : float
///     Sample time in s.
/// harmonics : sequence of int
///     Lines of the DFT of the period to estimate, rising.
/// loop : {"set-point", "input"}, optional
///     Where the reference enters: as the set point of the output, ``u = C (r - y)``, or added to the input, ``u
///     = r - C y``.
///
/// Returns
/// -------
/// dict of Frf
///     ``u_to_y``, the plant; ``r_to_u``; ``r_to_y``; and, where ``loop`` is given, ``sensitivity``,
///     ``complementary_sensitivity`` and ``open_loop``.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit, samples that are not finite, a set point with other channels than the output.
/// NumericalError
///     If no line of the reference is excited.
#[pyfunction]
#[pyo3(signature = (u, y, r, *, sample_time_s, harmonics, r#loop = None))]
pub(crate) fn estimate_loop(
    py: Python<'_>,
    u: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    r: &Bound<'_, PyAny>,
    sample_time_s: f64,
    harmonics: List<usize>,
    r#loop: Option<&Bound<'_, PyAny>>,
) -> PyResult<BTreeMap<&'static str, Frf>> {
    let entry: Option<Entry> = r#loop.map(|entry| from_python("loop", entry)).transpose()?;
    let campaign = campaign(py, [u, y], Some(r), sample_time_s, &harmonics.0)?;
    let max_condition = FrfOptions::default().max_condition;
    let measured = detached(py, || campaign.closed_loop(max_condition))?;
    let measured = measured.map_err(error::estimate)?;
    let named = |&(name, what): &(&'static str, Response)| {
        let frf = measured.response(what, entry).map_err(error::signal)?;
        Ok((name, Frf::from(frf)))
    };
    let known = if entry.is_some() {
        &RESPONSES[..]
    } else {
        &RESPONSES[..3]
    };
    known.iter().map(named).collect()
}

/// Responses by their names in Python; those that take the place of the reference are last.
const RESPONSES: [(&str, Response); 6] = [
    ("u_to_y", Response::Plant),
    ("r_to_u", Response::RToU),
    ("r_to_y", Response::RToY),
    ("sensitivity", Response::Sensitivity),
    (
        "complementary_sensitivity",
        Response::ComplementarySensitivity,
    ),
    ("open_loop", Response::OpenLoop),
];

/// Coherence of every output with all inputs, and where the true one lies.
///
/// The share of an output's power that the inputs explain over all experiments, periods and realizations
/// (multiple coherence), with its 95 % interval.
///
/// Parameters
/// ----------
/// u, y : array_like, shape (realization, experiment, period, channel, sample)
///     Plant input and output, whole periods in the steady state.
/// sample_time_s : float
///     Sample time in s.
/// harmonics : sequence of int
///     Lines of the DFT of the period, rising.
///
/// Returns
/// -------
/// value, low, high : ndarray, float64, shape (frequency, output)
///     The coherence and the ends of the interval; 0 and 1 where nothing is known.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit, samples that are not finite, fewer experiments than inputs.
#[pyfunction]
#[pyo3(signature = (u, y, *, sample_time_s, harmonics))]
pub(crate) fn coherence<'py>(
    py: Python<'py>,
    u: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    sample_time_s: f64,
    harmonics: List<usize>,
) -> PyResult<[Bound<'py, PyArray2<f64>>; 3]> {
    let campaign = campaign(py, [u, y], None, sample_time_s, &harmonics.0)?;
    let Coherence {
        value, low, high, ..
    } = campaign.coherence().map_err(error::estimate)?;
    Ok([value, low, high].map(|array| c_ordered(py, array)))
}

/// A covariance line by line, if it was measured.
type Covariance<'py> = Option<Bound<'py, PyArray3<Complex64>>>;

/// Covariances of the spectra of input and output, as fits with noise on both need them.
///
/// Parameters
/// ----------
/// u, y : array_like, shape (realization, experiment, period, channel, sample)
///     Plant input and output, whole periods in the steady state.
/// sample_time_s : float
///     Sample time in s.
/// harmonics : sequence of int
///     Lines of the DFT of the period, rising.
/// r : array_like, shape as u, optional
///     Reference, through which the FRF of the equation error is estimated.
///
/// Returns
/// -------
/// dict
///     ``noise`` of [u; y] in one period, shape (frequency, channel, channel); ``equation_error`` of the mean of Y -
///     G U over the periods of a realization, ``equation_noise``, its part by noise, and ``nonlinear``, the signed
///     difference, shape (frequency, output, output); None where one period or one realization does not tell.
///     Squared units of the DFT.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit, samples that are not finite, fewer experiments than inputs.
/// NumericalError
///     If U can be inverted on no line.
#[pyfunction]
#[pyo3(signature = (u, y, *, sample_time_s, harmonics, r = None))]
pub(crate) fn spectra_covariance<'py>(
    py: Python<'py>,
    u: &Bound<'py, PyAny>,
    y: &Bound<'py, PyAny>,
    sample_time_s: f64,
    harmonics: List<usize>,
    r: Option<&Bound<'py, PyAny>>,
) -> PyResult<Covariances<'py>> {
    let campaign = campaign(py, [u, y], r, sample_time_s, &harmonics.0)?;
    let found = detached(py, || {
        let frf = campaign.estimate(&Method::Auto.into())?;
        campaign.spectra_covariance(&frf)
    })?;
    let found: SpectraCovariance = found.map_err(error::estimate)?;
    let array = |covariance: Option<_>| covariance.map(|covariance| c_ordered(py, covariance));
    Ok(Covariances {
        nonlinear: array(found.nonlinear()),
        noise: array(found.noise),
        equation_error: array(found.equation_error),
        equation_noise: array(found.equation_noise),
    })
}

/// Covariances, as a dict.
#[derive(IntoPyObject)]
pub(crate) struct Covariances<'py> {
    noise: Covariance<'py>,
    equation_error: Covariance<'py>,
    equation_noise: Covariance<'py>,
    nonlinear: Covariance<'py>,
}
