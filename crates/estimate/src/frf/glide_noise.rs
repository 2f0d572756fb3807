//! Noise of the mean glide that was subtracted from every run: the same in all of them, so that no
//! spread over periods shows it.
//!
//! With the error `e = y_g - G u_g` of the mean of n_g glides on a line, each column of Y is off by
//! -e, and the FRF by
//!
//! ```text
//! dG = -e w^T,   w^T = 1^T sum_p W_p,   cov vec(dG) = w w^H (x) C / n_g
//! ```
//!
//! Where the ripple was subtracted by position, each reference meets the noise of the glide at other
//! times. With the coherence c between them, 1 for subtraction in time, it is
//!
//! ```text
//! cov vec(dG) = (c w w^H + (1 - c) sum_p W_p^T W_p^*) (x) C / n_g
//! ```
//!
//! W_p is what the method multiplies the outputs of realization p by; with random phases |w|^2 falls
//! with n_p, with n_q it does not: the noise of n_q repetitions, over n_q, comes with n_q/n_g times as
//! much from the glides. C is the covariance of one glide's error, from the spread of the glides about
//! their mean; with one glide from that of the repetitions, on the assumption that a run without
//! excitation is as noisy as one with it.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use crate::frf::blocks::{LineBlock, mean};
use crate::frf::matrices::{Matrix, vector};
use crate::spectra::campaign::Campaign;

/// The glides on one line.
pub(crate) struct GlideNoise {
    u: Vec<DVector<Complex64>>,
    y: Vec<DVector<Complex64>>,
    coherence: f64,
}

impl GlideNoise {
    pub(crate) fn of(campaign: &Campaign, line: usize) -> Self {
        let glides = &campaign.glides;
        Self {
            coherence: campaign.glide_coherence.get(line).copied().unwrap_or(1.0),
            u: glides
                .iter()
                .map(|glide| vector(glide.u.column(line)))
                .collect(),
            y: glides
                .iter()
                .map(|glide| vector(glide.y.column(line)))
                .collect(),
        }
    }

    /// Covariance of vec(G); `None` without glides, or with one and no repetitions.
    pub(crate) fn covariance(
        &self,
        response: &Matrix,
        blocks: &[Vec<LineBlock>],
        weights: &[Matrix],
    ) -> Option<Matrix> {
        let n_glides = self.y.len();
        let of_one = match n_glides {
            0 => return None,
            1 => covariance_of_runs(response, blocks)?,
            _ => covariance(&[self.errors(response)], n_glides - 1),
        };
        let of_mean = of_one / Complex64::from(n_glides as f64);
        Some(self.geometry(weights).kronecker(&of_mean))
    }

    /// `c w w^H + (1 - c) sum_p W_p^T W_p^*`.
    fn geometry(&self, weights: &[Matrix]) -> Matrix {
        let sum: Matrix = weights.iter().sum();
        let w = sum.row_sum().transpose();
        let apart = weights
            .iter()
            .map(|weight| weight.transpose() * weight.conjugate());
        let apart: Matrix = apart.sum();
        &w * w.adjoint() * Complex64::from(self.coherence)
            + apart * Complex64::from(1.0 - self.coherence)
    }

    /// Errors of the glides from their mean, in columns.
    fn errors(&self, response: &Matrix) -> Matrix {
        let [u, y] = [&self.u, &self.y].map(|columns| DMatrix::from_columns(columns));
        let errors = y - response * u;
        let mean = errors.column_mean();
        DMatrix::from_fn(errors.nrows(), errors.ncols(), |output, glide| {
            errors[(output, glide)] - mean[output]
        })
    }
}

/// C from the repetitions of runs about their means; `None` without any.
fn covariance_of_runs(response: &Matrix, blocks: &[Vec<LineBlock>]) -> Option<Matrix> {
    let n_experiments = blocks.first()?.first()?.y.ncols();
    let freedom: usize = blocks.iter().map(|periods| periods.len() - 1).sum();
    let errors: Vec<Matrix> = blocks
        .iter()
        .flat_map(|periods| deviations(response, periods))
        .collect();
    (freedom > 0).then(|| covariance(&errors, freedom * n_experiments))
}

/// Errors of the periods of a realization, from their mean.
fn deviations(response: &Matrix, periods: &[LineBlock]) -> Vec<Matrix> {
    let errors: Vec<Matrix> = periods
        .iter()
        .map(|block| &block.y - response * &block.u)
        .collect();
    let mean = mean(&errors);
    errors.iter().map(|error| error - &mean).collect()
}

/// `sum E E^H` over so many degrees of freedom.
fn covariance(errors: &[Matrix], freedom: usize) -> Matrix {
    let squares: Matrix = errors.iter().map(|errors| errors * errors.adjoint()).sum();
    squares / Complex64::from(freedom as f64)
}
