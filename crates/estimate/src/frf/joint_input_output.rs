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

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::error::DeficientLine;
use crate::frf::blocks::{BlockEstimates, BlockMethod, Invertible, LineBlock};
use crate::frf::right_division::right_divide;

pub(crate) struct JointInputOutput;

impl BlockMethod for JointInputOutput {
    const NEEDS_REFERENCE: bool = true;

    /// Block estimates `T_pq = G + n D_pq`.
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let instruments = instruments(blocks);
        let correlate = |signal: &dyn Fn(&LineBlock) -> &'_ DMatrix<Complex64>| {
            let terms = blocks.iter().flatten().zip(instruments.iter().flatten());
            terms
                .map(|(block, instrument)| signal(block) * instrument)
                .sum::<DMatrix<Complex64>>()
        };
        let (s_u, s_y) = (correlate(&|block| &block.u), correlate(&|block| &block.y));
        let condition = invertible(&s_u)?;
        let response = right_divide(&s_y, &s_u);
        let contribution = |block: &LineBlock, instrument: &DMatrix<Complex64>, count: usize| {
            let residual =
                (&block.y - &response * &block.u) * instrument * Complex64::from(count as f64);
            &response + right_divide(&residual, &s_u)
        };
        let estimates = blocks
            .iter()
            .zip(&instruments)
            .map(|(periods, instruments)| {
                // mean over periods, then realizations: with unequal numbers of periods each block
                // weighs n_p n_q of its own
                let count = periods.len() * blocks.len();
                periods
                    .iter()
                    .zip(instruments)
                    .map(|(block, instrument)| contribution(block, instrument, count))
                    .collect()
            });
        Ok(BlockEstimates {
            blocks: estimates.collect(),
            condition,
        })
    }
}

/// `R^H` of every block, each reference channel scaled to unit power over the campaign: G does not
/// depend on the scale, but the condition number would.
fn instruments(blocks: &[Vec<LineBlock>]) -> Vec<Vec<DMatrix<Complex64>>> {
    let references = || blocks.iter().flatten().filter_map(|block| block.r.as_ref());
    let channels = references().next().map_or(0, DMatrix::nrows);
    let power = |channel: usize| {
        references()
            .map(|r| r.row(channel).norm_squared())
            .sum::<f64>()
    };
    let scale: Vec<f64> = (0..channels).map(|channel| power(channel).sqrt()).collect();
    let instrument = |block: &LineBlock| {
        let mut adjoint = block
            .r
            .as_ref()
            .map_or_else(|| DMatrix::zeros(0, 0), DMatrix::adjoint);
        for (mut column, &scale) in adjoint.column_iter_mut().zip(&scale) {
            if scale > 0.0 {
                column /= Complex64::from(scale);
            }
        }
        adjoint
    };
    blocks
        .iter()
        .map(|periods| periods.iter().map(instrument).collect())
        .collect()
}
