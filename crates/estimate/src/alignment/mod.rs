//! Alignment of a recording with the references of a plan: where each of them was played, by which
//! clock, and the signals on the plan's own.

mod bins;
mod curve;
mod fit;
mod interpolation;
mod match_peaks;
mod occurrences;
#[cfg(test)]
mod tests;

use ndarray::{Array2, ArrayView1, ArrayView2};

pub use fit::Alignment;
pub use occurrences::{Occurrence, find_occurrences};

use crate::alignment::curve::Curve;
use crate::alignment::interpolation::Interpolation;

/// A reference that may have been played.
#[derive(Debug, Clone, Copy)]
pub struct Template<'a> {
    /// What was to be played, `(channel, sample)`.
    pub reference: ArrayView2<'a, f64>,
    /// Its sample time in s.
    pub sample_time_s: f64,
    /// Upper end of its band in Hz.
    pub high_hz: f64,
}

/// The signal of a recording that follows the references.
#[derive(Debug, Clone, Copy)]
pub struct Logged<'a> {
    /// Times of the samples in s by the recorder's clock, rising.
    pub times_s: &'a [f64],
    /// `(channel, sample)`; a missing sample is not finite.
    pub values: ArrayView2<'a, f64>,
}

/// A signal at `n` instants in s: where they lie in a hole or outside the recording, what a sine of
/// `high_hz` would lose there, NaN.
#[must_use]
pub fn resampled(
    times_s: &[f64],
    values: ArrayView1<f64>,
    instants_s: &[f64],
    high_hz: f64,
) -> Vec<f64> {
    let Some(signal) = Interpolation::of(times_s, values.iter().copied()) else {
        return vec![f64::NAN; instants_s.len()];
    };
    let at = |time_s: &f64| signal.within(*time_s, high_hz).unwrap_or(f64::NAN);
    instants_s.iter().map(at).collect()
}

impl Template<'_> {
    fn n_samples(&self) -> usize {
        self.reference.ncols()
    }

    /// Times of the samples in s.
    fn times_s(&self) -> Vec<f64> {
        let time_s = |k: usize| k as f64 * self.sample_time_s;
        (0..self.n_samples()).map(time_s).collect()
    }

    /// Length in s.
    fn length_s(&self) -> f64 {
        self.n_samples() as f64 * self.sample_time_s
    }

    /// Power of a channel about its mean.
    fn power(&self, channel: usize) -> f64 {
        power_about_mean(self.reference.row(channel).iter())
    }

    /// The channels, each by itself.
    fn channels(&self) -> Vec<Curve> {
        let rows = self.reference.rows().into_iter();
        rows.map(|row| Curve::through(row.to_vec(), self.sample_time_s))
            .collect()
    }
}

/// Mean square about the mean; 0 of nothing.
fn power_about_mean<'a>(values: impl Iterator<Item = &'a f64> + Clone) -> f64 {
    let n = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / n;
    values.map(|value| (value - mean).powi(2)).sum::<f64>() / n
}

/// A reference without its mean, channel by channel.
fn about_mean(signal: ArrayView2<f64>) -> Array2<f64> {
    let mut about = signal.to_owned();
    for mut row in about.rows_mut() {
        let mean = row.mean().unwrap_or(0.0);
        row -= mean;
    }
    about
}
