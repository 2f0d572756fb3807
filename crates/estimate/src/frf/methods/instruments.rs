//! Estimates by instruments: signals Z that noise does, or does not, meet.
//!
//! ```text
//! G = (sum Y Z^H) (sum U Z^H)^-1
//! ```
//!
//! summed over experiments and periods, and over realizations too. Joint input-output (indirect)
//! takes the known reference, `Z = R`: R^H refers each realization to its own phases, and noise is not
//! correlated with R, so the sums lose it *before* the division; dividing block by block with n_ex = n_u
//! would cancel R and cure nothing. H1 takes `Z = U`, which noise on u biases to 0, H2 `Z = Y`, which
//! noise on y biases away from it.
//!
//! Variance: with the true G in the residuals `E = Y - G U`, the error is exactly
//! `sum_pq E_pq Z_pq^H S^-1`, `S = sum U Z^H`: a sum of independent terms D_pq, one per block. As
//! `T_pq = G + n D_pq` (n the number of blocks) their mean is G and their spread its covariance, by
//! the same formulas as for direct estimates. The spread of FRFs per block would not do: its
//! distribution has no variance when U is noisy. (R. Pintelon, J. Schoukens, System Identification,
//! 2nd ed., ch. 2, 3.)

use std::iter::zip;

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{
    BlockEstimates, BlockMethod, Invertible, LineBlock, map_blocks, means_over_periods,
};
use crate::frf::matrices::Matrix;
use crate::frf::methods::leverage::independent;
use crate::frf::noise_bias::NoiseSeen;
use crate::frf::right_division::right_divide;

/// The signal Z of a block that stands for all that noise should not meet.
pub(crate) trait Instrument: Sync {
    const NEEDS_REFERENCE: bool = false;
    const IS_OUTPUT: bool = false;

    /// Z, where the block has it.
    fn signal(block: &LineBlock) -> Option<&Matrix>;

    /// Share of the response by which noise biases it.
    fn noise_bias(noise: &NoiseSeen) -> f64;
}

/// Joint input-output: through the reference.
pub(crate) struct JointInputOutput;
/// H1: through the input.
pub(crate) struct H1;
/// H2: through the output.
pub(crate) struct H2;

impl Instrument for JointInputOutput {
    const NEEDS_REFERENCE: bool = true;

    fn signal(block: &LineBlock) -> Option<&Matrix> {
        block.r.as_ref()
    }

    /// Divided by the mean over all blocks.
    fn noise_bias(noise: &NoiseSeen) -> f64 {
        noise.bias_of_quotient(noise.n_blocks)
    }
}

impl Instrument for H1 {
    fn signal(block: &LineBlock) -> Option<&Matrix> {
        Some(&block.u)
    }

    /// The power of the noise is in `U U^H`.
    fn noise_bias(noise: &NoiseSeen) -> f64 {
        1.0 / (1.0 + noise.input_snr)
    }
}

impl Instrument for H2 {
    const IS_OUTPUT: bool = true;

    fn signal(block: &LineBlock) -> Option<&Matrix> {
        Some(&block.y)
    }

    /// The power of the noise is in `Y Y^H`.
    fn noise_bias(noise: &NoiseSeen) -> f64 {
        1.0 / noise.output_snr
    }
}

/// The estimate through an instrument.
pub(crate) struct Through<I>(pub(crate) I);

impl<I: Instrument> BlockMethod for Through<I> {
    const NEEDS_REFERENCE: bool = I::NEEDS_REFERENCE;
    const DIVIDES_BY_OUTPUT: bool = I::IS_OUTPUT;
    const DIVIDES_ONCE: bool = true;

    fn noise_bias(&self, noise: &NoiseSeen) -> f64 {
        I::noise_bias(noise)
    }

    /// Block estimates `T_pq = G + n D_pq`.
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let instruments = instruments::<I>(blocks);
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
            realizations: division.independent(blocks, &instruments),
            condition,
        })
    }

    /// `W_p = sum_q Z_pq^H S^-1`.
    fn weights(&self, blocks: &[Vec<LineBlock>]) -> Vec<Matrix> {
        let instruments = instruments::<I>(blocks);
        let s_u = correlation(blocks, &instruments, |block| &block.u);
        let weight = |periods: &Vec<Matrix>| right_divide(&periods.iter().sum(), &s_u);
        instruments.iter().map(weight).collect()
    }
}

/// `Z^H` of every block, each channel scaled to unit power over the campaign: with as many
/// channels as inputs G does not depend on the scale, but the condition number would; with more (H2 of more
/// outputs) they count by their power, whatever their units.
fn instruments<I: Instrument>(blocks: &[Vec<LineBlock>]) -> Vec<Vec<Matrix>> {
    let sizes = sizes::<I>(blocks);
    map_blocks(blocks, |block| scaled_adjoint(I::signal(block), &sizes))
}

/// Root of the power of every channel over the campaign.
fn sizes<I: Instrument>(blocks: &[Vec<LineBlock>]) -> Vec<f64> {
    let signals = || blocks.iter().flatten().filter_map(I::signal);
    let n_channels = signals().next().map_or(0, DMatrix::nrows);
    let power = |channel: usize| -> f64 { signals().map(|z| z.row(channel).norm_squared()).sum() };
    (0..n_channels)
        .map(|channel| power(channel).sqrt())
        .collect()
}

/// G and what it was divided by, `S = sum U Z^H`.
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

    /// Estimates of the realizations whose spread is that of independent errors; `None` for more instruments
    /// than inputs. The noise that meets U has no share in the leverage of the instruments, `H_p = n_q Z^H M^-1 Z`,
    /// `M = sum_p n_q Z Z^H` of their means over periods.
    fn independent(
        &self,
        blocks: &[Vec<LineBlock>],
        instruments: &[Vec<Matrix>],
    ) -> Option<Vec<Matrix>> {
        let sums: Vec<Matrix> = instruments.iter().map(|of| of.iter().sum()).collect();
        let means = zip(&sums, blocks).map(|(sum, of)| sum / Complex64::from(of.len() as f64));
        let means: Vec<Matrix> = means.collect();
        let m: Matrix = zip(&sums, &means).map(|(sum, z)| z.adjoint() * sum).sum();
        if m.nrows() != self.s_u.nrows() {
            return None;
        }
        let leverages = zip(&sums, &means).map(|(sum, z)| right_divide(sum, &m) * z.adjoint());
        let leverages: Vec<Matrix> = leverages.collect();
        let residual = |block: &LineBlock| &block.y - &self.response * &block.u;
        let residuals = means_over_periods(&map_blocks(blocks, residual));
        let weights = sums.iter().map(|sum| right_divide(sum, &self.s_u));
        let weights: Vec<Matrix> = weights.collect();
        Some(independent(
            &self.response,
            &residuals,
            &leverages,
            &weights,
        ))
    }

    fn of_block(&self, block: &LineBlock, instrument: &Matrix, weight: Complex64) -> Matrix {
        let residual = (&block.y - &self.response * &block.u) * instrument * weight;
        &self.response + right_divide(&residual, &self.s_u)
    }
}

/// `sum X Z^H` of a signal over all blocks.
fn correlation(
    blocks: &[Vec<LineBlock>],
    instruments: &[Vec<Matrix>],
    signal: impl Fn(&LineBlock) -> &Matrix,
) -> Matrix {
    zip(blocks.iter().flatten(), instruments.iter().flatten())
        .map(|(block, instrument)| signal(block) * instrument)
        .sum()
}

/// `Z^H`, every channel over its size; empty without Z.
fn scaled_adjoint(z: Option<&Matrix>, sizes: &[f64]) -> Matrix {
    let mut adjoint = z.map(DMatrix::adjoint).unwrap_or_default();
    for (mut column, &size) in zip(adjoint.column_iter_mut(), sizes) {
        if size > 0.0 {
            column /= Complex64::from(size);
        }
    }
    adjoint
}
