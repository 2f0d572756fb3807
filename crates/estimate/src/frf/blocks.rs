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

use frfid_signals::{Frf, Uncertainty};
use nalgebra::DMatrix;
use ndarray::Array2;
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::EstimateError;
use crate::error::deficient_line::{Deficiency, DeficientLine};
use crate::frf::excitation::Excitation;
use crate::frf::matrices::{Matrix, stacked};
use crate::frf::right_division::{check_excited, check_rank};
use crate::frf::{FrfEstimate, FrfMethod, FrfOptions};
use crate::spectra::campaign::{Block, Campaign};

/// A method that works line by line, from the spectra of all blocks to an estimate of each.
pub(crate) trait BlockMethod: Sync {
    /// Whether the blocks must hold the reference.
    const NEEDS_REFERENCE: bool = false;

    /// Estimates of the blocks, `(realization, period)`; `invertible` refuses matrices that cannot be
    /// inverted and returns the condition number of the others.
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine>;
}

/// The condition number of a matrix, or why it cannot be inverted.
pub(crate) type Invertible<'a> = dyn Fn(&Matrix) -> Result<f64, DeficientLine> + 'a;

impl<M: BlockMethod> FrfMethod for M {
    fn needs_reference(&self) -> bool {
        M::NEEDS_REFERENCE
    }

    fn frf(&self, campaign: &Campaign, options: &FrfOptions) -> Result<FrfEstimate, EstimateError> {
        let realizations = campaign.realizations()?;
        let excitation = Excitation::of(&realizations, M::NEEDS_REFERENCE);
        let of_line = |(line, &hz): (usize, &f64)| {
            check_excited(excitation.deficiency(line), options.max_condition, hz)?;
            let invertible = |u: &Matrix| check_rank(u, options.max_condition, hz);
            let blocks = map_blocks(&realizations, |block| LineBlock::of(block, line));
            Ok(with_covariances(&self.estimates(&blocks, &invertible)?))
        };
        let frequency_hz = campaign.frequency_hz();
        let lines = frequency_hz.par_iter().enumerate().map(of_line).collect();
        let (lines, left_out) = with_gaps(lines)?;
        let periods: usize = realizations.iter().map(Vec::len).sum();
        let (noise_freedom, total_freedom) = (periods - realizations.len(), realizations.len() - 1);
        Ok(FrfEstimate {
            frf: assemble(frequency_hz.to_vec(), &lines, noise_freedom, total_freedom),
            left_out,
            input_snr_db: excitation.snr_db(),
            equal_draws: Vec::new(),
        })
    }
}

/// The estimates, unknown where a line is deficient, and those lines; an error if none is left.
fn with_gaps(
    lines: Vec<Result<LineEstimate, DeficientLine>>,
) -> Result<(Vec<LineEstimate>, Vec<DeficientLine>), EstimateError> {
    let deficient = || lines.iter().filter_map(|line| line.as_ref().err().cloned());
    let left_out: Vec<_> = deficient().collect();
    let Some(sound) = lines.iter().find_map(|line| line.as_ref().ok()) else {
        return Err(EstimateError::RankDeficient(left_out));
    };
    let gap = LineEstimate::unknown(sound);
    let lines = lines.into_iter();
    let lines = lines.map(|line| line.unwrap_or_else(|cause| gap.because_of(&cause)));
    Ok((lines.collect(), left_out))
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
            u: on_line(line, block.len(), |m| &block[m].u),
            y: on_line(line, block.len(), |m| &block[m].y),
            r: r.map(|r| on_line(line, r.len(), |m| r[m])),
        }
    }
}

/// One line of the spectra of every experiment.
fn on_line<'a>(
    line: usize,
    n_experiments: usize,
    spectra: impl Fn(usize) -> &'a Array2<Complex64>,
) -> Matrix {
    DMatrix::from_fn(spectra(0).nrows(), n_experiments, |channel, m| {
        spectra(m)[[channel, line]]
    })
}

/// Estimates of every block, `(realization, period)`, whose mean over periods, then realizations,
/// has the errors of the FRF.
pub(crate) struct BlockEstimates {
    pub(crate) blocks: Vec<Vec<Matrix>>,
    /// Worst condition number of the matrices inverted.
    pub(crate) condition: f64,
}

/// The FRF on one line with its covariances.
#[derive(Clone)]
struct LineEstimate {
    response: Matrix,
    noise: Option<Matrix>,
    total: Option<Matrix>,
    condition: f64,
}

impl LineEstimate {
    /// NaN in the shapes of another line.
    fn unknown(other: &Self) -> Self {
        let unknown = |matrix: &Matrix| matrix.map(|_| Complex64::new(f64::NAN, f64::NAN));
        Self {
            response: unknown(&other.response),
            noise: other.noise.as_ref().map(unknown),
            total: other.total.as_ref().map(unknown),
            condition: f64::NAN,
        }
    }

    /// The same, with the condition number where that is what is wrong.
    fn because_of(&self, line: &DeficientLine) -> Self {
        let condition = match line.cause {
            Deficiency::InputSilent { .. } | Deficiency::ExperimentsAlike { .. } => line.condition,
            Deficiency::InputWeak { .. } | Deficiency::InputNoisy { .. } => f64::NAN,
        };
        Self {
            condition,
            ..self.clone()
        }
    }
}

/// The means and covariances at the head of this file.
fn with_covariances(estimates: &BlockEstimates) -> LineEstimate {
    let per_realization = means_over_periods(&estimates.blocks);
    LineEstimate {
        response: mean(&per_realization),
        noise: noise_covariance(&estimates.blocks),
        total: covariance_of_mean(&per_realization),
        condition: estimates.condition,
    }
}

/// The noise covariance at the head of this file; `None` where a realization has one period.
fn noise_covariance(blocks: &[Vec<Matrix>]) -> Option<Matrix> {
    let covariances = blocks.iter().map(|periods| covariance_of_mean(periods));
    let covariances = covariances.collect::<Option<Vec<_>>>()?;
    Some(mean(&covariances) / Complex64::from(blocks.len() as f64))
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

/// Covariance of the mean of vec(matrix), `sum d d^H / (n (n - 1))`; `None` for one matrix.
fn covariance_of_mean(matrices: &[Matrix]) -> Option<Matrix> {
    if matrices.len() < 2 {
        return None;
    }
    let (n, centre) = (matrices.len() as f64, mean(matrices));
    let mut sum = DMatrix::zeros(centre.len(), centre.len());
    for matrix in matrices {
        let deviation =
            (matrix - &centre).reshape_generic(nalgebra::Dyn(centre.len()), nalgebra::Const::<1>);
        sum.gerc(Complex64::ONE, &deviation, &deviation, Complex64::ONE);
    }
    Some(sum / Complex64::from(n * (n - 1.0)))
}

/// Puts the lines together as an [`Frf`].
fn assemble(
    frequency_hz: Vec<f64>,
    lines: &[LineEstimate],
    noise_freedom: usize,
    total_freedom: usize,
) -> Frf {
    let responses: Vec<_> = lines.iter().map(|line| &line.response).collect();
    let noise = lines.iter().map(|line| line.noise.as_ref());
    let total = lines.iter().map(|line| line.total.as_ref());
    Frf {
        frequency_hz,
        response: stacked(&responses),
        noise: uncertainty(noise, noise_freedom),
        total: uncertainty(total, total_freedom),
        condition: Some(lines.iter().map(|line| line.condition).collect()),
        relative_resolution: None,
    }
}

/// The covariances of all lines; `None` where they were not measured.
fn uncertainty<'a>(
    covariances: impl Iterator<Item = Option<&'a Matrix>>,
    degrees_of_freedom: usize,
) -> Option<Uncertainty> {
    let covariances = covariances.collect::<Option<Vec<_>>>()?;
    Some(Uncertainty {
        covariance: stacked(&covariances),
        degrees_of_freedom,
    })
}
