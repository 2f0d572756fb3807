//! Transient periods of a recording: those at the beginning that differ from the last ones by far more
//! than these differ among each other.

use std::iter::zip;

use ndarray::{ArrayView1, ArrayView3, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::lines::mean_spectrum;
use crate::spectra::line_dft::LineDft;

/// A period is transient when its squared distance from the last ones exceeds theirs by this factor
/// (10 dB). Real machines drift and are knocked now and then: half of that is nothing unusual.
const RATIO: f64 = 10.0;
/// Where the last periods agree to rounding, this share of the power of the signal takes the place
/// of their spread.
const ROUNDING: f64 = 1e-24;

/// Number of leading periods of `(period, channel, sample)` to drop: those that differ on the
/// excited `lines`, in any channel, from the mean of the last half of the periods by more than ten
/// times (in power) what that half differs from it.
///
/// With fewer than three periods there is no spread to compare with, and the answer is 0.
///
/// # Errors
/// [`EstimateError::NotSettled`] if the whole first half is transient, those of [`LineDft::new`],
/// [`frfid_signals::SignalError::NotFinite`].
pub fn count_transient_periods(
    periods: ArrayView3<f64>,
    lines: &[usize],
) -> Result<usize, EstimateError> {
    let (n_periods, n_channels, n_samples) = periods.dim();
    let dft = LineDft::new(n_samples, lines)?;
    let spectra = dft.transform_each("periods", periods.axis_iter(Axis(0)))?;
    if n_periods < 3 {
        return Ok(0);
    }
    let count = |channel: usize| {
        let rows: Vec<_> = spectra.iter().map(|all| all.row(channel)).collect();
        leading_outliers(&rows, n_periods / 2)
    };
    let transient = (0..n_channels).map(count).max().unwrap_or(0);
    if transient == n_periods / 2 {
        return Err(EstimateError::NotSettled {
            n_periods,
            transient,
        });
    }
    Ok(transient)
}

/// How many spectra before `first_settled` differ, without interruption from the first on, from
/// those after it.
pub(super) fn leading_outliers(spectra: &[ArrayView1<Complex64>], first_settled: usize) -> usize {
    let settled = &spectra[first_settled..];
    let count = settled.len() as f64;
    let mean = mean_spectrum(settled);
    let distance = |spectrum: &ArrayView1<Complex64>| {
        zip(spectrum, &mean)
            .map(|(x, mean)| (x - mean).norm_sqr())
            .sum::<f64>()
    };
    let spread = settled.iter().map(distance).sum::<f64>() / (count - 1.0);
    let power: f64 = mean.iter().map(Complex64::norm_sqr).sum();
    // the mean itself carries the spread of one in `count`
    let allowed = RATIO * (1.0 + 1.0 / count) * spread + ROUNDING * power;
    spectra[..first_settled]
        .iter()
        .take_while(|spectrum| distance(spectrum) > allowed)
        .count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::random::{normal, stream};
    use ndarray::Array3;
    use std::f64::consts::TAU;

    const LINES: [usize; 5] = [1, 3, 5, 7, 19];

    fn recording(n_periods: usize, size: f64, decay: f64, noise: f64) -> Array3<f64> {
        let mut rng = stream(2, "transient", &[]);
        Array3::from_shape_fn((n_periods, 2, 400), |(q, c, k)| {
            let transient = if c == 1 {
                size * (-decay * (q * 400 + k) as f64).exp()
            } else {
                0.0
            };
            (TAU * 19.0 * k as f64 / 400.0).sin() + transient + noise * normal(&mut rng)
        })
    }

    #[test]
    fn leading_periods_above_the_noise_are_counted() {
        let count = |n, size, decay, noise| {
            count_transient_periods(recording(n, size, decay, noise).view(), &LINES)
        };
        assert_eq!(count(10, 0.0, 0.02, 0.1), Ok(0));
        assert_eq!(count(10, 5.0, 0.02, 0.1), Ok(1));
        // power on these lines 72000, 2900, 120, 5 in the first periods against 20 of noise, 220
        // allowed
        assert_eq!(count(20, 5.0, 0.004, 0.1), Ok(2));
        assert_eq!(count(20, 0.0, 0.02, 0.0), Ok(0));
        assert_eq!(count(2, 5.0, 0.02, 0.1), Ok(0));
    }

    #[test]
    fn one_bad_period_later_on_is_no_transient() {
        let mut knocked = recording(20, 5.0, 0.02, 0.1);
        knocked
            .index_axis_mut(Axis(0), 7)
            .mapv_inplace(|value| 1.5 * value);
        assert_eq!(count_transient_periods(knocked.view(), &LINES), Ok(1));
    }

    #[test]
    fn a_transient_that_outlasts_the_first_half_is_an_error() {
        // without noise a decay is never over: e^-3.2 per period, the last half itself spreads a
        // little only
        let slow = count_transient_periods(recording(6, 5.0, 8e-3, 0.0).view(), &LINES);
        assert_eq!(
            slow,
            Err(EstimateError::NotSettled {
                n_periods: 6,
                transient: 3
            })
        );
        let mut holed = recording(4, 5.0, 1.0, 0.1);
        holed[[1, 0, 3]] = f64::NAN;
        let said = refusal(count_transient_periods(holed.view(), &LINES));
        assert!(said.starts_with("periods: 1 samples are NaN"), "{said}");
    }
}
