//! Autocorrelation of a recording with lost samples, and the lags that stand out in it.

use std::iter::{successors, zip};

use frfid_transforms::TransformPlanner;
use num_complex::Complex64;

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
    let mut products = sums_of_products(channel.values());
    let power = products[0].max(f64::MIN_POSITIVE);
    products.iter_mut().for_each(|product| *product /= power);
    products
}

/// `sum_k x[k] x[k + T]`, as if nothing was lost.
fn sums_of_products(values: &[f64]) -> Vec<f64> {
    let lags = (values.len() / 2 + BEYOND_HALF).min(values.len());
    let mut products = correlate(values.iter().map(value_or_zero), lags);
    if values.iter().any(|value| value.is_nan()) {
        make_up(&mut products, values);
    }
    products
}

/// Scales each sum over pairs to the number that there were if none was lost.
fn make_up(products: &mut [f64], values: &[f64]) {
    let pairs = correlate(values.iter().map(one_if_present), products.len());
    for (lag, product) in products.iter_mut().enumerate() {
        *product *= (values.len() - lag) as f64 / pairs[lag].round().max(1.0);
    }
}

fn value_or_zero(value: &f64) -> f64 {
    if value.is_nan() { 0.0 } else { *value }
}

fn one_if_present(value: &f64) -> f64 {
    if value.is_nan() { 0.0 } else { 1.0 }
}

/// `sum_k x[k] x[k + T]` for the first `lags` lags, by a DFT padded so that nothing wraps around.
fn correlate(x: impl Iterator<Item = f64>, lags: usize) -> Vec<f64> {
    let samples = padded(x, lags);
    let length = samples.len();
    let mut products = synthesised(&mut power_spectrum(samples), length);
    products.truncate(lags);
    products.iter().map(|x| x / length as f64).collect()
}

/// The samples, and zeros after them.
fn padded(x: impl Iterator<Item = f64>, lags: usize) -> Vec<f64> {
    let mut samples: Vec<f64> = x.collect();
    samples.resize(smooth_length(samples.len() + lags), 0.0);
    samples
}

fn power_spectrum(mut samples: Vec<f64>) -> Vec<Complex64> {
    let forward = TransformPlanner::default().forward(samples.len());
    let mut spectrum = forward.make_output_vec();
    forward
        .process(&mut samples, &mut spectrum)
        .expect("the plan made the buffer, so its length fits");
    let power = spectrum.iter().map(Complex64::norm_sqr);
    power.map(Complex64::from).collect()
}

/// The samples that have a `spectrum`, times their number.
fn synthesised(spectrum: &mut [Complex64], n_samples: usize) -> Vec<f64> {
    let inverse = TransformPlanner::default().inverse(n_samples);
    let mut samples = inverse.make_output_vec();
    inverse
        .process(spectrum, &mut samples)
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
    let found = highest_of_each_width(correlation).chain(highest_of_each_width(&per_pair));
    let mut found: Vec<usize> = found.collect();
    found.sort_unstable();
    found.dedup();
    found
}

fn highest_of_each_width(correlation: &[f64]) -> impl Iterator<Item = usize> {
    let widths = successors(Some(1), |width| Some(2 * width));
    let widths = widths.take_while(|width| 3 * width < correlation.len());
    widths.flat_map(|width| highest(correlation, width))
}

/// The correlation as if each lag had as many pairs.
fn per_pair(correlation: &[f64]) -> Vec<f64> {
    let n_samples = 2.0 * correlation.len() as f64;
    let of_lag = |(lag, value)| value * n_samples / (n_samples - f64::from(lag));
    zip(0_u32.., correlation).map(of_lag).collect()
}

/// The highest peaks of one width, the highest first.
fn highest(correlation: &[f64], width: usize) -> Vec<usize> {
    let mut best = Vec::new();
    for lag in SHORTEST.max(2 * width)..correlation.len() {
        if is_peak(correlation, lag) {
            keep_highest(&mut best, Peak::new(correlation, lag, width));
        }
    }
    best.iter().map(|peak| peak.lag).collect()
}

struct Peak {
    /// Above its surroundings.
    height: f64,
    lag: usize,
}

impl Peak {
    fn new(correlation: &[f64], lag: usize, width: usize) -> Self {
        let around = correlation[lag - width] + correlation.get(lag + width).unwrap_or(&0.0);
        let height = correlation[lag] - 0.5 * around;
        Self { height, lag }
    }
}

/// Adds a peak above zero to the `best`, if it is higher than the lowest of a full list.
fn keep_highest(best: &mut Vec<Peak>, peak: Peak) {
    if peak.height > weakest(best) {
        best.truncate(PEAKS_PER_WIDTH - 1);
        best.push(peak);
        best.sort_by(|a, b| b.height.total_cmp(&a.height));
    }
}

fn weakest(best: &[Peak]) -> f64 {
    let last = best.get(PEAKS_PER_WIDTH - 1);
    last.map_or(0.0, |peak| peak.height)
}

/// Whether neither neighbour is higher; the last lag has one neighbour.
pub(crate) fn is_peak(correlation: &[f64], lag: usize) -> bool {
    let next = correlation.get(lag + 1).copied().unwrap_or(f64::MIN);
    correlation[lag] >= correlation[lag - 1] && correlation[lag] >= next
}
