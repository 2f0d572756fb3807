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
//! W_p is what the method multiplies the outputs of realization p by; with random phases |w|^2 falls
//! with n_p, with n_q it does not: the noise of n_q repetitions, over n_q, comes with n_q/n_g times as
//! much from the glides. C is the covariance of one glide's error, from the spread of the glides about
//! their mean; with one glide from that of the repetitions, on the assumption that a run without
//! excitation is as noisy as one with it.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use crate::frf::blocks::{LineBlock, mean};
use crate::frf::matrices::{Matrix, vector};
use crate::spectra::campaign::RunSpectra;

/// The glides on one line.
pub(crate) struct GlideNoise {
    u: Vec<DVector<Complex64>>,
    y: Vec<DVector<Complex64>>,
}

impl GlideNoise {
    pub(crate) fn of(glides: &[RunSpectra], line: usize) -> Self {
        Self {
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

    /// `C / n_g`, `(output, output)`; `None` without glides, or with one and no repetitions.
    pub(crate) fn covariance(
        &self,
        response: &Matrix,
        blocks: &[Vec<LineBlock>],
    ) -> Option<Matrix> {
        let n_glides = self.y.len();
        let of_one = match n_glides {
            0 => return None,
            1 => covariance_of_runs(response, blocks)?,
            _ => covariance(&[self.errors(response)], n_glides - 1),
        };
        Some(of_one / Complex64::from(n_glides as f64))
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

/// Covariance of vec(G) where outputs are off by the same error of this covariance in all runs.
pub(crate) fn common_covariance(weights: &[Matrix], on_outputs: &Matrix) -> Matrix {
    let weight: Matrix = weights.iter().sum();
    let w = weight.row_sum().transpose();
    (&w * w.adjoint()).kronecker(on_outputs)
}
