//! FRF of a campaign given as arrays of whole periods.

use frfid_signals::Frf;
use ndarray::{ArrayView5, Axis};

use crate::error::EstimateError;
use crate::frf::FrfOptions;
use crate::frf::estimate::FrfEstimate;
use crate::spectra::campaign::Campaign;
use crate::spectra::line_dft::LineDft;
use crate::spectra::time_series::{TimeSeries, check_same_shape};

/// Best linear approximation from time series `(realization, experiment, period, channel, sample)`
/// of any strides.
///
/// `harmonics` are DFT bins of the period, rising. The reference `r` has as many channels as `u` and
/// is for methods that estimate through it. The noise covariance is `None` with one period, the
/// total covariance with one realization. Realizations that turn out to be one draw of phases count
/// as repetitions of it ([`Campaign::pool_equal_draws`]): what they differ by is noise; without
/// any, as in a simulation, they are copies and count once. Lines on which an input is not excited
/// are NaN; [`estimate_periods`] tells which.
///
/// ```
/// use frfid_estimate::{Method, estimate_bla};
/// use ndarray::Array5;
///
/// // (realization, experiment, period, channel, sample): y is twice u
/// let u = Array5::from_shape_fn((3, 1, 2, 1, 64), |(p, _, _, _, k)| ((k * k + p) as f64).sin());
/// let y = 2.0 * &u;
/// let options = Method::MeanOfFrfs.into();
/// let frf = estimate_bla(u.view(), y.view(), None, 1e-3, &[1, 3, 5], &options)?;
/// assert!((frf.response[[0, 0, 0]].re - 2.0).abs() < 1e-12);
/// // 3 (2 - 1), less where realizations are excited unlike
/// assert!(frf.noise.is_some_and(|noise| noise.degrees_of_freedom <= 3.0));
/// # Ok::<(), frfid_estimate::EstimateError>(())
/// ```
///
/// # Errors
/// A reference that is missing or not used, shapes that differ, samples that are not finite, lines
/// off the grid, fewer experiments than inputs, U that can be inverted on no line:
/// [`EstimateError`] with what was found and needed.
pub fn estimate_bla(
    u: ArrayView5<f64>,
    y: ArrayView5<f64>,
    r: Option<ArrayView5<f64>>,
    sample_time_s: f64,
    harmonics: &[usize],
    options: &FrfOptions,
) -> Result<Frf, EstimateError> {
    Ok(estimate_periods(u, y, r, sample_time_s, harmonics, options)?.frf)
}

/// As [`estimate_bla`], with the lines that were left out and the realizations that were equal
/// draws.
///
/// # Errors
/// As [`estimate_bla`].
pub fn estimate_periods(
    u: ArrayView5<f64>,
    y: ArrayView5<f64>,
    r: Option<ArrayView5<f64>>,
    sample_time_s: f64,
    harmonics: &[usize],
    options: &FrfOptions,
) -> Result<FrfEstimate, EstimateError> {
    options.method.check_reference(r.is_some())?;
    campaign_of_periods(u, y, r, sample_time_s, harmonics)?.estimate_draws(options)
}

/// The spectra of time series as [`estimate_bla`] takes them, realizations as they are given.
///
/// # Errors
/// Shapes that differ, samples that are not finite, lines off the grid.
pub fn campaign_of_periods(
    u: ArrayView5<f64>,
    y: ArrayView5<f64>,
    r: Option<ArrayView5<f64>>,
    sample_time_s: f64,
    harmonics: &[usize],
) -> Result<Campaign, EstimateError> {
    check_same_shape(&u, &y, r.as_ref())?;
    let dft = LineDft::new(u.len_of(Axis(4)), harmonics)?;
    let mut campaign = Campaign::new(dft.frequency_hz(sample_time_s)?)?;
    TimeSeries { u, y, r }.transform_into(&mut campaign, &dft)?;
    Ok(campaign)
}
