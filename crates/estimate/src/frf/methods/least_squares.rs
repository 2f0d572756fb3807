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
//! the spread of the noise; that of realizations by [`crate::frf::methods::leverage`], `H_p = W_p U_p`.

use std::iter::zip;

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{BlockEstimates, BlockMethod, Invertible, LineBlock, mean};
use crate::frf::matrices::Matrix;
use crate::frf::methods::leverage::independent;
use crate::frf::noise_bias::NoiseSeen;
use crate::frf::right_division::right_divide;

pub(crate) struct LeastSquares;

impl BlockMethod for LeastSquares {
    const DIVIDES_ONCE: bool = true;

    /// The power of what noise is left by the mean over periods is in `U U^H`.
    fn noise_bias(&self, noise: &NoiseSeen) -> f64 {
        1.0 / (1.0 + noise.n_periods as f64 * noise.input_snr)
    }

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
        let residuals = zip(&u, &y).map(|(u, y)| y - &response * u);
        let residuals: Vec<Matrix> = residuals.collect();
        let leverages = zip(&weights, &u).map(|(weight, u)| weight * u);
        let leverages: Vec<Matrix> = leverages.collect();
        let of_realization = |(periods, weight): (&Vec<LineBlock>, &Matrix)| {
            let weight = weight * Complex64::from(blocks.len() as f64);
            let of_block =
                |block: &LineBlock| &response + (&block.y - &response * &block.u) * &weight;
            periods.iter().map(of_block).collect()
        };
        Ok(BlockEstimates {
            blocks: zip(blocks, &weights).map(of_realization).collect(),
            realizations: Some(independent(&response, &residuals, &leverages, &weights)),
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
