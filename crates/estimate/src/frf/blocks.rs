//! Blocks of a campaign and their means: what every method that works line by line has in common.
//!
//! A method makes an estimate T_pq of each block, the experiments of period q of realization p. Their
//! mean is the FRF, their spread its variances:
//!
//! ```text
//! G = 1/n_p sum_p G_p,   G_p = 1/n_q sum_q T_pq
//! noise covariance = 1/n_p^2 sum_p [ sum_q d_pq d_pq^H / (n_q (n_q - 1)) ],   d_pq = vec(T_pq - G_p)
//! total covariance = sum_p d_p d_p^H / (n_p (n_p - 1)),                       d_p  = vec(G_p - G)
//! ```
//!
//! Both are covariances *of the averaged* G (SK15 (13) and (14)). With one run the estimate is the
//! direct FRF (7). Source of the variances: R. Pintelon, J. Schoukens, System Identification, 2nd
//! ed., ch. 3 and 4.

use nalgebra::{DMatrix, DVector};
use ndarray::Array2;
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::EstimateError;
use crate::error::deficient_line::DeficientLine;
use crate::frf::excitation::Excitation;
use crate::frf::freedom::Freedom;
use crate::frf::glide_noise::GlideNoise;
use crate::frf::line_estimate::{LineEstimate, LineResult, assemble, left_out, with_gaps};
use crate::frf::matrices::{Matrix, room_for_covariances};
use crate::frf::noise_bias::{NoiseSeen, noise_bias};
use crate::frf::right_division::{check_excited, check_rank, right_divide};
use crate::frf::{FrfEstimate, FrfMethod, FrfOptions};
use crate::spectra::campaign::{Block, Campaign};

/// A method that works line by line, from the spectra of all blocks to an estimate of each.
pub(crate) trait BlockMethod: Sync {
    /// Whether the blocks must hold the reference.
    const NEEDS_REFERENCE: bool = false;
    /// Whether noise on the output biases it.
    const DIVIDES_BY_OUTPUT: bool = false;
    /// Whether all realizations are divided by one matrix, so that none outweighs the others by being
    /// conditioned badly.
    const DIVIDES_ONCE: bool = false;

    /// Share of the response by which noise on what is divided by biases it.
    fn noise_bias(&self, noise: &NoiseSeen) -> f64;

    /// Estimates of the blocks, `(realization, period)`; `invertible` refuses matrices that cannot be
    /// inverted and returns the condition number of the others.
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine>;

    /// What noise on the outputs of a realization, the same in all its periods, is multiplied by in
    /// the FRF, `(experiment, input)`: `dG = sum_p E_p W_p` to first order. Here `W_p = U_p^+ / n_p`.
    fn weights(&self, blocks: &[Vec<LineBlock>]) -> Vec<Matrix> {
        let n_realizations = Complex64::from(blocks.len() as f64);
        let weight = |periods: &Vec<LineBlock>| {
            let u = mean(periods.iter().map(|block| &block.u));
            let n_experiments = u.ncols();
            right_divide(&DMatrix::identity(n_experiments, n_experiments), &u) / n_realizations
        };
        blocks.iter().map(weight).collect()
    }
}

/// The condition number of a matrix, or why it cannot be inverted.
pub(crate) type Invertible<'a> = dyn Fn(&Matrix) -> Result<f64, DeficientLine> + 'a;

impl<M: BlockMethod> FrfMethod for M {
    fn needs_reference(&self) -> bool {
        M::NEEDS_REFERENCE
    }

    fn frf(&self, campaign: &Campaign, options: &FrfOptions) -> Result<FrfEstimate, EstimateError> {
        let blocks = Blocks::of::<M>(campaign, options.max_condition)?;
        let hz = campaign.frequency_hz();
        let lines = hz.par_iter().enumerate();
        let lines: Vec<LineResult> = lines
            .map(|(line, &hz)| blocks.estimate(self, line, hz))
            .collect();
        let left_out: Vec<DeficientLine> = left_out(&lines).collect();
        let Some(lines) = with_gaps(lines) else {
            return Err(EstimateError::RankDeficient(left_out));
        };
        let freedom = Freedom::of(&lines, &blocks.n_periods(), campaign.glides.len());
        let frf = assemble(hz, &lines, &freedom);
        let bias = |noise: &NoiseSeen| self.noise_bias(noise);
        Ok(FrfEstimate {
            noise_bias: noise_bias(&frf, &blocks.excitation, &blocks.realizations, bias),
            frf,
            left_out,
            input_snr_db: blocks.excitation.snr_db(),
            direct_difference: None,
            equal_draws: Vec::new(),
            evenness: (!M::DIVIDES_ONCE).then_some(freedom.evenness),
        })
    }
}

/// The blocks of a campaign, and what decides whether a line of them can be used.
struct Blocks<'a> {
    realizations: Vec<Vec<Block<'a>>>,
    campaign: &'a Campaign,
    excitation: Excitation,
    max_condition: f64,
}

impl<'a> Blocks<'a> {
    fn of<M: BlockMethod>(
        campaign: &'a Campaign,
        max_condition: f64,
    ) -> Result<Self, EstimateError> {
        let realizations = campaign.realizations()?;
        let n_lines = campaign.frequency_hz().len();
        if let Some(run) = realizations.iter().flatten().flatten().next() {
            room_for_covariances(n_lines, run.y.nrows(), run.u.nrows())?;
        }
        Ok(Self {
            excitation: Excitation::of(&realizations, M::NEEDS_REFERENCE, M::DIVIDES_BY_OUTPUT),
            realizations,
            campaign,
            max_condition,
        })
    }

    /// The FRF on one line.
    fn estimate(&self, method: &impl BlockMethod, line: usize, hz: f64) -> LineResult {
        check_excited(self.excitation.deficiency(line), self.max_condition, hz)?;
        let invertible = |u: &Matrix| check_rank(u, self.max_condition, hz);
        let blocks = map_blocks(&self.realizations, |block| LineBlock::of(block, line));
        let estimates = method.estimates(&blocks, &invertible)?;
        let known = with_covariances(&estimates);
        let weights = method.weights(&blocks);
        let glides = GlideNoise::of(self.campaign, line);
        let of_glides = glides.covariance(&known.response, &blocks, &weights);
        Ok(known.with_parts(&weights, &self.n_periods(), of_glides))
    }

    /// Number of periods of every realization.
    fn n_periods(&self) -> Vec<usize> {
        self.realizations.iter().map(Vec::len).collect()
    }
}

/// What follows from each block on its own, `(realization, period)` as the blocks.
pub(crate) fn map_blocks<B, T>(blocks: &[Vec<B>], of_block: impl Fn(&B) -> T) -> Vec<Vec<T>> {
    blocks
        .iter()
        .map(|periods| periods.iter().map(&of_block).collect())
        .collect()
}

/// U, Y and R of one block on one line: channels in rows, experiments in columns.
pub(crate) struct LineBlock {
    pub(crate) u: Matrix,
    pub(crate) y: Matrix,
    pub(crate) r: Option<Matrix>,
}

impl LineBlock {
    fn of(block: &Block, line: usize) -> Self {
        let r: Option<Vec<_>> = block.iter().map(|run| run.r.as_ref()).collect();
        Self {
            u: on_line(line, block.iter().map(|run| &run.u)),
            y: on_line(line, block.iter().map(|run| &run.y)),
            r: r.map(|r| on_line(line, r.into_iter())),
        }
    }
}

/// One line of the spectra of every experiment.
fn on_line<'a>(
    line: usize,
    spectra: impl ExactSizeIterator<Item = &'a Array2<Complex64>> + Clone,
) -> Matrix {
    let n_channels = spectra.clone().next().map_or(0, Array2::nrows);
    let n_experiments = spectra.len();
    let entries = spectra.flat_map(|spectra| spectra.column(line));
    DMatrix::from_iterator(n_channels, n_experiments, entries.copied())
}

/// Estimates of every block, `(realization, period)`, whose mean over periods, then realizations,
/// has the errors of the FRF.
pub(crate) struct BlockEstimates {
    pub(crate) blocks: Vec<Vec<Matrix>>,
    /// Estimates of realizations whose spread about the FRF is that of independent ones, where that
    /// of the means over periods is not.
    pub(crate) realizations: Option<Vec<Matrix>>,
    /// Worst condition number of the matrices inverted.
    pub(crate) condition: f64,
}

/// The means and covariances at the head of this file.
fn with_covariances(estimates: &BlockEstimates) -> LineEstimate {
    let per_realization = means_over_periods(&estimates.blocks);
    let response = mean(&per_realization);
    let independent = estimates.realizations.as_ref().unwrap_or(&per_realization);
    LineEstimate {
        noise: noise_covariance(&estimates.blocks),
        total: covariance_about(&response, independent),
        condition: estimates.condition,
        response,
        noise_parts: None,
    }
}

/// The noise covariance at the head of this file; `None` where a realization has one period.
fn noise_covariance(blocks: &[Vec<Matrix>]) -> Option<Matrix> {
    let of_means = blocks
        .iter()
        .map(|periods| covariance_about(&mean(periods), periods));
    let of_means: Option<Vec<_>> = of_means.collect();
    Some(mean(&of_means?) / Complex64::from(blocks.len() as f64))
}

/// `G_p` of every realization.
pub(crate) fn means_over_periods(blocks: &[Vec<Matrix>]) -> Vec<Matrix> {
    blocks.iter().map(mean).collect()
}

/// Arithmetic mean of at least one matrix.
pub(crate) fn mean<'a>(matrices: impl IntoIterator<Item = &'a Matrix>) -> Matrix {
    let mut matrices = matrices.into_iter();
    let mut sum = matrices.next().cloned().unwrap_or_default();
    let mut count = 1.0;
    for matrix in matrices {
        sum += matrix;
        count += 1.0;
    }
    sum / Complex64::from(count)
}

/// Covariance of the mean of vec(matrix), `sum d d^H / (n (n - 1))`, d the deviations from it; `None`
/// for one matrix.
fn covariance_about(mean: &Matrix, matrices: &[Matrix]) -> Option<Matrix> {
    let n = matrices.len() as f64;
    let squares = || squares_about(mean, matrices);
    (n > 1.0).then(|| squares() / Complex64::from(n * (n - 1.0)))
}

/// `sum d d^H`, d = vec(matrix - centre).
pub(crate) fn squares_about(centre: &Matrix, matrices: &[Matrix]) -> Matrix {
    let mut sum = DMatrix::zeros(centre.len(), centre.len());
    for matrix in matrices {
        let deviation = DVector::from_column_slice((matrix - centre).as_slice());
        sum.gerc(Complex64::ONE, &deviation, &deviation, Complex64::ONE);
    }
    sum
}
