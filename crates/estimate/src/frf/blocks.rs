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
use nalgebra::{DMatrix, DVector};
use ndarray::Array2;
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::EstimateError;
use crate::error::deficient_line::{Deficiency, DeficientLine};
use crate::frf::excitation::Excitation;
use crate::frf::matrices::{Matrix, stacked, vector};
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
        Ok(FrfEstimate {
            frf: assemble(hz, &lines, blocks.freedom()),
            left_out,
            input_snr_db: blocks.excitation.snr_db(),
            equal_draws: Vec::new(),
        })
    }
}

/// The blocks of a campaign, and what decides whether a line of them can be used.
struct Blocks<'a> {
    realizations: Vec<Vec<Block<'a>>>,
    excitation: Excitation,
    max_condition: f64,
}

impl<'a> Blocks<'a> {
    fn of<M: BlockMethod>(
        campaign: &'a Campaign,
        max_condition: f64,
    ) -> Result<Self, EstimateError> {
        let realizations = campaign.realizations()?;
        Ok(Self {
            excitation: Excitation::of(&realizations, M::NEEDS_REFERENCE),
            realizations,
            max_condition,
        })
    }

    /// The FRF on one line.
    fn estimate(&self, method: &impl BlockMethod, line: usize, hz: f64) -> LineResult {
        check_excited(self.excitation.deficiency(line), self.max_condition, hz)?;
        let invertible = |u: &Matrix| check_rank(u, self.max_condition, hz);
        let blocks = map_blocks(&self.realizations, |block| LineBlock::of(block, line));
        let estimates = method.estimates(&blocks, &invertible)?;
        Ok(with_covariances(&estimates))
    }

    fn freedom(&self) -> Freedom {
        let n_realizations = self.realizations.len();
        let n_periods: usize = self.realizations.iter().map(Vec::len).sum();
        Freedom {
            noise: (n_periods - n_realizations) as f64,
            total: (n_realizations - 1) as f64,
        }
    }
}

/// Degrees of freedom of the covariances.
struct Freedom {
    noise: f64,
    total: f64,
}

/// The FRF on a line, or why there is none.
type LineResult = Result<LineEstimate, DeficientLine>;

/// The lines that are deficient.
fn left_out(lines: &[LineResult]) -> impl Iterator<Item = DeficientLine> {
    lines.iter().filter_map(|line| line.as_ref().err().cloned())
}

/// The estimates, unknown where a line is deficient; `None` if none is left.
fn with_gaps(lines: Vec<LineResult>) -> Option<Vec<LineEstimate>> {
    let gap = lines.iter().flatten().next().map(LineEstimate::unknown)?;
    let filled = |line: LineResult| line.unwrap_or_else(|cause| gap.because_of(&cause));
    Some(lines.into_iter().map(filled).collect())
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
            r: r.map(|r| on_line(line, r)),
        }
    }
}

/// One line of the spectra of every experiment.
fn on_line<'a>(line: usize, spectra: impl IntoIterator<Item = &'a Array2<Complex64>>) -> Matrix {
    let spectra = spectra.into_iter().map(|spectra| spectra.column(line));
    let columns: Vec<DVector<_>> = spectra.map(vector).collect();
    DMatrix::from_columns(&columns)
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

/// NaN in the shape of another matrix.
fn unknown(matrix: &Matrix) -> Matrix {
    matrix.map(|_| Complex64::new(f64::NAN, f64::NAN))
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
    let of_means = blocks.iter().map(|periods| covariance_of_mean(periods));
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

/// Covariance of the mean of vec(matrix), `sum d d^H / (n (n - 1))`; `None` for one matrix.
fn covariance_of_mean(matrices: &[Matrix]) -> Option<Matrix> {
    let n = matrices.len() as f64;
    let squares = || squares_about(&mean(matrices), matrices);
    (n > 1.0).then(|| squares() / Complex64::from(n * (n - 1.0)))
}

/// `sum d d^H`, d = vec(matrix - centre).
fn squares_about(centre: &Matrix, matrices: &[Matrix]) -> Matrix {
    let mut sum = DMatrix::zeros(centre.len(), centre.len());
    for matrix in matrices {
        let deviation = DVector::from_column_slice((matrix - centre).as_slice());
        sum.gerc(Complex64::ONE, &deviation, &deviation, Complex64::ONE);
    }
    sum
}

/// Puts the lines together as an [`Frf`].
fn assemble(frequency_hz: &[f64], lines: &[LineEstimate], freedom: Freedom) -> Frf {
    let responses: Vec<_> = lines.iter().map(|line| &line.response).collect();
    let condition = lines.iter().map(|line| line.condition).collect();
    Frf {
        frequency_hz: frequency_hz.to_vec(),
        response: stacked(&responses),
        noise: uncertainty(lines.iter().map(|line| line.noise.as_ref()), freedom.noise),
        total: uncertainty(lines.iter().map(|line| line.total.as_ref()), freedom.total),
        condition: Some(condition),
        relative_resolution: None,
    }
}

/// The covariances of all lines; `None` where they were not measured.
fn uncertainty<'a>(
    covariances: impl Iterator<Item = Option<&'a Matrix>>,
    degrees_of_freedom: f64,
) -> Option<Uncertainty> {
    let covariances = covariances.collect::<Option<Vec<_>>>()?;
    Some(Uncertainty {
        covariance: stacked(&covariances),
        degrees_of_freedom,
    })
}
