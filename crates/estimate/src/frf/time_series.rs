//! FRF of a campaign given as arrays of whole periods.

use frfid_signals::{Frf, SignalError};
use ndarray::{ArrayView5, Axis};

use crate::error::EstimateError;
use crate::frf::FrfOptions;
use crate::spectra::campaign::Campaign;
use crate::spectra::line_dft::LineDft;
use crate::spectra::time_series::{TimeSeries, check_same_shape};

/// Best linear approximation from time series `(realization, experiment, period, channel, sample)`
/// of any strides.
///
/// `harmonics` are DFT bins of the period, rising. The reference `r` has as many channels as `u` and
/// is for methods that estimate through it. The noise covariance is `None` with one period, the
/// total covariance with one realization.
///
/// # Errors
/// A reference that is missing or not used, shapes that differ, samples that are not finite, lines
/// off the grid, fewer experiments than inputs, lines on which U cannot be inverted:
/// [`EstimateError`] with what was found and needed.
pub fn estimate_bla(
    u: ArrayView5<f64>,
    y: ArrayView5<f64>,
    r: Option<ArrayView5<f64>>,
    sample_time_s: f64,
    harmonics: &[usize],
    options: &FrfOptions,
) -> Result<Frf, EstimateError> {
    if r.is_some() && !options.method.needs_reference() {
        let what = "a reference r is given, but the method does without; leave it out, or estimate \
                    through it by the method joint-input-output";
        return Err(SignalError::unfit("r", what).into());
    }
    check_same_shape(&u, &y, r.as_ref())?;
    let dft = LineDft::new(u.len_of(Axis(4)), harmonics)?;
    let mut campaign = Campaign::new(dft.frequency_hz(sample_time_s)?)?;
    TimeSeries { u, y, r }.transform_into(&mut campaign, &dft)?;
    campaign.estimate(options)
}
