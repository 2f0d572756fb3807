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
        let mut sums = vec![vec![Complex64::ZERO; signals.len()]; n_harmonics];
        for first in (0..cycles.len()).step_by(CHUNK) {
            let samples = first..cycles.len().min(first + CHUNK);
            let values: Vec<&[f64]> = (signals.iter())
                .map(|signal| &signal[samples.clone()])
                .collect();
            add_block(&cycles[samples], &values, start, &mut sums);
        }
        sums
    };
    starts.par_iter().flat_map_iter(block).collect()
}

/// Adds the samples of a chunk to the sums of the harmonics from `start` on.
fn add_block(cycles: &[f64], values: &[&[f64]], start: usize, sums: &mut [Vec<Complex64>]) {
    let turned = |harmonic: usize| -> (Vec<f64>, Vec<f64>) {
        let turns = cycles.iter().map(|&cycle| turn(harmonic, cycle));
        turns.map(|turn| (turn.re, turn.im)).unzip()
    };
    let ((mut re, mut im), (step_re, step_im)) = (turned(start), turned(1));
    for sums in sums {
        for (sum, values) in zip(sums, values) {
            *sum += Complex64::new(dot(values, &re), dot(values, &im));
        }
        for k in 0..re.len() {
            let before = re[k];
            re[k] = before * step_re[k] - im[k] * step_im[k];
            im[k] = before * step_im[k] + im[k] * step_re[k];
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
        for (sum, (a, b)) in zip(&mut sums, zip(a, b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}
