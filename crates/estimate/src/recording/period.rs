//! Period of a recorded reference, found from the recording alone.
//!
//! Every lag T is rated by the share of the power that does not repeat after it,
//! `d(T) = sum_k (x[k + T] - x[k])^2 / sum_k (x[k + T]^2 + x[k]^2)`: 0 where the signal repeats, 1
//! for noise. All lags at once by autocorrelation.

use frfid_signals::check_finite;
use ndarray::{ArrayView1, ArrayView2};
use realfft::RealFftPlanner;

use crate::error::EstimateError;

/// Largest share of the power that may be noise: 10 dB below the signal.
const LIMIT: f64 = 0.1;

/// Period in samples of a reference `(channel, sample)` that repeats back to back at least twice:
/// any length, also with measurement noise up to 10 dB below the signal.
///
/// # Errors
/// [`EstimateError::NotPeriodic`]; [`frfid_signals::SignalError`] for samples that are not finite and
/// a signal without channels.
pub fn find_period(reference: ArrayView2<f64>) -> Result<usize, EstimateError> {
    check_finite("reference", reference)?;
    if reference.is_empty() {
        let needed = "(channel, sample) with at least one of both".to_string();
        return Err(EstimateError::shape("reference", reference.shape(), needed));
    }
    let unlike = unlikeness(reference);
    // Small lags look alike for any smooth signal: the search starts where the signal has left its
    // own neighbourhood.
    let start = first_lag(&unlike, 0, |value| value > 0.5);
    let best = (start..unlike.len()).min_by(|&a, &b| unlike[a].total_cmp(&unlike[b]));
    let Some(best) = best.filter(|&lag| unlike[lag] <= LIMIT) else {
        let (period, residual) = best.map_or((0, 1.0), |lag| (lag, unlike[lag]));
        return Err(EstimateError::NotPeriodic {
            period,
            residual,
            limit: LIMIT,
        });
    };
    // Multiples of the period repeat as well: the first dip as deep as the deepest is the period,
    // but for rounding and noise.
    let is_deep = |value: f64| value <= 2.0 * unlike[best] + 1e-12;
    let first = first_lag(&unlike, start, is_deep);
    let end = first_lag(&unlike, first, |value| !is_deep(value));
    Ok(refine(&unlike, lowest(&unlike, first, end)))
}

/// The first lag from `from` on whose value is as asked for, or the end.
fn first_lag(unlike: &[f64], from: usize, is_found: impl Fn(f64) -> bool) -> usize {
    (from..unlike.len())
        .find(|&lag| is_found(unlike[lag]))
        .unwrap_or(unlike.len())
}

/// The lag with the smallest value in `from..to`.
fn lowest(unlike: &[f64], from: usize, to: usize) -> usize {
    (from..to.min(unlike.len()))
        .min_by(|&a, &b| unlike[a].total_cmp(&unlike[b]))
        .unwrap_or(from)
}

/// Divides the error of a noisy dip by going to two, four, ... periods, where the same error in
/// samples counts less.
fn refine(unlike: &[f64], dip: usize) -> usize {
    let (mut lag, mut count) = (dip, 1);
    while 2 * lag < unlike.len() {
        lag = lowest(unlike, 2 * lag - 2, 2 * lag + 3);
        count *= 2;
    }
    (lag + count / 2) / count
}

/// `d(T)` for T = 0 ..= half the record, over all channels, each weighted by its power.
fn unlikeness(reference: ArrayView2<f64>) -> Vec<f64> {
    let lags = reference.ncols() / 2 + 1;
    let (mut difference, mut energy) = (vec![0.0; lags], vec![f64::MIN_POSITIVE; lags]);
    for channel in reference.rows() {
        let mean = channel.sum() / channel.len() as f64;
        let centred = channel.mapv(|value| value - mean);
        let power = centred.dot(&centred);
        if power == 0.0 {
            continue;
        }
        let mut both = 2.0 * power;
        for (lag, product) in autocorrelation(centred.view(), lags).iter().enumerate() {
            difference[lag] += (both - 2.0 * product) / power;
            energy[lag] += both / power;
            both -= centred[lag].powi(2) + centred[channel.len() - 1 - lag].powi(2);
        }
    }
    difference
        .iter()
        .zip(energy)
        .map(|(difference, energy)| difference / energy)
        .collect()
}

/// `sum_k x[k] x[k + T]` for the first `lags` lags, by a DFT padded so that nothing wraps around.
fn autocorrelation(x: ArrayView1<f64>, lags: usize) -> Vec<f64> {
    let length = (x.len() + lags).next_power_of_two();
    let mut planner = RealFftPlanner::new();
    let (forward, inverse) = (
        planner.plan_fft_forward(length),
        planner.plan_fft_inverse(length),
    );
    let (mut samples, mut spectrum) = (forward.make_input_vec(), forward.make_output_vec());
    samples
        .iter_mut()
        .zip(x)
        .for_each(|(sample, value)| *sample = *value);
    forward
        .process(&mut samples, &mut spectrum)
        .expect("the plan made the buffers, so their lengths fit");
    spectrum
        .iter_mut()
        .for_each(|value| *value = value.norm_sqr().into());
    inverse
        .process(&mut spectrum, &mut samples)
        .expect("the plan made the buffers; both ends of the spectrum are real");
    samples.truncate(lags);
    samples.iter().map(|value| value / length as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::random::{normal, phase, stream};
    use ndarray::Array2;
    use std::f64::consts::TAU;

    /// Two channels of a random-phase multisine of lines up to `highest`, `periods` of them (a part
    /// of one counts).
    fn multisine(
        period: usize,
        highest: usize,
        periods: f64,
        noise: f64,
        seed: u64,
    ) -> Array2<f64> {
        let mut rng = stream(seed, "multisine", &[]);
        let phases: Vec<f64> = (0..2 * highest).map(|_| phase(&mut rng)).collect();
        let cycle = Array2::from_shape_fn((2, period), |(c, k)| {
            (1..=highest)
                .map(|h| (TAU * (h * k) as f64 / period as f64 + phases[c * highest + h - 1]).sin())
                .sum::<f64>()
        });
        let scale = noise * (highest as f64 / 2.0).sqrt();
        Array2::from_shape_fn((2, (periods * period as f64) as usize), |(c, k)| {
            cycle[[c, k % period]] + scale * normal(&mut rng)
        })
    }

    #[test]
    fn any_length_is_found_clean_or_noisy_from_two_periods_on() {
        for (period, highest, periods) in [
            (2500, 60, 4.7),
            (997, 20, 2.0),
            (1983, 5, 3.0),
            (64, 1, 30.0),
        ] {
            for noise in [0.0, 1e-3, 0.1] {
                let found = find_period(multisine(period, highest, periods, noise, 3).view());
                // noise of a tenth hides a difference of one sample in a slow signal: then the
                // neighbours are right too
                let slack = if noise > 0.01 && highest < 10 { 1 } else { 0 };
                assert!(
                    found
                        .as_ref()
                        .is_ok_and(|found| found.abs_diff(period) <= slack),
                    "{found:?} for {period}, noise {noise}"
                );
            }
        }
    }

    #[test]
    fn what_does_not_repeat_is_refused() {
        let noise = multisine(100, 1, 30.0, 1e6, 1);
        assert!(
            matches!(find_period(noise.view()), Err(EstimateError::NotPeriodic { residual, .. }) if residual > 0.5)
        );
        let sweep = Array2::from_shape_fn((1, 20_000), |(_, k)| (1e-5 * (k as f64).powi(2)).sin());
        let less_than_two_periods = multisine(2500, 60, 1.9, 0.0, 1);
        for not_periodic in [
            sweep,
            less_than_two_periods,
            Array2::zeros((1, 100)),
            Array2::ones((2, 1)),
        ] {
            assert!(matches!(
                find_period(not_periodic.view()),
                Err(EstimateError::NotPeriodic { .. })
            ));
        }
        let said = refusal(find_period(Array2::zeros((0, 10)).view()));
        assert!(said.starts_with("reference has shape [0, 10]"), "{said}");
        let said = refusal(find_period(Array2::from_elem((1, 9), f64::NAN).view()));
        assert!(said.starts_with("reference: 9 samples are NaN"), "{said}");
    }
}
