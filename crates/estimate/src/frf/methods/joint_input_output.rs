//! Joint input-output (indirect) estimate with a known reference: noise on the measured input does
//! not bias it.
//!
//! `G = (sum Y R^H) (sum U R^H)^-1`, summed over experiments and periods, and over realizations
//! too, since R^H refers each to its own phases. Noise is not correlated with R, so the sums lose
//! it *before* the division; dividing block by block with n_ex = n_u would cancel R and cure
//! nothing.
//!
//! Variance: with the true G in the residuals `E = Y - G U`, the error is exactly
//! `sum_pq E_pq R_pq^H S^-1`, `S = sum U R^H`: a sum of independent terms D_pq, one per block. As
//! `T_pq = G + n D_pq` (n the number of blocks) their mean is G and their spread its covariance, by
//! the same formulas as for direct estimates. The spread of FRFs per block would not do: its
//! distribution has no variance when U is noisy. (R. Pintelon, J. Schoukens, System Identification,
//! 2nd ed., ch. 2, 3.)

use std::iter::zip;

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{BlockEstimates, BlockMethod, Invertible, LineBlock, map_blocks};
use crate::frf::matrices::Matrix;
use crate::frf::right_division::right_divide;

pub(crate) struct JointInputOutput;

impl BlockMethod for JointInputOutput {
    const NEEDS_REFERENCE: bool = true;
    const DIVIDES_ONCE: bool = true;

    /// Block estimates `T_pq = G + n D_pq`.
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let instruments = instruments(blocks);
        let s_u = correlation(blocks, &instruments, |block| &block.u);
        let s_y = correlation(blocks, &instruments, |block| &block.y);
        let condition = invertible(&s_u)?;
        let response = right_divide(&s_y, &s_u);
        let division = Division { response, s_u };
        let realizations = zip(blocks, &instruments);
        let of_realization = |(periods, instruments): (&Vec<LineBlock>, &Vec<Matrix>)| {
            division.of_realization(periods, instruments, blocks.len())
        };
        Ok(BlockEstimates {
            blocks: realizations.map(of_realization).collect(),
            realizations: None,
            condition,
        })
    }

    /// `W_p = sum_q R_pq^H S^-1`.
    fn weights(&self, blocks: &[Vec<LineBlock>]) -> Vec<Matrix> {
        let instruments = instruments(blocks);
        let s_u = correlation(blocks, &instruments, |block| &block.u);
        let weight = |periods: &Vec<Matrix>| right_divide(&periods.iter().sum(), &s_u);
        instruments.iter().map(weight).collect()
    }
}

/// G and what it was divided by, `S = sum U R^H`.
struct Division {
    response: Matrix,
    s_u: Matrix,
}

impl Division {
    /// Estimates of the periods of one of `n_realizations`.
    fn of_realization(
        &self,
        periods: &[LineBlock],
        instruments: &[Matrix],
        n_realizations: usize,
    ) -> Vec<Matrix> {
        // mean over periods, then realizations: with unequal numbers of periods each block weighs
        // n_p n_q of its own
        let weight = Complex64::from((periods.len() * n_realizations) as f64);
        let blocks = zip(periods, instruments);
        blocks
            .map(|(block, instrument)| self.of_block(block, instrument, weight))
            .collect()
    }

    fn of_block(&self, block: &LineBlock, instrument: &Matrix, weight: Complex64) -> Matrix {
        let residual = (&block.y - &self.response * &block.u) * instrument * weight;
        &self.response + right_divide(&residual, &self.s_u)
    }
}

/// `sum X R^H` of a signal over all blocks.
fn correlation(
    blocks: &[Vec<LineBlock>],
    instruments: &[Vec<Matrix>],
    signal: impl Fn(&LineBlock) -> &Matrix,
) -> Matrix {
    zip(blocks.iter().flatten(), instruments.iter().flatten())
        .map(|(block, instrument)| signal(block) * instrument)
        .sum()
}

/// `R^H` of every block, each reference channel scaled to unit power over the campaign: G does not
/// depend on the scale, but the condition number would.
fn instruments(blocks: &[Vec<LineBlock>]) -> Vec<Vec<Matrix>> {
    let sizes = reference_sizes(blocks);
    map_blocks(blocks, |block| scaled_adjoint(block.r.as_ref(), &sizes))
}

/// Root of the power of every reference channel over the campaign.
fn reference_sizes(blocks: &[Vec<LineBlock>]) -> Vec<f64> {
    let n_channels = references(blocks).next().map_or(0, DMatrix::nrows);
    let powers = (0..n_channels).map(|channel| reference_power(blocks, channel));
    powers.map(f64::sqrt).collect()
}

fn reference_power(blocks: &[Vec<LineBlock>], channel: usize) -> f64 {
    let powers = references(blocks).map(|r| r.row(channel).norm_squared());
    powers.sum()
}

fn references(blocks: &[Vec<LineBlock>]) -> impl Iterator<Item = &Matrix> {
    let blocks = blocks.iter().flatten();
    blocks.filter_map(|block| block.r.as_ref())
}

/// `R^H`, every channel over its size; empty without R.
fn scaled_adjoint(r: Option<&Matrix>, sizes: &[f64]) -> Matrix {
    let mut adjoint = r.map(DMatrix::adjoint).unwrap_or_default();
    for (mut column, &size) in zip(adjoint.column_iter_mut(), sizes) {
        if size > 0.0 {
            column /= Complex64::from(size);
        }
    }
    adjoint
}
