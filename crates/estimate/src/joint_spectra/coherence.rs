//! Coherence of an output with all inputs, and where the true one lies.
//!
//! ```text
//! gamma^2 = S_yu S_uu^-1 S_uy / S_yy,   S_ab = sum of A B^H over all experiments, periods and realizations
//! ```
//!
//! the share of the output's power that the inputs explain (multiple coherence; J. S. Bendat, A. G.
//! Piersol, Random Data, 4th ed., section 7.3). With `n` terms of a given input the noise of the output has
//! `b = n - n_u` complex degrees of freedom; the logarithm of `gamma^2/(1 - gamma^2)`, the ratio of signal to
//! noise, then scatters by `psi_1(b) + 2/(n SNR)`, from which the 95 % interval follows. `gamma^2` itself is high
//! by about `n_u (1 - gamma^2)/n`; the interval is not.

use ndarray::Array2;
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::matrices::{Matrix, vector};
use crate::frf::right_division::right_divide;
use crate::spectra::campaign::{Block, Campaign};

/// Standard deviations within which 95 % lie.
const WITHIN: f64 = 1.96;

/// Coherence of every output on every line.
#[derive(Debug, Clone, PartialEq)]
pub struct Coherence {
    /// `gamma^2`, `(line, output)`; 1 where there are no more terms than inputs.
    pub value: Array2<f64>,
    /// Lower end of the 95 % interval; 0 where nothing is known.
    pub low: Array2<f64>,
    /// Upper end; 1 where nothing is known.
    pub high: Array2<f64>,
    /// Terms of each sum.
    pub n_terms: usize,
}

impl Campaign {
    /// The coherence over the runs given so far.
    ///
    /// # Errors
    /// [`EstimateError::Incomplete`], [`EstimateError::TooFewExperiments`].
    pub fn coherence(&self) -> Result<Coherence, EstimateError> {
        let realizations = self.realizations()?;
        let first = realizations[0][0][0];
        let (n_u, n_y, n_lines) = (first.u.nrows(), first.y.nrows(), first.u.ncols());
        let n_terms: usize = realizations.iter().flatten().map(Vec::len).sum();
        let empty = || Array2::zeros((n_lines, n_y));
        let mut found = Coherence {
            value: empty(),
            low: empty(),
            high: empty(),
            n_terms,
        };
        for line in 0..n_lines {
            for (output, value) in coherences(&realizations, line).into_iter().enumerate() {
                let [low, high] = interval(value, n_terms, n_u);
                found.value[[line, output]] = value;
                found.low[[line, output]] = low;
                found.high[[line, output]] = high;
            }
        }
        Ok(found)
    }
}

/// `gamma^2` of every output on a line.
fn coherences(realizations: &[Vec<Block>], line: usize) -> Vec<f64> {
    let runs = || realizations.iter().flatten().flatten();
    let u = Matrix::from_columns(
        &runs()
            .map(|run| vector(run.u.column(line)))
            .collect::<Vec<_>>(),
    );
    let y = Matrix::from_columns(
        &runs()
            .map(|run| vector(run.y.column(line)))
            .collect::<Vec<_>>(),
    );
    let explained = right_divide(&y, &u) * &u;
    let share = |output: usize| {
        let power = |signal: &Matrix| signal.row(output).map(|x: Complex64| x.norm_sqr()).sum();
        power(&explained) / power(&y)
    };
    (0..y.nrows()).map(share).collect()
}

/// The 95 % interval of the true value.
fn interval(value: f64, n_terms: usize, n_inputs: usize) -> [f64; 2] {
    let Some(b) = n_terms.checked_sub(n_inputs).filter(|&b| b > 0) else {
        return [0.0, 1.0];
    };
    let (n, n_u, b) = (n_terms as f64, n_inputs as f64, b as f64);
    // power of the signal over that of the noise, the noise in the explained part taken off
    let snr = (value / (1.0 - value) * b - n_u) / n;
    if snr.is_nan() || snr <= 0.0 {
        return [0.0, upper_of_none(n, n_u, b)];
    }
    let deviation = (trigamma(b) + 2.0 / (n * snr)).sqrt();
    // the logarithm of the noise's power is low by 1/(2b) on average
    let middle = snr.ln() - 0.5 / b;
    [-WITHIN, WITHIN].map(|times| {
        let snr = (middle + times * deviation).exp();
        if snr.is_finite() {
            snr / (1.0 + snr)
        } else {
            1.0
        }
    })
}

/// What the true coherence hardly exceeds where none is seen.
fn upper_of_none(n: f64, n_u: f64, b: f64) -> f64 {
    let snr = (n_u + 2.0 * WITHIN * n_u.sqrt() + WITHIN) / n * (1.0 + WITHIN * trigamma(b).sqrt());
    snr / (1.0 + snr)
}

/// `psi_1(b)`, the variance of the logarithm of a Gamma(b) number, by its asymptotic series after eight
/// steps of `psi_1(b) = psi_1(b + 1) + 1/b^2` (Abramowitz, Stegun, 6.4.6 and 6.4.12).
fn trigamma(b: f64) -> f64 {
    let steps: f64 = (0..8).map(|k| (b + f64::from(k)).powi(-2)).sum();
    let x = b + 8.0;
    steps + 1.0 / x + 0.5 / x.powi(2) + 1.0 / (6.0 * x.powi(3)) - 1.0 / (30.0 * x.powi(5))
}
