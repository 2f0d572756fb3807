//! Spectra of whole records on the lines of a band, experiments as columns, and the way back into
//! time.

use std::f64::consts::PI;
use std::iter::zip;
use std::ops::Range;
use std::sync::Arc;

use frfid_signals::SignalError;
use frfid_transforms::{ComplexToReal, TransformPlanner};
use nalgebra::DMatrix;
use ndarray::{Array2, Array3, ArrayView2, Axis, aview1, s};

use crate::error::EstimateError;
use crate::error::deficient_line::{Deficiency, DeficientLine};
use crate::frf::matrices::Matrix;
use crate::frf::right_division::MAX_CONDITION;
use crate::shape::options::ShapeOptions;
use crate::spectra::line_dft::LineDft;

/// Width of the fades at both ends of the band, as a factor of frequency.
const FADE: f64 = 1.1;
/// Share of the strongest line's power below which a line of the desired signal counts as silent.
const SILENT: f64 = 1e-8;

/// The lines of a band in records of one length, with half-cosine fades outside of it.
#[derive(Clone)]
pub(super) struct Band {
    /// Frequencies in Hz of the lines inside the band.
    pub frequency_hz: Vec<f64>,
    lines: Vec<usize>,
    /// Weight of every line, fades included.
    weight: Vec<f64>,
    /// Lines in the lower fade.
    n_below: usize,
    dft: LineDft,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl Band {
    /// The lines of the options' band, fades included, on which the desired signal
    /// `(experiment, channel, sample)` has power: of a chirp all, of a multisine those that are
    /// excited.
    pub(super) fn new(
        desired: &Array3<f64>,
        options: &ShapeOptions,
    ) -> Result<Self, EstimateError> {
        let n_samples = desired.len_of(Axis(2));
        let hz = |line: usize| line as f64 / (n_samples as f64 * options.sample_time_s);
        let faded = options.low_hz / FADE..options.high_hz * FADE;
        let near: Vec<usize> = (1..=n_samples.saturating_sub(1) / 2)
            .filter(|&line| faded.contains(&hz(line)))
            .collect();
        let near = Self::of(near, n_samples, options)?;
        let spectra = near.all("desired", desired.axis_iter(Axis(0)))?;
        let power: Vec<f64> = spectra.iter().map(DMatrix::norm_squared).collect();
        let strongest = power.iter().copied().fold(0.0, f64::max);
        let excited = zip(&near.lines, &power).filter(|(_, power)| **power > SILENT * strongest);
        Self::of(excited.map(|(&line, _)| line).collect(), n_samples, options)
    }

    fn of(
        lines: Vec<usize>,
        n_samples: usize,
        options: &ShapeOptions,
    ) -> Result<Self, EstimateError> {
        let hz = |&line: &usize| line as f64 / (n_samples as f64 * options.sample_time_s);
        let outside = |line: &usize| share_of_fade(hz(line), options);
        let weight = |line: &usize| 0.5 + 0.5 * (PI * outside(line)).cos();
        let inside = lines.iter().filter(|line| outside(line) == 0.0);
        let frequency_hz: Vec<f64> = inside.map(hz).collect();
        if frequency_hz.len() < 2 {
            let needed = "at least 2 lines of the record with power in the band: a longer record or a wider band";
            let found = frequency_hz.len() as f64;
            return Err(SignalError::derived("high_hz", "lines in the band", found, needed).into());
        }
        let below = lines.iter().filter(|line| hz(line) < options.low_hz);
        Ok(Self {
            n_below: below.count(),
            weight: lines.iter().map(weight).collect(),
            dft: LineDft::new(n_samples, &lines)?,
            inverse: TransformPlanner::default().inverse(n_samples),
            frequency_hz,
            lines,
        })
    }

    /// Refuses a desired signal in which a channel is silent on a line where another one is not.
    pub(super) fn check_excited(&self, desired: &[Matrix]) -> Result<(), EstimateError> {
        for (desired, &frequency_hz) in zip(&desired[self.inside()], &self.frequency_hz) {
            if let Some(input) = desired.row_iter().position(|row| row.norm() == 0.0) {
                let line = DeficientLine {
                    frequency_hz,
                    condition: f64::INFINITY,
                    limit: MAX_CONDITION,
                    cause: Deficiency::InputSilent { input },
                };
                return Err(EstimateError::RankDeficient(vec![line]));
            }
        }
        Ok(())
    }

    /// Spectra of one signal of all experiments, each `(channel, sample)`, on the lines inside the
    /// band: one matrix `(channel, experiment)` per line.
    pub(super) fn spectra<'a>(
        &self,
        name: &'static str,
        experiments: impl Iterator<Item = ArrayView2<'a, f64>>,
    ) -> Result<Vec<Matrix>, EstimateError> {
        Ok(self.all(name, experiments)?[self.inside()].to_vec())
    }

    /// As [`Band::spectra`], with the lines in the fades.
    pub(super) fn all<'a>(
        &self,
        name: &'static str,
        experiments: impl Iterator<Item = ArrayView2<'a, f64>>,
    ) -> Result<Vec<Matrix>, EstimateError> {
        let spectra = self.dft.transform_each(name, experiments)?;
        let n_channels = spectra.first().map_or(0, Array2::nrows);
        let matrix = |line| {
            DMatrix::from_fn(n_channels, spectra.len(), |channel, m| {
                spectra[m][[channel, line]]
            })
        };
        Ok((0..self.lines.len()).map(matrix).collect())
    }

    /// The lines inside the band, among all.
    pub(super) fn inside(&self) -> Range<usize> {
        self.n_below..self.n_below + self.frequency_hz.len()
    }

    /// Index inside the band of the line nearest to each line, fades included: what holds at the
    /// edge holds beyond it.
    pub(super) fn nearest(&self, line: usize) -> usize {
        line.saturating_sub(self.n_below)
            .min(self.frequency_hz.len() - 1)
    }

    /// Number of lines, fades included.
    pub(super) fn n_lines(&self) -> usize {
        self.lines.len()
    }

    /// Weight of a line: 1 in the band, falling to 0 in the fades.
    pub(super) fn weight(&self, line: usize) -> f64 {
        self.weight[line]
    }

    /// The signals `(experiment, channel, sample)` that have these spectra on the lines of the
    /// band, fades included.
    pub(super) fn signals(&self, spectra: &[Matrix]) -> Array3<f64> {
        let n_samples = self.dft.n_samples();
        let (n_channels, n_experiments) = spectra[0].shape();
        let mut signals = Array3::zeros((n_experiments, n_channels, n_samples));
        let (mut samples, mut scratch) = (
            self.inverse.make_output_vec(),
            self.inverse.make_scratch_vec(),
        );
        for experiment in 0..n_experiments {
            for channel in 0..n_channels {
                let mut bins = self.inverse.make_input_vec(); // zeros; the transform spoils it
                for (&line, matrix) in self.lines.iter().zip(spectra) {
                    bins[line] = matrix[(channel, experiment)] / n_samples as f64;
                }
                let done = self
                    .inverse
                    .process_with_scratch(&mut bins, &mut samples, &mut scratch);
                done.expect("the plan made the buffers, and bins 0 and Nyquist are no lines");
                let mut signal = signals.slice_mut(s![experiment, channel, ..]);
                signal.assign(&aview1(&samples));
            }
        }
        signals
    }
}

/// How far a frequency lies outside the band, as a share of the fade; 0 inside.
fn share_of_fade(hz: f64, options: &ShapeOptions) -> f64 {
    (options.low_hz / hz)
        .max(hz / options.high_hz)
        .max(1.0)
        .ln()
        / FADE.ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;

    #[test]
    fn what_lies_in_the_band_comes_back_and_the_rest_does_not() {
        let options = ShapeOptions {
            low_hz: 5.0,
            high_hz: 20.0,
            sample_time_s: 0.01,
            ..ShapeOptions::default()
        };
        let wave = |hz: f64, k: usize| (std::f64::consts::TAU * hz * k as f64 * 0.01 + hz).sin();
        for n_samples in [1000, 999] {
            let band = Band::of((40..210).collect(), n_samples, &options).expect("sound");
            let spacing_hz = 100.0 / n_samples as f64;
            let (inside, outside) = (100.0 * spacing_hz, 300.0 * spacing_hz);
            let signal = |low, high| {
                Array3::from_shape_fn((2, 3, n_samples), |(m, c, k)| {
                    (m + c) as f64 * (low * wave(inside, k) + high * wave(outside, k))
                })
            };
            let all = band
                .all("r", signal(1.0, 0.7).axis_iter(Axis(0)))
                .expect("finite");
            let back = band.signals(&all);
            assert!(
                (&back - &signal(1.0, 0.0))
                    .iter()
                    .all(|difference| difference.abs() < 1e-10)
            );
        }
    }

    #[test]
    fn fades_fall_from_one_to_zero_outside_the_band() {
        let click = |n_samples| {
            Array3::from_shape_fn((1, 1, n_samples), |(_, _, k)| f64::from(u8::from(k == 0)))
        };
        let band = Band::new(&click(21_000), &ShapeOptions::default()).expect("sound");
        assert!(
            (band.frequency_hz[0] - 2.0).abs() < 0.05
                && band.frequency_hz[band.frequency_hz.len() - 1] <= 60.0
        );
        for line in 0..band.n_lines() {
            assert_eq!(
                band.weight(line) == 1.0,
                band.inside().contains(&line),
                "line {line}"
            );
            assert!(band.weight(line) > 0.0);
        }
        assert_eq!(
            (band.nearest(0), band.nearest(band.n_lines() - 1)),
            (0, band.frequency_hz.len() - 1)
        );
        let narrow = ShapeOptions {
            high_hz: 3.0,
            ..ShapeOptions::default()
        };
        let said = refusal(Band::new(&click(100), &narrow));
        assert!(said.starts_with("lines in the band is 0,"), "{said}");
    }
}
