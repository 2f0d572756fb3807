//! Best linear approximation, SK15 (13) and (14): the FRF averaged over periods and realizations,
//! with its variances.
//!
//! ```text
//! G = 1/n_p sum_p G_p,   G_p = 1/n_q sum_q T_pq
//! noise covariance = 1/n_p^2 sum_p [ sum_q d_pq d_pq^H / (n_q (n_q - 1)) ],   d_pq = vec(T_pq - G_p)
//! total covariance = sum_p d_p d_p^H / (n_p (n_p - 1)),                       d_p  = vec(G_p - G)
//! ```
//!
//! Both are covariances *of the averaged* G. The three estimators differ in the block estimates
//! `T_pq` alone:
//!
//! - mean of FRFs: `T_pq = Y_pq U_pq^+`, the paper's arithmetic mean of (7);
//! - mean of spectra: `G_p = Y_p U_p^+` with spectra averaged over periods,
//!   `T_pq = G_p + (Y_pq - G_p U_pq) U_p^+`, which is what period q contributes to G_p to first
//!   order in the noise;
//! - joint input-output, when the reference is known: see `indirect.rs`.
//!
//! With one run the estimate is the direct FRF (7). Source of the variances: R. Pintelon, J.
//! Schoukens, System Identification, 2nd ed., ch. 3 and 4.

use frfid_signals::{Frf, SignalError, Uncertainty};
use nalgebra::DMatrix;
use ndarray::{Array3, ArrayView2, ArrayView5, s};
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::{DeficientLine, EstimateError};
use crate::frf::joint_input_output::joint_input_output;
use crate::frf::right_division::{check_rank, right_divide};
use crate::spectra::campaign::{Block, Campaign, Place, RunSpectra};
use crate::spectra::line_dft::LineDft;

/// What is averaged over the periods of a realization when no reference is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Averaging {
    /// FRFs, SK15 (13): unbiased where the input is known exactly.
    #[default]
    Frfs,
    /// Spectra, before dividing: the better choice where the input is measured with noise.
    Spectra,
}

/// How the best linear approximation is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlaOptions {
    /// What is averaged over periods; without effect where a reference is given, then sums precede
    /// the division anyway.
    pub averaging: Averaging,
    /// Largest condition number of U, rows scaled to equal size, at which a line is still inverted.
    pub max_condition: f64,
}

impl Default for BlaOptions {
    fn default() -> Self {
        Self {
            averaging: Averaging::Frfs,
            max_condition: 1e10,
        }
    }
}

/// Best linear approximation from time series `(realization, experiment, period, channel, sample)`
/// of any strides.
///
/// `harmonics` are DFT bins of the period, rising. With the reference `r` (as many channels as `u`)
/// the estimate is the indirect one, which noise on `u` does not bias; without it the direct one.
/// The noise covariance is `None` with one period, the total covariance with one realization.
///
/// # Errors
/// Shapes that differ, samples that are not finite, lines off the grid, fewer experiments than
/// inputs, lines on which U cannot be inverted: [`EstimateError`] with what was found and needed.
pub fn estimate_bla(
    u: ArrayView5<f64>,
    y: ArrayView5<f64>,
    r: Option<ArrayView5<f64>>,
    sample_time_s: f64,
    harmonics: &[usize],
    options: &BlaOptions,
) -> Result<Frf, EstimateError> {
    let (n_p, n_ex, n_q, _, n_samples) = u.dim();
    for (name, signal) in [("y", Some(&y)), ("r", r.as_ref())] {
        let Some(signal) = signal else { continue };
        let (p, m, q, _, k) = signal.dim();
        if (p, m, q, k) != (n_p, n_ex, n_q, n_samples) {
            let needed = format!("({n_p}, {n_ex}, {n_q}, channel, {n_samples}), as u");
            return Err(SignalError::Shape {
                name,
                found: signal.shape().to_vec(),
                needed,
            }
            .into());
        }
    }
    let dft = LineDft::new(n_samples, harmonics)?;
    let mut campaign = Campaign::new(dft.frequency_hz(sample_time_s)?)?;
    let places: Vec<Place> = (0..n_p * n_q * n_ex)
        .map(|run| Place {
            realization: run / (n_q * n_ex),
            period: run / n_ex % n_q,
            experiment: run % n_ex,
        })
        .collect();
    let spectra: Result<Vec<RunSpectra>, EstimateError> = places
        .par_iter()
        .map(|&place| {
            RunSpectra::of(
                &dft,
                run_at(&u, place),
                run_at(&y, place),
                r.as_ref().map(|r| run_at(r, place)),
            )
        })
        .collect();
    for (place, run) in places.into_iter().zip(spectra?) {
        campaign.insert(place, run)?;
    }
    campaign.estimate(options)
}

/// One run, `(channel, sample)`, out of a campaign's array.
fn run_at<'a>(signal: &'a ArrayView5<f64>, place: Place) -> ArrayView2<'a, f64> {
    signal.slice(s![
        place.realization,
        place.experiment,
        place.period,
        ..,
        ..
    ])
}

impl Campaign {
    /// Best linear approximation from the runs given so far; see [`estimate_bla`].
    ///
    /// # Errors
    /// [`EstimateError::Incomplete`], [`EstimateError::TooFewExperiments`],
    /// [`EstimateError::RankDeficient`] with every line that cannot be inverted.
    pub fn estimate(&self, options: &BlaOptions) -> Result<Frf, EstimateError> {
        let realizations = self.realizations()?;
        let estimates: Vec<Result<LineEstimate, DeficientLine>> = self
            .frequency_hz()
            .par_iter()
            .enumerate()
            .map(|(line, &frequency_hz)| line_estimate(&realizations, line, frequency_hz, options))
            .collect();
        let (sound, deficient): (Vec<_>, Vec<_>) = estimates.into_iter().partition(Result::is_ok);
        if !deficient.is_empty() {
            return Err(EstimateError::RankDeficient(
                deficient.into_iter().filter_map(Result::err).collect(),
            ));
        }
        let sound: Vec<LineEstimate> = sound.into_iter().flatten().collect();
        let periods: usize = realizations.iter().map(Vec::len).sum();
        Ok(assemble(
            self.frequency_hz().to_vec(),
            &sound,
            periods - realizations.len(),
            realizations.len() - 1,
        ))
    }
}

/// U, Y and R of one block on one line: channels in rows, experiments in columns.
pub(crate) struct LineBlock {
    pub(crate) u: DMatrix<Complex64>,
    pub(crate) y: DMatrix<Complex64>,
    pub(crate) r: Option<DMatrix<Complex64>>,
}

impl LineBlock {
    fn of(block: &Block, line: usize) -> Self {
        let experiments = block.len();
        let r = block
            .iter()
            .map(|run| run.r.as_ref())
            .collect::<Option<Vec<_>>>();
        Self {
            u: DMatrix::from_fn(block[0].u.nrows(), experiments, |channel, m| {
                block[m].u[[channel, line]]
            }),
            y: DMatrix::from_fn(block[0].y.nrows(), experiments, |channel, m| {
                block[m].y[[channel, line]]
            }),
            r: r.map(|r| {
                DMatrix::from_fn(r[0].nrows(), experiments, |channel, m| {
                    r[m][[channel, line]]
                })
            }),
        }
    }
}

/// Estimates of every block, `(realization, period)`, whose mean over periods, then realizations,
/// has the errors of the FRF.
pub(crate) struct BlockEstimates {
    pub(crate) blocks: Vec<Vec<DMatrix<Complex64>>>,
    /// Worst condition number of the matrices inverted.
    pub(crate) condition: f64,
}

/// The FRF on one line with its covariances.
struct LineEstimate {
    response: DMatrix<Complex64>,
    noise: Option<DMatrix<Complex64>>,
    total: Option<DMatrix<Complex64>>,
    condition: f64,
}

fn line_estimate(
    realizations: &[Vec<Block>],
    line: usize,
    frequency_hz: f64,
    options: &BlaOptions,
) -> Result<LineEstimate, DeficientLine> {
    let blocks: Vec<Vec<LineBlock>> = realizations
        .iter()
        .map(|periods| {
            periods
                .iter()
                .map(|block| LineBlock::of(block, line))
                .collect()
        })
        .collect();
    let invertible = |u: &DMatrix<Complex64>| check_rank(u, options.max_condition, frequency_hz);
    let estimates = match options.averaging {
        _ if blocks[0][0].r.is_some() => joint_input_output(&blocks, invertible)?,
        Averaging::Frfs => mean_of_frfs(&blocks, invertible)?,
        Averaging::Spectra => mean_of_spectra(&blocks, invertible)?,
    };
    Ok(with_covariances(&estimates))
}

/// `T_pq = Y_pq U_pq^+`.
fn mean_of_frfs(
    blocks: &[Vec<LineBlock>],
    invertible: impl Fn(&DMatrix<Complex64>) -> Result<f64, DeficientLine>,
) -> Result<BlockEstimates, DeficientLine> {
    let mut condition = 0.0_f64;
    let mut estimate = |block: &LineBlock| {
        condition = condition.max(invertible(&block.u)?);
        Ok(right_divide(&block.y, &block.u))
    };
    let blocks = blocks
        .iter()
        .map(|periods| periods.iter().map(&mut estimate).collect())
        .collect::<Result<_, _>>()?;
    Ok(BlockEstimates { blocks, condition })
}

/// `T_pq = G_p + (Y_pq - G_p U_pq) U_p^+` with `G_p = Y_p U_p^+` from spectra averaged over
/// periods.
fn mean_of_spectra(
    blocks: &[Vec<LineBlock>],
    invertible: impl Fn(&DMatrix<Complex64>) -> Result<f64, DeficientLine>,
) -> Result<BlockEstimates, DeficientLine> {
    let mut condition = 0.0_f64;
    let mut estimate = |periods: &Vec<LineBlock>| {
        let u = mean(periods.iter().map(|block| &block.u));
        condition = condition.max(invertible(&u)?);
        let response = right_divide(&mean(periods.iter().map(|block| &block.y)), &u);
        let contribution =
            |block: &LineBlock| &response + right_divide(&(&block.y - &response * &block.u), &u);
        Ok(periods.iter().map(contribution).collect())
    };
    let blocks = blocks.iter().map(&mut estimate).collect::<Result<_, _>>()?;
    Ok(BlockEstimates { blocks, condition })
}

/// The means and covariances at the head of this file.
fn with_covariances(estimates: &BlockEstimates) -> LineEstimate {
    let per_realization: Vec<DMatrix<Complex64>> = estimates
        .blocks
        .iter()
        .map(|periods| mean(periods.iter()))
        .collect();
    let n_p = per_realization.len() as f64;
    let noise: Option<Vec<_>> = estimates
        .blocks
        .iter()
        .map(|periods| covariance_of_mean(periods))
        .collect();
    LineEstimate {
        response: mean(per_realization.iter()),
        noise: noise.map(|noise| mean(noise.iter()) / Complex64::from(n_p)),
        total: covariance_of_mean(&per_realization),
        condition: estimates.condition,
    }
}

/// Arithmetic mean; the iterator must not be empty.
pub(crate) fn mean<'a>(
    mut matrices: impl Iterator<Item = &'a DMatrix<Complex64>>,
) -> DMatrix<Complex64> {
    let mut sum = matrices
        .next()
        .cloned()
        .unwrap_or_else(|| DMatrix::zeros(0, 0));
    let mut count = 1.0;
    for matrix in matrices {
        sum += matrix;
        count += 1.0;
    }
    sum / Complex64::from(count)
}

/// Covariance of the mean of vec(matrix), `sum d d^H / (n (n - 1))`; `None` for one matrix.
fn covariance_of_mean(matrices: &[DMatrix<Complex64>]) -> Option<DMatrix<Complex64>> {
    if matrices.len() < 2 {
        return None;
    }
    let (n, centre) = (matrices.len() as f64, mean(matrices.iter()));
    let mut sum = DMatrix::zeros(centre.len(), centre.len());
    for matrix in matrices {
        let deviation = matrix - &centre;
        let deviation =
            deviation.reshape_generic(nalgebra::Dyn(centre.len()), nalgebra::Const::<1>);
        sum.gerc(
            Complex64::from(1.0),
            &deviation,
            &deviation,
            Complex64::from(1.0),
        );
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
    let stack = |part: &dyn Fn(&LineEstimate) -> Option<&DMatrix<Complex64>>| {
        let matrices: Option<Vec<_>> = lines.iter().map(part).collect();
        let matrices = matrices?;
        let shape = (matrices.len(), matrices[0].nrows(), matrices[0].ncols());
        Some(Array3::from_shape_fn(shape, |(line, row, column)| {
            matrices[line][(row, column)]
        }))
    };
    let known = |covariance: Option<Array3<Complex64>>, degrees_of_freedom| {
        covariance.map(|covariance| Uncertainty {
            covariance,
            degrees_of_freedom,
        })
    };
    Frf {
        frequency_hz,
        response: stack(&|line| Some(&line.response)).unwrap_or_else(|| Array3::zeros((0, 0, 0))),
        noise: known(stack(&|line| line.noise.as_ref()), noise_freedom),
        total: known(stack(&|line| line.total.as_ref()), total_freedom),
        condition: Some(lines.iter().map(|line| line.condition).collect()),
        relative_resolution: None,
    }
}
