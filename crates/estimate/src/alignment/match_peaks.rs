//! Peaks of the likeness between a recording and a reference over its place.

use frfid_transforms::TransformPlanner;
use ndarray::{Array2, ArrayView1};
use num_complex::Complex64;

/// Likeness below which a place is none.
const LEAST: f64 = 0.3;
/// Power of a window, against the strongest, below which it rests.
const RESTING: f64 = 1e-6;

/// A place where a reference fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MatchPeak {
    /// Bin at which it begins.
    pub(super) bin: usize,
    /// Mean over the channels of the correlation coefficients between window and reference.
    pub(super) likeness: f64,
}

/// The places of a reference without mean, `(channel, bin)`, in a recording: the best of every half of
/// its length.
pub(super) fn match_peaks(recording: &Array2<f64>, reference: &Array2<f64>) -> Vec<MatchPeak> {
    let length = reference.ncols();
    let n_places = (recording.ncols() + 1).saturating_sub(length);
    let moving: Vec<usize> = (0..reference.nrows())
        .filter(|row| power(reference.row(*row)) > 0.0)
        .collect();
    let mut likeness = vec![0.0; n_places];
    for &row in &moving {
        let share = 1.0 / moving.len() as f64;
        let of_row = coefficients(recording.row(row), reference.row(row));
        likeness
            .iter_mut()
            .zip(of_row)
            .for_each(|(sum, one)| *sum += share * one);
    }
    best_of_halves(&likeness, length)
}

fn power(row: ArrayView1<f64>) -> f64 {
    row.dot(&row)
}

/// Correlation coefficient of a channel at every place.
fn coefficients(recording: ArrayView1<f64>, reference: ArrayView1<f64>) -> Vec<f64> {
    let energies = window_energies(recording, reference.len());
    let strongest = energies
        .iter()
        .fold(0.0, |strongest: f64, energy| strongest.max(*energy));
    let own = power(reference);
    let products = products(recording, reference);
    let pairs = products.into_iter().zip(energies);
    let coefficient = |(product, energy): (f64, f64)| {
        product
            / (own * energy.max(RESTING * strongest))
                .sqrt()
                .max(f64::MIN_POSITIVE)
    };
    pairs.map(coefficient).collect()
}

/// Energy about the mean of every window.
fn window_energies(signal: ArrayView1<f64>, length: usize) -> Vec<f64> {
    let mean = signal.mean().unwrap_or(0.0);
    let mut sums = vec![(0.0, 0.0)];
    for value in signal {
        let (sum, square) = sums[sums.len() - 1];
        let value = value - mean;
        sums.push((sum + value, square + value * value));
    }
    let windows = sums.iter().zip(sums.iter().skip(length));
    let energy = |(before, after): (&(f64, f64), &(f64, f64))| {
        let (sum, square) = (after.0 - before.0, after.1 - before.1);
        (square - sum * sum / length as f64).max(0.0)
    };
    windows.map(energy).collect()
}

/// `sum_k recording[place + k] reference[k]` for every place, by transforms.
fn products(recording: ArrayView1<f64>, reference: ArrayView1<f64>) -> Vec<f64> {
    let n = recording.len().next_power_of_two();
    let mut planner = TransformPlanner::default();
    let forward = planner.forward(n);
    let transform = |signal: ArrayView1<f64>| -> Vec<Complex64> {
        let (mut input, mut output) = (forward.make_input_vec(), forward.make_output_vec());
        input
            .iter_mut()
            .zip(signal)
            .for_each(|(input, value)| *input = *value);
        forward
            .process(&mut input, &mut output)
            .expect("buffers come from the plan");
        output
    };
    let mut product = transform(recording);
    let other = transform(reference);
    product
        .iter_mut()
        .zip(&other)
        .for_each(|(a, b)| *a *= b.conj() / n as f64);
    let inverse = planner.inverse(n);
    let mut lags = inverse.make_output_vec();
    // rounding leaves imaginary parts at DC and Nyquist, which have none
    for real in [0, n / 2] {
        product[real].im = 0.0;
    }
    inverse
        .process(&mut product, &mut lags)
        .expect("buffers come from the plan");
    lags.truncate(recording.len() + 1 - reference.len());
    lags
}

/// The best place of every stretch of half a length, where it is better than those around it.
fn best_of_halves(likeness: &[f64], length: usize) -> Vec<MatchPeak> {
    let half = (length / 2).max(1);
    let best = |(stretch, values): (usize, &[f64])| {
        let places = values.iter().enumerate();
        let (place, &likeness) = places.max_by(|a, b| a.1.total_cmp(b.1))?;
        let bin = stretch * half + place;
        (likeness >= LEAST).then_some(MatchPeak { bin, likeness })
    };
    likeness.chunks(half).enumerate().filter_map(best).collect()
}
