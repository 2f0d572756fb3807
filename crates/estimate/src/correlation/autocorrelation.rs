//! Autocorrelation of a recording with lost samples, and the lags that stand out in it.

use std::iter::{successors, zip};

use realfft::RealFftPlanner;

use crate::correlation::channel::Channel;

/// Lags that are looked at for each width of a peak.
const PEAKS_PER_WIDTH: usize = 3;
/// Two periods of a fraction each are up to so many samples shorter than twice the next whole lag.
const BEYOND_HALF: usize = 3;
/// Shortest period that is looked for, in samples.
pub(crate) const SHORTEST: usize = 4;

/// `sum_k x[k] x[k + T] / sum_k x[k]^2` for T = 0 ..= half the record; pairs of which one is lost are
/// left out, and made up for by those that are there.
pub(crate) fn autocorrelation(channel: &Channel) -> Vec<f64> {
    let values = channel.values();
    let lags = (values.len() / 2 + BEYOND_HALF).min(values.len());
    let mut products = correlate(values.iter().map(value_or_zero), values.len(), lags);
    if values.iter().any(|value| value.is_nan()) {
        make_up(&mut products, values);
    }
    let power = products[0].max(f64::MIN_POSITIVE);
    products.iter_mut().for_each(|product| *product /= power);
    products
}

/// Scales each sum over pairs to the number that there were if none was lost.
fn make_up(products: &mut [f64], values: &[f64]) {
    let mask = values.iter().map(one_if_present);
    let pairs = correlate(mask, values.len(), products.len());
    for (lag, (product, pairs)) in products.iter_mut().zip(pairs).enumerate() {
        *product *= (values.len() - lag) as f64 / pairs.round().max(1.0);
    }
}

fn value_or_zero(value: &f64) -> f64 {
    if value.is_nan() { 0.0 } else { *value }
}

fn one_if_present(value: &f64) -> f64 {
    if value.is_nan() { 0.0 } else { 1.0 }
}

/// `sum_k x[k] x[k + T]` for the first `lags` lags, by a DFT padded so that nothing wraps around.
fn correlate(x: impl Iterator<Item = f64>, n_samples: usize, lags: usize) -> Vec<f64> {
    let length = smooth_length(n_samples + lags);
    let mut samples = vec![0.0; length];
    zip(&mut samples, x).for_each(|(sample, value)| *sample = value);
    samples = wrapped_correlation(samples);
    samples.truncate(lags);
    samples.iter().map(|value| value / length as f64).collect()
}

/// `N sum_k x[k] x[(k + T) mod N]`, by the squares of the spectrum.
fn wrapped_correlation(mut samples: Vec<f64>) -> Vec<f64> {
    let mut planner = RealFftPlanner::new();
    let forward = planner.plan_fft_forward(samples.len());
    let inverse = planner.plan_fft_inverse(samples.len());
    let mut spectrum = forward.make_output_vec();
    forward
        .process(&mut samples, &mut spectrum)
        .expect("the plan made the buffer, so its length fits");
    for value in &mut spectrum {
        *value = value.norm_sqr().into();
    }
    inverse
        .process(&mut spectrum, &mut samples)
        .expect("both ends of the spectrum are real");
    samples
}

/// The smallest even number from `least` on that is 2^a 3^b 5^c.
fn smooth_length(least: usize) -> usize {
    let mut best = least.next_power_of_two().max(2);
    let mut fives = 1;
    while fives < best {
        let mut odd = fives;
        while odd < best {
            best = best.min(2 * odd * least.div_ceil(2 * odd).next_power_of_two());
            odd *= 3;
        }
        fives *= 5;
    }
    best
}

/// Lags at which the correlation has a peak, the highest for each width of a peak (1, 2, 4, ...
/// samples): the height is that above its surroundings, so that a level that shifts once, which
/// correlates with itself over all lags, does not count. As it is and for as many pairs at each
/// lag, since the peaks of a narrow band hardly differ.
pub(crate) fn peaks(correlation: &[f64]) -> Vec<usize> {
    let per_pair = per_pair(correlation);
    let doubled = |width: &usize| Some(2 * width);
    let widths = successors(Some(1), doubled).take_while(|width| 3 * width < correlation.len());
    let of_width = |width| [highest(correlation, width), highest(&per_pair, width)];
    let mut found = widths.flat_map(of_width).flatten().collect::<Vec<_>>();
    found.sort_unstable();
    found.dedup();
    found
}

/// The correlation as if each lag had as many pairs.
fn per_pair(correlation: &[f64]) -> Vec<f64> {
    let n_samples = 2.0 * correlation.len() as f64;
    let per_pair = |(lag, value): (usize, &f64)| value * n_samples / (n_samples - lag as f64);
    correlation.iter().enumerate().map(per_pair).collect()
}

/// The highest peaks of one width, the highest first.
fn highest(correlation: &[f64], width: usize) -> Vec<usize> {
    let mut best: Vec<(f64, usize)> = Vec::new();
    for lag in SHORTEST.max(2 * width)..correlation.len() {
        if is_peak(correlation, lag) {
            keep_highest(&mut best, height(correlation, lag, width), lag);
        }
    }
    best.into_iter().map(|(_, lag)| lag).collect()
}

/// How far a peak stands above its surroundings.
fn height(correlation: &[f64], lag: usize, width: usize) -> f64 {
    let around = correlation[lag - width] + correlation.get(lag + width).unwrap_or(&0.0);
    correlation[lag] - 0.5 * around
}

/// Adds a peak above zero to the `best`, if it is higher than the lowest of a full list.
fn keep_highest(best: &mut Vec<(f64, usize)>, height: f64, lag: usize) {
    let weakest = best.get(PEAKS_PER_WIDTH - 1).map_or(0.0, |peak| peak.0);
    if height > weakest {
        best.truncate(PEAKS_PER_WIDTH - 1);
        best.push((height, lag));
        best.sort_by(|a, b| b.0.total_cmp(&a.0));
    }
}

/// Whether neither neighbour is higher; the last lag has one neighbour.
pub(crate) fn is_peak(correlation: &[f64], lag: usize) -> bool {
    let next = correlation.get(lag + 1).copied().unwrap_or(f64::MIN);
    correlation[lag] >= correlation[lag - 1] && correlation[lag] >= next
}
