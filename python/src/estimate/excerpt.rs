//! `frfid.estimate_chirp`.

use frfid_estimate::{Method, estimate_repeats};
use ndarray::{ArrayView, Axis, Ix4, IxDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, real};
use crate::error;
use crate::estimate::local::local_method;
use crate::estimate::periods::{checked, frf_options};
use crate::frf::matrix::Frf;
use crate::signals::chirp::Chirp;
use crate::size::List;
use crate::threads::detached;

const RECORDINGS: [Axes; 2] = [
    &["experiment", "channel", "sample"],
    &["repeat", "experiment", "channel", "sample"],
];

/// FRF from chirps by excerpts, SK15 section 5.1: at each frequency the piece of the recording in
/// which the chirp passes it.
///
/// Parameters
/// ----------
/// u, y : array_like, shape (experiment, channel, sample) or (repeat, experiment, channel, sample)
///     Plant input and output of the whole chirp; at least as many experiments as inputs.
/// chirp : Chirp
///     The chirp that was injected.
/// sample_time_s : float
///     Sample time in s.
/// frequencies_hz : sequence of float
///     Where to estimate, rising, in Hz.
/// method : {"excerpt", "local-rational", "local-polynomial"}, optional
///     Excerpts of four periods, which leave the harmonics of friction out; or local models of the whole records,
///     which resonances do not bias, as `frfid.estimate_local`.
/// r : array_like, shape as u, optional
///     Reference; with it the estimate is the indirect one.
/// start_s : float, optional
///     Start of the chirp after the first sample in s.
/// max_condition : float, optional
///     Largest condition number of U, rows scaled, at which a frequency is still inverted;
///     others are NaN.
///
/// Returns
/// -------
/// Frf
///     Repeats give the noise variance, the bias of the excerpts included, NaN where the sweep is
///     too short to tell it; with one recording it is None.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit, samples that are not finite, and frequencies that the chirp does
///     not pass.
/// NumericalError
///     If U can be inverted at no frequency.
#[pyfunction]
#[pyo3(signature = (u, y, *, chirp, sample_time_s, frequencies_hz, method = "excerpt", r = None, start_s = 0.0,
                    max_condition = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub(crate) fn estimate_chirp(
    py: Python<'_>,
    u: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    chirp: &Chirp,
    sample_time_s: f64,
    frequencies_hz: List<f64>,
    method: &str,
    r: Option<&Bound<'_, PyAny>>,
    start_s: f64,
    max_condition: Option<f64>,
) -> PyResult<Frf> {
    let method = match method {
        "excerpt" => Method::Auto,
        local => local_method(local, "`excerpt`, ")?,
    };
    let options = frf_options(method, max_condition);
    let u = real::<IxDyn>("u", u, &RECORDINGS)?;
    let y = real::<IxDyn>("y", y, &RECORDINGS)?;
    let r = r.map(|r| real::<IxDyn>("r", r, &RECORDINGS)).transpose()?;
    let (u, y, r) = (
        repeats(u.as_array())?,
        repeats(y.as_array())?,
        r.as_ref().map(|r| repeats(r.as_array())).transpose()?,
    );
    let (hz, signal) = (&frequencies_hz.0, &chirp.signal);
    let estimate = || estimate_repeats(u, y, r, signal, sample_time_s, hz, start_s, &options);
    Ok(checked(detached(py, estimate)?.map_err(error::estimate)?))
}

/// Recordings with the axis of repeats, which one recording leaves out.
fn repeats(recording: ArrayView<'_, f64, IxDyn>) -> PyResult<ArrayView<'_, f64, Ix4>> {
    let full = if recording.ndim() == 4 {
        recording
    } else {
        recording.insert_axis(Axis(0))
    };
    full.into_dimensionality()
        .map_err(|error| PyValueError::new_err(error.to_string()))
}
