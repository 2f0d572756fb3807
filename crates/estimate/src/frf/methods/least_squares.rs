//! Least squares over all realizations: one division by the inputs of all of them side by side, so that
//! a realization whose own U is nearly singular costs nothing.
//!
//! ```text
//! G = (sum_p Y_p U_p^H) (sum_p U_p U_p^H)^-1 = sum_p Y_p W_p,   [W_1; W_2; ...] = [U_1 U_2 ...]^+
//! ```
//!
//! with Y_p and U_p averaged over periods. Where phases are independent from experiment to experiment
//! and n_ex = n_u, some U_p always is nearly singular and rules the mean of FRFs; with orthogonal
//! experiments both are the same but for the excitation's strength.
//!
//! Variances: `T_pq = G + n_p (Y_pq - G U_pq) W_p` has the mean G, and about its means over periods
//! the spread of the noise. The residuals `E_p = Y_p - G U_p` are smaller than the errors, most so
//! where a realization has leverage: the spread of realizations is that of
//! `G + (n_p (n_p - 1))^1/2 E_p (I - W_p U_p)^-1/2 W_p`, whose covariance is unbiased where the errors
//! of all experiments are alike. (R. M. Bell, D. F. McCaffrey, Survey Methodology 28 (2002) 169.)

use std::iter::zip;

use nalgebra::{DMatrix, SymmetricEigen};
use num_complex::Complex64;

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{BlockEstimates, BlockMethod, Invertible, LineBlock, mean};
use crate::frf::matrices::Matrix;
use crate::frf::right_division::right_divide;

/// Steps after which eigenvalues that have not converged are given up: three for each are usual, and
/// numbers that are not finite would never end.
const MOST_STEPS: usize = 1000;

pub(crate) struct LeastSquares;

impl BlockMethod for LeastSquares {
    const DIVIDES_ONCE: bool = true;

    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let (u, y) = (
            means(blocks, |block| &block.u),
            means(blocks, |block| &block.y),
        );
        let all = side_by_side(&u);
        let condition = invertible(&all)?;
        let response = right_divide(&side_by_side(&y), &all);
        let weights = self.weights(blocks);
        let of_realization = |(periods, weight): (&Vec<LineBlock>, &Matrix)| {
            let weight = weight * Complex64::from(blocks.len() as f64);
            let of_block =
                |block: &LineBlock| &response + (&block.y - &response * &block.u) * &weight;
            periods.iter().map(of_block).collect()
        };
        Ok(BlockEstimates {
            blocks: zip(blocks, &weights).map(of_realization).collect(),
            realizations: Some(independent(&response, &u, &y, &weights)),
            condition,
        })
    }

    /// Blocks of rows of `[U_1 U_2 ...]^+`.
    fn weights(&self, blocks: &[Vec<LineBlock>]) -> Vec<Matrix> {
        let u = side_by_side(&means(blocks, |block| &block.u));
        let (n_rows, n_columns) = (u.ncols(), u.ncols() / blocks.len());
        let all = right_divide(&DMatrix::identity(n_rows, n_rows), &u);
        let of_realization = |p: usize| all.rows(p * n_columns, n_columns).into_owned();
        (0..blocks.len()).map(of_realization).collect()
    }
}

/// Mean of a signal over the periods of every realization.
fn means(blocks: &[Vec<LineBlock>], signal: fn(&LineBlock) -> &Matrix) -> Vec<Matrix> {
    let of_realization = |periods: &Vec<LineBlock>| mean(periods.iter().map(signal));
    blocks.iter().map(of_realization).collect()
}

/// The experiments of all realizations as columns.
fn side_by_side(matrices: &[Matrix]) -> Matrix {
    let columns: Vec<_> = matrices.iter().flat_map(Matrix::column_iter).collect();
    DMatrix::from_columns(&columns)
}

/// Estimates of the realizations whose spread is that of independent errors.
fn independent(response: &Matrix, u: &[Matrix], y: &[Matrix], weights: &[Matrix]) -> Vec<Matrix> {
    let n_realizations = u.len() as f64;
    let scale = Complex64::from((n_realizations * (n_realizations - 1.0)).sqrt());
    let of_realization = |((u, y), weight): ((&Matrix, &Matrix), &Matrix)| {
        let residual = y - response * u;
        response + residual * without_leverage(weight, u) * weight * scale
    };
    zip(zip(u, y), weights).map(of_realization).collect()
}

/// `(I - W_p U_p)^-1/2`, Hermitian; not finite where a realization alone decides.
fn without_leverage(weight: &Matrix, u: &Matrix) -> Matrix {
    let rest = DMatrix::identity(u.ncols(), u.ncols()) - weight * u;
    let rest = (&rest + rest.adjoint()) / Complex64::from(2.0);
    let unknown = rest.map(|_| Complex64::from(f64::NAN));
    let Some(eigen) = SymmetricEigen::try_new(rest, f64::EPSILON, MOST_STEPS) else {
        return unknown;
    };
    let root = |value: f64| Complex64::from(value.sqrt().recip());
    let roots = DMatrix::from_diagonal(&eigen.eigenvalues.map(root));
    &eigen.eigenvectors * roots * eigen.eigenvectors.adjoint()
}
