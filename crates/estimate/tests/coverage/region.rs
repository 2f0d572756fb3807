//! Shares of truths in the 95 % regions: of single entries, and Hotelling's of the matrix.

use frfid_estimate::FrfEstimate;
use frfid_signals::Uncertainty;
use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::simulated::error;

/// Share in percent of the entries and lines whose region holds the truth.
pub(crate) fn entries(estimate: &FrfEstimate, known: Option<&Uncertainty>) -> f64 {
    let known = known.expect("measured");
    let factor = known.confidence_factor_95();
    let (mut inside, mut all) = (0, 0);
    for line in 0..estimate.frf.n_frequencies() {
        for (entry, error) in error(estimate, line).iter().enumerate() {
            let variance = known.covariance[[line, entry, entry]].re;
            inside += usize::from(error.norm_sqr() <= factor * variance);
            all += 1;
        }
    }
    100.0 * inside as f64 / all as f64
}

/// The same of the lines whose region of all entries together holds the truth: with k entries and nu
/// complex degrees of freedom `T^2 <= k nu / (nu - k + 1) F95(2 k, 2 (nu - k + 1))`.
pub(crate) fn matrices(estimate: &FrfEstimate, known: Option<&Uncertainty>) -> f64 {
    let known = known.expect("measured");
    let n_lines = estimate.frf.n_frequencies();
    let inside = (0..n_lines).filter(|&line| holds_matrix(estimate, known, line));
    100.0 * inside.count() as f64 / n_lines as f64
}

fn holds_matrix(estimate: &FrfEstimate, known: &Uncertainty, line: usize) -> bool {
    let error = error(estimate, line);
    let k = error.len();
    let covariance = DMatrix::from_fn(k, k, |a, b| known.covariance[[line, a, b]]);
    let solved = covariance.lu().solve(&error).expect("regular");
    let square: Complex64 = error.dotc(&solved);
    let nu = known.degrees_of_freedom;
    let rest = nu - k as f64 + 1.0;
    f_tail(square.re * rest / (k as f64 * nu), k, rest) > 0.05
}

/// Probability that an F variable with 2 a and 2 b degrees of freedom exceeds a ratio: a sum of beta
/// terms (Abramowitz, Stegun 26.6.2), written anew.
fn f_tail(ratio: f64, a: usize, b: f64) -> f64 {
    let x = b / (b + a as f64 * ratio);
    let (mut term, mut sum) = (x.powf(b), 0.0);
    for i in 0..a {
        sum += term;
        term *= (b + i as f64) / (i as f64 + 1.0) * (1.0 - x);
    }
    sum
}
