//! Sums of samples against harmonics of their period, at true times: `sum_k x_k e^{-2 pi i h t_k}`.

use std::f64::consts::TAU;
use std::iter::zip;

use num_complex::Complex64;
use rayon::prelude::*;

/// Harmonics that one rotation after the other reaches before the angles are computed anew: each
/// rotation costs a unit of rounding, so that 32 of them stay within 1e-14.
const RESTART: usize = 32;
/// Samples at a time: their rotations fit into the fastest memory.
const CHUNK: usize = 512;

/// Sums for h = 0 to `highest` of each signal, whose samples belong to `cycles`, times in periods:
/// `(harmonic, signal)`.
pub(super) fn harmonic_sums(
    cycles: &[f64],
    signals: &[Vec<f64>],
    highest: usize,
) -> Vec<Vec<Complex64>> {
    let starts: Vec<usize> = (0..=highest).step_by(RESTART).collect();
    let block = |&start: &usize| {
        let n_harmonics = RESTART.min(highest + 1 - start);
        sums_from(start, n_harmonics, cycles, signals)
    };
    starts.par_iter().flat_map_iter(block).collect()
}

/// The sums of so many harmonics from `start` on.
fn sums_from(
    start: usize,
    n_harmonics: usize,
    cycles: &[f64],
    signals: &[Vec<f64>],
) -> Vec<Vec<Complex64>> {
    let mut sums = vec![vec![Complex64::ZERO; signals.len()]; n_harmonics];
    for (chunk, cycles) in cycles.chunks(CHUNK).enumerate() {
        let first = chunk * CHUNK;
        let values = signals.iter().map(|x| &x[first..first + cycles.len()]);
        add_block(cycles, &values.collect::<Vec<_>>(), start, &mut sums);
    }
    sums
}

/// Adds the samples of a chunk to the sums of the harmonics from `start` on.
fn add_block(cycles: &[f64], values: &[&[f64]], start: usize, sums: &mut [Vec<Complex64>]) {
    let mut turns = Turns::of(cycles, start);
    let step = Turns::of(cycles, 1);
    for sums in sums {
        for (sum, values) in zip(sums, values) {
            *sum += Complex64::new(dot(values, &turns.re), dot(values, &turns.im));
        }
        turns.advance(&step);
    }
}

/// `e^{-2 pi i h t}` of every sample, parts side by side.
struct Turns {
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Turns {
    fn of(cycles: &[f64], harmonic: usize) -> Self {
        let turns = cycles.iter().map(|&cycle| turn(harmonic, cycle));
        let (re, im) = turns.map(|turn| (turn.re, turn.im)).unzip();
        Self { re, im }
    }

    /// Turns on by a step.
    fn advance(&mut self, step: &Self) {
        for k in 0..self.re.len() {
            let (re, im) = (self.re[k], self.im[k]);
            self.re[k] = re * step.re[k] - im * step.im[k];
            self.im[k] = re * step.im[k] + im * step.re[k];
        }
    }
}

/// `e^{-2 pi i h t}`, the whole turns taken off before they cost digits.
fn turn(harmonic: usize, cycle: f64) -> Complex64 {
    let (harmonic, fraction) = (harmonic as f64, cycle.rem_euclid(1.0));
    let product = harmonic * fraction;
    let lost = harmonic.mul_add(fraction, -product);
    Complex64::cis(-TAU * (product.fract() + lost))
}

/// Sum of products, four sums side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a, b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = zip(a.remainder(), b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in zip(a, b) {
        zip(&mut sums, zip(a, b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum::<f64>() + rest
}
