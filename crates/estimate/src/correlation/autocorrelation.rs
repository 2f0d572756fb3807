//! Autocorrelation of a recording with lost samples, and the lags that stand out in it.

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
    let present = values
        .iter()
        .map(|value| if value.is_nan() { 0.0 } else { *value });
    let mut products = correlate(present, values.len(), lags);
    if values.iter().any(|value| value.is_nan()) {
        let mask = values
            .iter()
            .map(|value| f64::from(u8::from(!value.is_nan())));
        let pairs = correlate(mask, values.len(), lags);
        for (lag, (product, pairs)) in products.iter_mut().zip(pairs).enumerate() {
            *product *= (values.len() - lag) as f64 / pairs.round().max(1.0);
        }
    }
    let power = products[0].max(f64::MIN_POSITIVE);
    products.iter_mut().for_each(|product| *product /= power);
    products
}

/// `sum_k x[k] x[k + T]` for the first `lags` lags, by a DFT padded so that nothing wraps around.
fn correlate(x: impl Iterator<Item = f64>, n_samples: usize, lags: usize) -> Vec<f64> {
    let length = smooth_length(n_samples + lags);
    let mut planner = RealFftPlanner::new();
    let (forward, inverse) = (
        planner.plan_fft_forward(length),
        planner.plan_fft_inverse(length),
    );
    let (mut samples, mut spectrum) = (forward.make_input_vec(), forward.make_output_vec());
    samples
        .iter_mut()
        .zip(x)
        .for_each(|(sample, value)| *sample = value);
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
    let n_samples = 2.0 * correlation.len() as f64;
    let per_pair = |(lag, value): (usize, &f64)| value * n_samples / (n_samples - lag as f64);
    let per_pair: Vec<f64> = correlation.iter().enumerate().map(per_pair).collect();
    let mut found = Vec::new();
    let mut width = 1;
    while 3 * width < correlation.len() {
        found.extend(highest(correlation, width));
        found.extend(highest(&per_pair, width));
        width *= 2;
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// The highest peaks of one width.
fn highest(correlation: &[f64], width: usize) -> Vec<usize> {
    let height = |lag: usize| {
        let around = correlation[lag - width] + correlation.get(lag + width).unwrap_or(&0.0);
        correlation[lag] - 0.5 * around
    };
    let mut best: Vec<(f64, usize)> = Vec::new();
    for lag in SHORTEST.max(2 * width)..correlation.len() {
        let weakest = match best.len() {
            PEAKS_PER_WIDTH => best[PEAKS_PER_WIDTH - 1].0,
            _ => 0.0,
        };
        if is_peak(correlation, lag) && height(lag) > weakest {
            best.truncate(PEAKS_PER_WIDTH - 1);
            best.push((height(lag), lag));
            best.sort_by(|a, b| b.0.total_cmp(&a.0));
        }
    }
    best.into_iter().map(|(_, lag)| lag).collect()
}

/// Whether neither neighbour is higher; the last lag has one neighbour.
pub(crate) fn is_peak(correlation: &[f64], lag: usize) -> bool {
    let next = correlation.get(lag + 1).copied().unwrap_or(f64::MIN);
    correlation[lag] >= correlation[lag - 1] && correlation[lag] >= next
}
