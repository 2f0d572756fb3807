//! Fit of one row of a local model: its response to every drive, what that is made of, and the noise.
//!
//! The equation is linear in its unknowns, its error the noise times the denominator A. A first fit gives A, a
//! second one with the equations over |A| weighs noise as it is (one step of Sanathanan and Koerner: more of
//! them let A follow the noise). Errors of the unknowns are then linear in the noise V,
//! `dtheta = X^+ diag(A / |A_1|) V`, which holds wherever the poles are.

use std::iter::zip;

use num_complex::Complex64;

use crate::frf::local::least_squares::Orthogonal;
use crate::frf::local::window::{N_TERMS, ORDER, Signal, Window, times_power};

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

/// Columns that all rows of a window have in common: drives, then transients, times powers of the place.
pub(super) fn common_columns(window: &Window) -> Vec<Signal> {
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

impl RowFit {
    /// The fit of an answer.
    pub(super) fn of(window: &Window, common: &[Signal], answer: &Signal) -> Self {
        let denominators = (1..=ORDER).map(|power| times_power(answer, &window.places, power));
        let denominators: Vec<Signal> = denominators.map(negative).collect();
        let columns = || common.iter().chain(&denominators);
        let even = vec![1.0; answer.len()];
        let first = Orthogonal::of(columns().cloned().collect(), answer.clone());
        let weights = weights(&denominator(&first, &window.places), even);
        let weighted = columns().map(|column| times(column, &weights)).collect();
        let fit = Orthogonal::of(weighted, times(answer, &weights));
        let a = denominator(&fit, &window.places);
        let error_of = |line: usize| fit.residual[line] / weights[line];
        let equation_error: Signal = (0..answer.len()).map(error_of).collect();
        let noise = zip(&equation_error, &a).map(|(error, a)| over(*error, *a));
        let factors = |drive: usize| {
            let factors = fit.functional(N_TERMS * drive);
            let of_noise = zip(factors, zip(&weights, &a));
            of_noise
                .map(|(factor, (weight, a))| factor * weight * a)
                .collect()
        };
        let unknowns = fit.unknowns();
        let drives = 0..window.drives.len();
        Self {
            response: drives
                .clone()
                .map(|drive| unknowns[N_TERMS * drive])
                .collect(),
            factors: drives.map(factors).collect(),
            noise: noise.collect(),
            equation_error,
        }
    }
}

/// The denominator on every line, from the last unknowns.
fn denominator(fit: &Orthogonal, places: &[f64]) -> Signal {
    let unknowns = fit.unknowns();
    let last = &unknowns[unknowns.len() - ORDER..];
    let at = |x: &f64| {
        Complex64::ONE
            + last
                .iter()
                .rev()
                .fold(Complex64::ZERO, |sum, a| (sum + a) * x)
    };
    places.iter().map(at).collect()
}

/// One over the size of the denominator; `even` where it is not finite.
fn weights(denominator: &[Complex64], even: Vec<f64>) -> Vec<f64> {
    let largest = denominator.iter().map(|a| a.norm()).fold(0.0, f64::max);
    if !(largest > 0.0 && largest.is_finite()) {
        return even;
    }
    let weight = |a: &Complex64| a.norm().max(largest / MOST_WEIGHT).recip();
    denominator.iter().map(weight).collect()
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

/// A quotient; 0 over nothing.
fn over(value: Complex64, divisor: Complex64) -> Complex64 {
    if divisor == Complex64::ZERO {
        Complex64::ZERO
    } else {
        value / divisor
    }
}
