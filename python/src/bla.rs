//! `frfid.estimate_bla`.

use frfid_estimate::{Averaging, BlaOptions};
use ndarray::Ix5;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, real};
use crate::error;
use crate::frf::Frf;

const CAMPAIGN: Axes = &["realization", "experiment", "period", "channel", "sample"];
/// Best linear approximation with its variances, SK15 (13) and (14).
///
/// Without ``r`` the direct estimate; with it the indirect one (joint input-output), which noise on
/// ``u`` does not bias. The noise variance is None with one period, the total variance with one
/// realization.
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
/// average : {"frfs", "spectra"}, optional
///     What is averaged over periods without ``r``: FRFs as the paper does, or spectra, better
///     where ``u`` is noisy.
/// max_condition : float, optional
///     Largest condition number of U, rows scaled, at which a line is still inverted.
///
/// Returns
/// -------
/// Frf
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit, samples that are not finite, lines off the grid, fewer
///     experiments than inputs.
/// NumericalError
///     For lines on which U cannot be inverted.
#[pyfunction]
#[pyo3(signature = (u, y, *, sample_time_s, harmonics, r = None, average = "frfs", max_condition = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub fn estimate_bla(
    py: Python<'_>,
    u: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    sample_time_s: f64,
    harmonics: Vec<usize>,
    r: Option<&Bound<'_, PyAny>>,
    average: &str,
    max_condition: Option<f64>,
) -> PyResult<Frf> {
    let defaults = BlaOptions::default();
    let options = BlaOptions {
        averaging: averaging(average)?,
        max_condition: max_condition.unwrap_or(defaults.max_condition),
    };
    let (u, y) = (
        real::<Ix5>("u", u, &[CAMPAIGN])?,
        real::<Ix5>("y", y, &[CAMPAIGN])?,
    );
    let r = r.map(|r| real::<Ix5>("r", r, &[CAMPAIGN])).transpose()?;
    let (u, y, r) = (u.as_array(), y.as_array(), r.as_ref().map(|r| r.as_array()));
    let estimate = || frfid_estimate::estimate_bla(u, y, r, sample_time_s, &harmonics, &options);
    Ok(py.detach(estimate).map_err(error::estimate)?.into())
}

fn averaging(name: &str) -> PyResult<Averaging> {
    match name {
        "frfs" => Ok(Averaging::Frfs),
        "spectra" => Ok(Averaging::Spectra),
        _ => Err(PyValueError::new_err(format!(
            "average: unknown variant `{name}`, expected one of `frfs`, `spectra`"
        ))),
    }
}
