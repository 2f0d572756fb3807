//! Leverage of a realization: by how much an estimate follows it, and its residuals are too small.
//!
//! With weights W_p an estimate is `G = sum_p Y_p W_p`, and the residuals `E_p = Y_p - G U_p` are those of the
//! errors times `I - H_p` and what the other realizations add, smallest where a realization has leverage H_p, Hermitian. The spread of
//! realizations is that of
//!
//! ```text
//! G + (n_p (n_p - 1))^1/2 E_p (I - H_p)^-1/2 W_p
//! ```
//!
//! whose covariance is unbiased where the errors of all experiments are alike. (R. M. Bell, D. F. McCaffrey, Survey
//! Methodology 28 (2002) 169.)

use std::iter::zip;

use nalgebra::{DMatrix, SymmetricEigen};
use num_complex::Complex64;

use crate::frf::matrices::Matrix;

/// Steps after which eigenvalues that have not converged are given up: three for each are usual, and
/// numbers that are not finite would never end.
const MOST_STEPS: usize = 1000;

/// Estimates of the realizations whose spread is that of independent errors.
pub(super) fn independent(
    response: &Matrix,
    residuals: &[Matrix],
    leverages: &[Matrix],
    weights: &[Matrix],
) -> Vec<Matrix> {
    let n_realizations = residuals.len() as f64;
    let scale = Complex64::from((n_realizations * (n_realizations - 1.0)).sqrt());
    let of_realization = |((residual, leverage), weight): ((&Matrix, &Matrix), &Matrix)| {
        response + residual * without(leverage) * weight * scale
    };
    zip(zip(residuals, leverages), weights)
        .map(of_realization)
        .collect()
}

/// `(I - H)^-1/2`, Hermitian; not finite where a realization alone decides.
fn without(leverage: &Matrix) -> Matrix {
    let rest = DMatrix::identity(leverage.nrows(), leverage.ncols()) - leverage;
    let rest = (&rest + rest.adjoint()) / Complex64::from(2.0);
    let unknown = rest.map(|_| Complex64::from(f64::NAN));
    let Some(eigen) = SymmetricEigen::try_new(rest, f64::EPSILON, MOST_STEPS) else {
        return unknown;
    };
    let root = |value: f64| Complex64::from(value.sqrt().recip());
    let roots = DMatrix::from_diagonal(&eigen.eigenvalues.map(root));
    &eigen.eigenvectors * roots * eigen.eigenvectors.adjoint()
}
