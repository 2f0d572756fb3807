//! Harmonic least squares: spectra on given lines from samples at their true times, with holes.
//!
//! ```text
//! x(t) = X[0]/N + (2/N) Re sum_h X[h] e^{2 pi i h t},   t in periods
//! ```
//!
//! is fitted to the samples that are there. On an even grid of whole periods without holes that is
//! the DFT. Lines that are in the signal and not in the list leak in where samples are missing: list
//! them too, and take the excited ones.

pub(super) mod gram;
pub(super) mod sums;

use std::iter::{self, zip};

use frfid_signals::checks::{finite, positive};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis, aview1};
use num_complex::Complex64;

use crate::error::EstimateError;

use crate::spectra::harmonic_fit::gram::Gram;
use crate::spectra::harmonic_fit::sums::harmonic_sums;
use crate::spectra::line_dft::{check_on_grid, check_rising};
use crate::spectra::{check_length, mean};

/// Longest period: as long as the longest signal that a design may ask for.
const LONGEST: f64 = (1_u64 << 26) as f64;

/// Harmonic least squares in one window, of one or several periods; from any thread.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicFit {
    cycles: Vec<f64>,
    lines: Vec<usize>,
    n_samples: f64,
}

impl HarmonicFit {
    /// A window of samples at `cycles`, times over the period, which rise and need not be even;
    /// `lines` are DFT bins of the period, `n_samples` its length in samples, not necessarily whole:
    /// spectra have the scale of its DFT.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError::LineOffGrid`] for a line that is 0 or not below Nyquist,
    /// [`EstimateError::NotRising`], [`EstimateError::EmptyList`],
    /// [`frfid_signals::SignalError::Parameter`] for a length that is not above zero.
    pub fn new(cycles: &[f64], lines: &[usize], n_samples: f64) -> Result<Self, EstimateError> {
        check_lines(lines, n_samples)?;
        check_rising("cycles", cycles.iter().copied())?;
        for end in cycles.first().into_iter().chain(cycles.last()) {
            finite("cycles", *end)?;
        }
        Ok(Self {
            cycles: cycles.to_vec(),
            lines: lines.to_vec(),
            n_samples,
        })
    }

    /// Spectra `(channel, line)` of `(channel, sample)`. Samples that are not numbers are left out,
    /// channel by channel; the mean is an unknown too.
    ///
    /// `None` where, in some channel, the samples that are there cannot tell the lines apart.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError::Shape`] for another number of samples than the window has.
    pub fn spectra(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Option<Array2<Complex64>>, EstimateError> {
        check_length(name, signal, self.cycles.len())?;
        let mut spectra = Array2::zeros((signal.nrows(), self.lines.len()));
        for channels in alike(signal) {
            let Some(fitted) = self.fitted(signal.select(Axis(0), &channels).view()) else {
                return Ok(None);
            };
            for (channel, fitted) in zip(channels, fitted) {
                spectra.row_mut(channel).assign(&fitted);
            }
        }
        Ok(Some(spectra))
    }

    /// Spectra of channels with the same holes; `None` if the lines cannot be told apart.
    fn fitted(&self, channels: ArrayView2<f64>) -> Option<Vec<Array1<Complex64>>> {
        let (gram, right) = self.normal_equations(&self.present(channels));
        gram.variance_growth(self.cycles.len())?;
        let coefficients = right.iter().map(|right| gram.solve(right));
        let lines = coefficients.map(|all| aview1(&all[1..]).mapv(|x| x * self.n_samples));
        Some(lines.collect())
    }

    /// Standard deviation of a line under white noise over that of the window without holes and
    /// evenly sampled, root of the mean square over the lines: 1.04 where 7.5 % of the samples are
    /// lost at random, 1.30 where 41 % are. `None` where the samples that are present cannot tell the
    /// lines apart.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError::Shape`] for another number of samples than the window has.
    pub fn noise_growth(&self, is_present: &[bool]) -> Result<Option<f64>, EstimateError> {
        let ones = |(_, k): (usize, usize)| if is_present[k] { 1.0 } else { f64::NAN };
        let signal = Array2::from_shape_fn((1, is_present.len()), ones);
        check_length("is_present", signal.view(), self.cycles.len())?;
        let (gram, _) = self.normal_equations(&self.present(signal.view()));
        let growth = gram.variance_growth(self.cycles.len());
        Ok(growth.map(f64::sqrt))
    }

    /// Times and values of the samples that are there in channels with the same holes.
    fn present(&self, channels: ArrayView2<f64>) -> Samples {
        let is_there: Vec<bool> = channels.row(0).iter().map(|x| x.is_finite()).collect();
        let values = channels.rows().into_iter();
        Samples {
            cycles: kept(&self.cycles, &is_there),
            values: values
                .map(|channel| centred(kept(channel, &is_there)))
                .collect(),
        }
    }

    /// Gram matrix, and the right-hand side of every channel.
    fn normal_equations(&self, samples: &Samples) -> (Gram, Vec<Vec<Complex64>>) {
        let Samples { cycles, values } = samples;
        let harmonics = self.harmonics();
        let highest = self.lines.last().copied().unwrap_or(0);
        let sums = harmonic_sums(cycles, values, highest);
        let of_channel = |channel: usize| harmonics.iter().map(|&h| sums[h][channel]).collect();
        let right = (0..values.len()).map(of_channel).collect();
        let ones = vec![vec![1.0; cycles.len()]];
        let gram = harmonic_sums(cycles, &ones, 2 * highest).concat();
        (Gram::new(harmonics, &gram), right)
    }

    /// What is fitted: the constant and the lines.
    fn harmonics(&self) -> Vec<usize> {
        let lines = self.lines.iter().copied();
        iter::once(0).chain(lines).collect()
    }
}

/// Refuses lines that are no rising DFT bins below Nyquist of a period of so many samples.
fn check_lines(lines: &[usize], n_samples: f64) -> Result<(), EstimateError> {
    positive("n_samples", n_samples)?;
    if n_samples > LONGEST {
        let needed = "at most 2^26, the samples of a period";
        return Err(EstimateError::parameter("n_samples", n_samples, needed));
    }
    let highest = ((n_samples / 2.0).ceil() as usize).saturating_sub(1);
    check_on_grid(lines, highest, n_samples.round() as usize)?;
    check_rising("lines", lines.iter().map(|&line| line as f64))
}

/// Samples that are there.
struct Samples {
    cycles: Vec<f64>,
    /// `(channel, sample)`.
    values: Vec<Vec<f64>>,
}

/// The values that are there.
fn kept<'a>(values: impl IntoIterator<Item = &'a f64>, is_there: &[bool]) -> Vec<f64> {
    let kept = zip(values, is_there).filter(|(_, is_there)| **is_there);
    kept.map(|(value, _)| *value).collect()
}

/// Values about their mean: the constant is an unknown, and a large one costs digits.
fn centred(mut values: Vec<f64>) -> Vec<f64> {
    let mean = mean(&values);
    values.iter_mut().for_each(|value| *value -= mean);
    values
}

/// Channels in groups that have the same holes.
fn alike(signal: ArrayView2<f64>) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (channel, samples) in signal.rows().into_iter().enumerate() {
        let has_same = |group: &&mut Vec<usize>| has_same_holes(signal.row(group[0]), samples);
        match groups.iter_mut().find(has_same) {
            Some(group) => group.push(channel),
            None => groups.push(vec![channel]),
        }
    }
    groups
}

fn has_same_holes(a: ArrayView1<f64>, b: ArrayView1<f64>) -> bool {
    zip(a, b).all(|(a, b)| a.is_finite() == b.is_finite())
}

#[cfg(test)]
mod tests;
