//! Periods that are still transient: those at the beginning that differ from the last ones by more than noise.

use frfid_signals::SignalError;
use ndarray::{ArrayView3, Axis, s};

use crate::EstimateError;

/// A period is settled when its distance from the last ones has at most this ratio to their own spread (powers: 3 dB).
const RATIO: f64 = 2.0;
/// Where the last periods agree to rounding, this share of the power of the signal takes the place of their spread.
const ROUNDING: f64 = 1e-24;

/// Number of leading periods of `(period, channel, sample)` to drop: up to the last one, counted from the beginning, that
/// differs from the mean of the last half of the periods, in any channel, by more than twice (in power) the spread of that half.
///
/// With fewer than three periods there is no spread to compare with, and the answer is 0.
///
/// # Errors
/// [`EstimateError::NotSettled`] if the whole first half is still transient, [`SignalError::NotFinite`].
pub fn count_transient_periods(periods: ArrayView3<f64>) -> Result<usize, EstimateError> {
    for period in periods.outer_iter() {
        frfid_signals::check_finite("periods", period)?;
    }
    let n_periods = periods.len_of(Axis(0));
    if n_periods < 3 {
        return Ok(0);
    }
    let first_of_last = n_periods / 2;
    let mut transient = 0;
    for channel in periods.axis_iter(Axis(1)) {
        let settled = channel.slice(s![first_of_last.., ..]);
        let Some(mean) = settled.mean_axis(Axis(0)) else {
            let needed = "(period, channel, sample) with samples".to_string();
            return Err(SignalError::Shape { name: "periods", found: periods.shape().to_vec(), needed }.into());
        };
        let distance =
            |period: ndarray::ArrayView1<f64>| period.iter().zip(&mean).map(|(x, m)| (x - m).powi(2)).sum::<f64>();
        let count = settled.nrows() as f64;
        let spread = settled.rows().into_iter().map(distance).sum::<f64>() / (count - 1.0);
        let power = mean.iter().map(|value| value * value).sum::<f64>();
        // the mean itself carries the spread of one in `count`
        let allowed = RATIO * (1.0 + 1.0 / count) * spread + ROUNDING * power;
        let last = (0..first_of_last).rev().find(|&q| distance(channel.row(q)) > allowed);
        transient = transient.max(last.map_or(0, |last| last + 1));
    }
    if transient == first_of_last {
        return Err(EstimateError::NotSettled { n_periods, transient });
    }
    Ok(transient)
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{normal, stream};
    use ndarray::Array3;

    fn recording(n_periods: usize, size: f64, decay: f64, noise: f64) -> Array3<f64> {
        let mut rng = stream(2, "transient", &[]);
        Array3::from_shape_fn((n_periods, 2, 400), |(q, c, k)| {
            let transient = if c == 1 { size * (-decay * (q * 400 + k) as f64).exp() } else { 0.0 };
            (0.3 * k as f64).sin() + transient + noise * normal(&mut rng)
        })
    }

    #[test]
    fn leading_periods_above_the_noise_are_counted() {
        let count = |n, size, decay, noise| count_transient_periods(recording(n, size, decay, noise).view());
        assert_eq!(count(10, 0.0, 0.02, 0.1), Ok(0));
        assert_eq!(count(10, 5.0, 0.02, 0.1), Ok(1));
        assert_eq!(count(20, 5.0, 0.004, 0.05), Ok(3)); // e^-1.6 per period: power 3000, 125, 5, 0.2 against 1 of noise
        assert_eq!(count(20, 0.0, 0.02, 0.0), Ok(0));
        assert_eq!(count(2, 5.0, 0.02, 0.1), Ok(0));
    }

    #[test]
    fn a_transient_that_outlasts_the_first_half_is_an_error() {
        let slow = count_transient_periods(recording(6, 5.0, 1e-3, 0.01).view());
        assert_eq!(slow, Err(EstimateError::NotSettled { n_periods: 6, transient: 3 }));
        let mut holed = recording(4, 5.0, 1.0, 0.1);
        holed[[1, 0, 3]] = f64::NAN;
        assert!(count_transient_periods(holed.view()).is_err());
    }
}
