//! Fit of the rows of a local model: their response to every drive, what that is made of, and the noise.
//!
//! The equations are linear in their unknowns, their errors the noise times the denominator A of the row. A first
//! fit gives every row's A; a second one, with the equations over what all |A| are in the mean, weighs noise as it
//! is (one step of Sanathanan and Koerner: more of them let A follow the noise). Errors of the unknowns are then
//! linear in the noise V, `dtheta = X^+ diag(W A) V` with the weights W, which holds wherever the poles are.

use std::iter::zip;

use num_complex::Complex64;

use crate::frf::local::least_squares::{Basis, System, over};
use crate::frf::local::window::{N_TERMS, Signal, Window, times_power};

/// A weight is at most this times the smallest.
const MOST_WEIGHT: f64 = 1e6;

/// The fit of one answer.
pub(super) struct RowFit {
    /// Response to each drive.
    pub(super) response: Vec<Complex64>,
    /// For each drive the factors of the answer's noise, line by line, in the error of the response.
    pub(super) factors: Vec<Signal>,
    /// The noise of the answer on each line.
    pub(super) noise: Signal,
    /// The same times the denominator: even where the noise has passed through the plant.
    pub(super) equation_error: Signal,
}

/// The fits of all answers of a window.
pub(super) fn fit_rows(window: &Window) -> Vec<RowFit> {
    let common = common_columns(window);
    let unweighted = Basis::of(common.iter().cloned());
    let denominator_of = |answer: &Signal| {
        let own = denominator_columns(window, answer);
        denominator(&System::of(&unweighted, own, answer.clone()), window)
    };
    let denominators: Vec<Signal> = window.answers.iter().map(denominator_of).collect();
    let weights = weights(&denominators);
    let weighted = Basis::of(common.iter().map(|column| times(column, &weights)));
    let answers = window.answers.iter();
    answers
        .map(|answer| RowFit::of(window, &weighted, &weights, answer))
        .collect()
}

/// Columns that all rows of a window have in common: drives, then transients, times powers of the place.
fn common_columns(window: &Window) -> Vec<Signal> {
    let powers = |signal: &Signal| {
        let power = |power| times_power(signal, &window.places, power);
        (0..N_TERMS).map(power).collect::<Vec<_>>()
    };
    let drives = window.drives.iter().flat_map(powers);
    let transients = window.pieces.iter().flat_map(|piece| {
        let is_of = |line: usize| Complex64::from(f64::from(u8::from(piece.contains(&line))));
        powers(&(0..window.places.len()).map(is_of).collect())
    });
    drives.chain(transients).collect()
}

/// Columns of the denominator's unknowns.
fn denominator_columns(window: &Window, answer: &Signal) -> Vec<Signal> {
    let columns = (1..=window.n_poles).map(|power| times_power(answer, &window.places, power));
    columns.map(negative).collect()
}

impl RowFit {
    /// The fit of an answer with equations that are weighted.
    fn of(window: &Window, common: &Basis, weights: &[f64], answer: &Signal) -> Self {
        let own = denominator_columns(window, answer).into_iter();
        let own = own.map(|column| times(&column, weights));
        let fit = System::of(common, own, times(answer, weights));
        let a = denominator(&fit, window);
        let factors = |drive: usize| {
            let factors = fit.functional(N_TERMS * drive);
            let of_noise = zip(factors, zip(weights, &a));
            of_noise
                .map(|(factor, (weight, a))| factor * weight * a)
                .collect()
        };
        let (unknowns, drives) = (fit.unknowns(), 0..window.drives.len());
        let equation_error: Signal = zip(&fit.residual, weights)
            .map(|(rest, weight)| rest / weight)
            .collect();
        Self {
            response: drives
                .clone()
                .map(|drive| unknowns[N_TERMS * drive])
                .collect(),
            factors: drives.map(factors).collect(),
            noise: zip(&equation_error, &a)
                .map(|(error, a)| over(*error, *a))
                .collect(),
            equation_error,
        }
    }
}

/// The denominator on every line, from the last unknowns.
fn denominator(fit: &System, window: &Window) -> Signal {
    let unknowns = fit.unknowns();
    let last = &unknowns[unknowns.len() - window.n_poles..];
    let at = |x: &f64| {
        let powers = last.iter().rev();
        Complex64::ONE + powers.fold(Complex64::ZERO, |sum, a| (sum + a) * x)
    };
    window.places.iter().map(at).collect()
}

/// One over what the sizes of the denominators are in the mean, geometrically; even where that is not finite.
fn weights(denominators: &[Signal]) -> Vec<f64> {
    let n_lines = denominators.first().map_or(0, Vec::len);
    let log_size = |line: usize| -> f64 { denominators.iter().map(|a| a[line].norm().ln()).sum() };
    let size = |line: usize| (log_size(line) / denominators.len() as f64).exp();
    let sizes: Vec<f64> = (0..n_lines).map(size).collect();
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        return vec![1.0; n_lines];
    }
    let weight = |size: f64| size.max(largest / MOST_WEIGHT).recip();
    sizes.into_iter().map(weight).collect()
}

fn negative(mut signal: Signal) -> Signal {
    signal.iter_mut().for_each(|value| *value = -*value);
    signal
}

fn times(signal: &[Complex64], weights: &[f64]) -> Signal {
    zip(signal, weights)
        .map(|(value, weight)| value * weight)
        .collect()
}
