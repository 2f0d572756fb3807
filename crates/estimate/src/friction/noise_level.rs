//! Noise level of a signal that is slow against its sample rate, from its sixth differences.

use frfid_signals::median;

/// Order of the differences: they weaken a signal at a sixteenth of the sample rate to 1 part in 300.
const ORDER: usize = 6;
/// Standard deviation of a normal variable over the median of its size.
const OF_MEDIAN: f64 = 1.482_6;
/// Root of the sum of squares of the binomials of sixth differences.
const GAIN: f64 = 30.397_368;

/// Standard deviation of white noise on a signal; 0 of one too short to tell.
pub(super) fn noise_level(signal: &[f64]) -> f64 {
    let mut differences = signal.to_vec();
    for _ in 0..ORDER {
        differences = differences.windows(2).map(|two| two[1] - two[0]).collect();
    }
    let sizes = differences.iter().map(|value| value.abs());
    OF_MEDIAN * median(sizes.collect()).unwrap_or(0.0) / GAIN
}
