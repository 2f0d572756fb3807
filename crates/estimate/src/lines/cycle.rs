//! Mean period of one channel of a recording, with the noise that is left in it.

use std::iter::zip;

use frfid_transforms::TransformPlanner;
use ndarray::{Array1, Array2, ArrayView1, Axis};
use num_complex::Complex64;

use crate::correlation::lag::{FIRST_TAP, taps};
use crate::error::EstimateError;
use crate::repetition::n_periods;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;

/// Lines on either side over which the noise is averaged: two periods alone tell it to a factor only.
const SMOOTHED: usize = 25;

/// The mean over periods; NaN where all of them lack a sample.
pub(super) struct Cycle {
    pub(super) mean: Array1<f64>,
    /// Power of the noise in the mean, line by line from 1 on; 0 where it is unknown.
    pub(super) noise: Vec<f64>,
    /// Whether there is a place that several periods have.
    pub(super) is_repeated: bool,
    /// Whether samples were interpolated, since the period has a fraction.
    pub(super) is_interpolated: bool,
}

impl Cycle {
    /// Of samples with NaN where they are lost, on the `dft` of the period next to `period`.
    pub(super) fn new(
        samples: ArrayView1<f64>,
        period: f64,
        dft: &LineDft,
    ) -> Result<Self, EstimateError> {
        let periods = folded(samples, period, dft.n_samples());
        let counts = over_periods(&periods, |present| present.count() as f64);
        let mean = over_periods(&periods, |present| present.sum::<f64>()) / &counts;
        let share = noise_share(&counts);
        let noise = match share {
            Some(share) => smoothed(&noise(&periods, &mean, share, dft)?),
            None => vec![0.0; dft.lines().len()],
        };
        Ok(Self {
            mean,
            noise,
            is_repeated: share.is_some(),
            is_interpolated: period != dft.n_samples() as f64,
        })
    }

    /// Whether every place is there in some period.
    pub(super) fn is_whole(&self) -> bool {
        self.mean.iter().all(|value| !value.is_nan())
    }

    /// The mean; where it is lost, the model, and what it misses at the places around, straight
    /// between them.
    pub(super) fn filled(&self, model: &[f64]) -> Array1<f64> {
        let model = ArrayView1::from(model);
        let mut missed = &self.mean - &model;
        fill_straight(&mut missed);
        missed + model
    }
}

/// Fills what is NaN straight between the places around; the last is followed by the first.
fn fill_straight(values: &mut Array1<f64>) {
    let places = 0..values.len();
    let present: Vec<usize> = places.filter(|&k| !values[k].is_nan()).collect();
    for (place, &before) in present.iter().enumerate() {
        let after = present.get(place + 1).copied();
        bridge(values, before, after.unwrap_or(present[0] + values.len()));
    }
}

/// Straight between two places, the second of which may be one period later.
fn bridge(values: &mut Array1<f64>, before: usize, after: usize) {
    let n = values.len();
    let rise = (values[after % n] - values[before]) / (after - before) as f64;
    for k in before + 1..after {
        values[k % n] = values[before] + rise * (k - before) as f64;
    }
}

/// What the samples of each phase that are there give.
fn over_periods(
    periods: &Array2<f64>,
    of: impl Fn(&mut dyn Iterator<Item = f64>) -> f64,
) -> Array1<f64> {
    periods.map_axis(Axis(0), |phase| {
        of(&mut phase.iter().copied().filter(|x| !x.is_nan()))
    })
}

/// Noise in the mean over squares about it: of the squares at a place that `count` periods have,
/// `count - 1` parts are noise, and the mean keeps one of `count`. `None` where no place repeats.
fn noise_share(counts: &Array1<f64>) -> Option<f64> {
    let there = || counts.iter().filter(|&&count| count > 0.0);
    let kept: f64 = there().map(|count| 1.0 / count).sum();
    let lost: f64 = there().map(|count| count - 1.0).sum();
    (lost > 0.0).then(|| kept / lost)
}

/// Power of the noise in the mean, line by line.
fn noise(
    periods: &Array2<f64>,
    mean: &Array1<f64>,
    share: f64,
    dft: &LineDft,
) -> Result<Vec<f64>, EstimateError> {
    let mut noise = vec![0.0; dft.lines().len()];
    for period in periods.rows() {
        let mut difference = &period - mean;
        difference.mapv_inplace(|value| if value.is_nan() { 0.0 } else { value });
        let spectrum = dft.transform("reference", difference.insert_axis(Axis(0)).view())?;
        for (sum, value) in noise.iter_mut().zip(&spectrum) {
            *sum += value.norm_sqr() * share;
        }
    }
    Ok(noise)
}

/// Periods one below the other, on the grid of `n_samples` per period.
fn folded(samples: ArrayView1<f64>, period: f64, n_samples: usize) -> Array2<f64> {
    let n_periods = n_periods(samples.len(), period);
    if period == n_samples as f64 {
        return Array2::from_shape_fn((n_periods, n_samples), |(q, k)| samples[q * n_samples + k]);
    }
    let step = period / n_samples as f64;
    Array2::from_shape_fn((n_periods, n_samples), |(q, k)| {
        between(samples, q as f64 * period + k as f64 * step)
    })
}

/// The value at a place between samples: by their 16 neighbours, by two where others are lost.
fn between(samples: ArrayView1<f64>, place: f64) -> f64 {
    let (whole, fraction) = (place as usize, place.fract());
    let value = by_sinc(samples, whole, fraction);
    if value.is_nan() {
        by_two(samples, whole, fraction)
    } else {
        value
    }
}

fn by_two(samples: ArrayView1<f64>, whole: usize, fraction: f64) -> f64 {
    let [before, after] = [0, 1].map(|offset| sample_or_nan(samples, whole, offset));
    (1.0 - fraction) * before + fraction * after
}

/// By 16 neighbours; NaN where one of them is lost.
fn by_sinc(samples: ArrayView1<f64>, whole: usize, fraction: f64) -> f64 {
    let near = zip(taps(fraction), FIRST_TAP..);
    let terms = near.map(|(tap, offset)| tap * sample_or_nan(samples, whole, offset));
    terms.sum()
}

fn sample_or_nan(samples: ArrayView1<f64>, k: usize, offset: isize) -> f64 {
    let index = k.checked_add_signed(offset);
    let sample = index.and_then(|index| samples.get(index).copied());
    sample.unwrap_or(f64::NAN)
}

/// The samples of a period that has these lines of `spectrum`, which begins with line 1, and no
/// other, differentiated `order` times, per turn.
pub(super) fn synthesised(
    spectrum: &[Complex64],
    lines: &[usize],
    n_samples: usize,
    order: i32,
) -> Vec<f64> {
    let inverse = TransformPlanner::default().inverse(n_samples);
    let (mut bins, mut samples) = (inverse.make_input_vec(), inverse.make_output_vec());
    for &index in lines {
        let h = (index + 1) as f64;
        bins[index + 1] = spectrum[index] * Complex64::new(0.0, h).powi(order) / n_samples as f64;
    }
    inverse
        .process(&mut bins, &mut samples)
        .expect("the plan made the buffers; both ends of the spectrum are zero");
    samples
}

/// The mean over the neighbours, or the value of a line itself if it is larger: a hum that does not
/// repeat.
fn smoothed(noise: &[f64]) -> Vec<f64> {
    let sums = running_sums(noise);
    let value = |line| mean_around(&sums, line).max(noise[line]);
    (0..noise.len()).map(value).collect()
}

/// Sums of the first 0, 1, 2, ... values.
fn running_sums(values: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; values.len() + 1];
    for (k, value) in values.iter().enumerate() {
        sums[k + 1] = sums[k] + value;
    }
    sums
}

/// Mean of the neighbours of a line, from running sums.
fn mean_around(sums: &[f64], line: usize) -> f64 {
    let first = line.saturating_sub(SMOOTHED);
    let end = (line + SMOOTHED + 1).min(sums.len() - 1);
    (sums[end] - sums[first]) / (end - first) as f64
}
