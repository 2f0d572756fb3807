//! Smoothness of a signal about a straight line.

use frfid_signals::median;

use crate::look::wrapped::JUDGED;

/// Smallest median size of the unwrapped signal about a straight line, in turns; below is rounding, and the
/// signal a sawtooth (or a shaft that turns evenly, which has no more to tell).
const MORE_THAN_A_LINE: f64 = 1e-6;
/// Median size of the unwrapped signal, about a straight line, over that of its changes: 0.7 for white noise,
/// more than 1.2 for what has most of its power below an eighth of the sampling frequency.
const SMOOTH: f64 = 1.2;

/// Whether a signal is smooth about a straight line, and more than that line; outliers aside.
pub(super) fn is_smooth(samples: &[f64], turn: f64) -> bool {
    let line = Line::through(samples);
    let of_signal = usual_size(samples, |k| line.distance(samples, k));
    let of_changes = usual_size(samples, |k| samples[k] - samples[k - 1] - line.slope);
    let sizes = of_signal.zip(of_changes);
    sizes.is_some_and(|(of_signal, of_changes)| {
        of_signal > MORE_THAN_A_LINE * turn && of_signal >= SMOOTH * of_changes
    })
}

/// Samples that are looked at, evenly over the signal.
fn sampled_places(samples: &[f64]) -> impl Iterator<Item = usize> {
    (1..samples.len()).step_by(samples.len() / JUDGED + 1)
}

/// Median size of something over the signal.
fn usual_size(samples: &[f64], of: impl Fn(usize) -> f64) -> Option<f64> {
    median(sampled_places(samples).map(|k| of(k).abs()).collect())
}

/// Mean of something over the signal.
fn mean(samples: &[f64], of: impl Fn(usize) -> f64) -> f64 {
    let count = sampled_places(samples).count() as f64;
    sampled_places(samples).map(of).sum::<f64>() / count
}

/// A straight line through a signal.
struct Line {
    /// Place in the middle, and the value there.
    middle: f64,
    offset: f64,
    /// Rise in a sample.
    slope: f64,
}

impl Line {
    /// By least squares.
    fn through(samples: &[f64]) -> Self {
        let middle = mean(samples, |k| k as f64);
        let offset = mean(samples, |k| samples[k]);
        let tilt = mean(samples, |k| (k as f64 - middle) * (samples[k] - offset));
        let slope = tilt / mean(samples, |k| (k as f64 - middle).powi(2));
        Self {
            middle,
            offset,
            slope,
        }
    }

    /// How far a sample lies above it.
    fn distance(&self, samples: &[f64], k: usize) -> f64 {
        samples[k] - self.offset - self.slope * (k as f64 - self.middle)
    }
}
