//! Random-phase multisines, SK15 (8) and (9): a grid of lines, an amplitude over frequency, and
//! their realizations.

use std::f64::consts::PI;

use ndarray::{Array3, indices};
use num_complex::Complex64;
use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::grid::LineGrid;
use crate::excitation::harmonic_sum::{HarmonicSum, TurnedSum};
use crate::excitation::low_crest::low_crest_phases;
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Profile;
use crate::number::checks::positive;
use crate::number::random;

/// How the phases of the lines are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phases {
    /// Uniform on the circle, a new draw for each realization: what the best linear approximation
    /// needs.
    #[default]
    Random,
    /// Chosen for a low crest factor, the same in each realization; for designs that do not average
    /// over realizations.
    LowCrest,
}

/// A multisine `s(t) = sum_s A(f_s) sin(2 pi f_s t + phi_s)` on the excited lines of a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Multisine {
    /// Period and lines.
    pub grid: LineGrid,
    /// Shape of the amplitude over frequency; only ratios count, the peak is set by the
    /// realization.
    pub shape: Profile,
    /// Choice of phases.
    pub phases: Phases,
}

/// Which realization to draw, and how large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw<'a> {
    /// Seed of the plan.
    pub seed: u64,
    /// Number of the realization, from 0: the phases come from its own stream.
    pub realization: usize,
    /// Phases between channels and experiments.
    pub phasing: Phasing,
    /// Largest value each channel may reach, in its unit; as many as inputs.
    pub peak: &'a [f64],
}

/// One draw of the random phases: one period for every experiment and channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Realization {
    /// One period, `(experiment, input, sample)`, in the unit of `peak`.
    pub signal: Array3<f64>,
    /// The common factor: `r_l = factor peak_l s_l` for every channel and experiment.
    pub factor: f64,
    /// True peak (between the samples too) that each channel reaches in its largest experiment.
    pub peak: Vec<f64>,
}

impl Multisine {
    /// One period of every experiment and channel: SK15 (9), with ONE factor over all channels and
    /// experiments, the largest for which no channel exceeds its peak. A factor for each channel
    /// would spoil the orthogonality.
    ///
    /// # Errors
    /// A grid, shape or peak that is out of range.
    pub fn realize(&self, draw: &Draw) -> Result<Realization, SignalError> {
        let amplitudes = self.line_amplitudes(draw)?;
        let n_inputs = draw.peak.len();
        let mut planner = RealFftPlanner::new();
        let sums = amplitudes.iter().map(|amplitudes| HarmonicSum {
            lines: &self.grid.excited,
            amplitudes,
        });
        let drawn: Vec<TurnedSum> = sums
            .map(|sum| TurnedSum::new(sum, self.grid.n_samples, &mut planner))
            .collect();
        let true_peaks = true_peaks(&drawn, draw.phasing, n_inputs);
        let factor = 1.0 / true_peaks.iter().flatten().copied().fold(0.0, f64::max);
        let mut signal = Array3::zeros((n_inputs, n_inputs, self.grid.n_samples));
        for ((experiment, channel), row) in indices((n_inputs, n_inputs))
            .into_iter()
            .zip(signal.rows_mut())
        {
            let phase_rad = draw.phasing.phase_rad(channel, experiment, n_inputs);
            let turn = Complex64::from_polar(factor * draw.peak[channel], phase_rad);
            row.into_iter()
                .zip(drawn[channel % drawn.len()].samples(turn))
                .for_each(|(sample, value)| *sample = value);
        }
        let peak = true_peaks
            .iter()
            .zip(draw.peak)
            .map(|(peaks, limit)| factor * limit * peaks.iter().copied().fold(0.0, f64::max));
        Ok(Realization {
            signal,
            factor,
            peak: peak.collect(),
        })
    }

    /// Complex amplitudes of the lines before the phases between channels and experiments: drawn
    /// once for all channels, or for each by itself.
    fn line_amplitudes(&self, draw: &Draw) -> Result<Vec<Vec<Complex64>>, SignalError> {
        self.grid.check()?;
        self.shape.check()?;
        for &peak in draw.peak {
            positive("peak", peak)?;
        }
        if draw.peak.is_empty() {
            return Err(SignalError::Derived {
                key: "peak",
                quantity: "number of peaks",
                found: 0.0,
                needed: "one for each input, at least one",
            });
        }
        let magnitudes: Vec<f64> = self
            .grid
            .lines_hz()
            .iter()
            .map(|&hz| self.shape.at(hz))
            .collect();
        if magnitudes.iter().all(|&magnitude| magnitude == 0.0) {
            return Err(SignalError::Derived {
                key: "shape",
                quantity: "largest amplitude of the shape on an excited line",
                found: 0.0,
                needed: "above 0 on at least one line",
            });
        }
        let draws = if draw.phasing == Phasing::Independent {
            draw.peak.len()
        } else {
            1
        };
        let channels = 0..draws as u64;
        Ok(channels
            .map(|channel| self.draw_phases(&magnitudes, draw, channel))
            .collect())
    }

    fn draw_phases(&self, magnitudes: &[f64], draw: &Draw, channel: u64) -> Vec<Complex64> {
        let realization = draw.realization as u64;
        let phases = match (self.phases, draw.phasing) {
            (Phases::LowCrest, _) => low_crest_phases(&self.grid.excited, magnitudes),
            (Phases::Random, phasing) => {
                let mut rng = match phasing {
                    Phasing::Independent => {
                        random::stream(draw.seed, "phases", &[realization, channel])
                    }
                    Phasing::Orthogonal | Phasing::SignFlip => {
                        random::stream(draw.seed, "phases", &[realization])
                    }
                };
                magnitudes.iter().map(|_| random::phase(&mut rng)).collect()
            }
        };
        magnitudes
            .iter()
            .zip(phases)
            .map(|(&magnitude, phase)| Complex64::from_polar(magnitude, phase))
            .collect()
    }
}

/// True peak per channel and experiment; a phase that came before, or its opposite, is not searched
/// again.
fn true_peaks(drawn: &[TurnedSum], phasing: Phasing, n_inputs: usize) -> Vec<Vec<f64>> {
    let mut known: Vec<(usize, f64, f64)> = Vec::new();
    let mut peak_of = |channel: usize, experiment: usize| {
        let half_turn = phasing
            .phase_rad(channel, experiment, n_inputs)
            .rem_euclid(PI);
        let draw = channel % drawn.len();
        let same =
            |&&(d, turn, _): &&(usize, f64, f64)| d == draw && (turn - half_turn).abs() < 1e-12;
        if let Some(&(_, _, peak)) = known.iter().find(same) {
            return peak;
        }
        let peak = drawn[draw].true_peak(Complex64::cis(half_turn));
        known.push((draw, half_turn, peak));
        peak
    };
    (0..n_inputs)
        .map(|channel| {
            (0..n_inputs)
                .map(|experiment| peak_of(channel, experiment))
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::s;
    use std::f64::consts::TAU;

    use crate::excitation::grid::{GridDesign, GridKind};
    use crate::number::power::sample_peak;

    fn multisine() -> Multisine {
        let grid = GridDesign {
            low_hz: 1.0,
            high_hz: 60.0,
            sample_time_s: 1e-3,
            resolution_hz: 0.1,
            n_lines: Some(80),
            kind: GridKind::Odd,
            seed: 0,
        };
        Multisine {
            grid: grid.design().expect("sound"),
            shape: Profile::constant(1.0),
            phases: Phases::Random,
        }
    }

    fn draw(peak: &[f64]) -> Draw<'_> {
        Draw {
            seed: 1,
            realization: 0,
            phasing: Phasing::Orthogonal,
            peak,
        }
    }

    #[test]
    fn one_factor_serves_all_and_no_channel_exceeds_its_peak() {
        let peaks = [150.0, 100.0, 50.0];
        for phasing in [Phasing::Orthogonal, Phasing::SignFlip, Phasing::Independent] {
            let realization = multisine()
                .realize(&Draw {
                    phasing,
                    ..draw(&peaks)
                })
                .expect("sound");
            let reached = realization
                .peak
                .iter()
                .zip(peaks)
                .map(|(reached, limit)| reached / limit)
                .fold(0.0, f64::max);
            assert!(
                (reached - 1.0).abs() < 1e-12,
                "the largest channel touches its peak: {reached}"
            );
            for (channel, &peak) in realization.peak.iter().enumerate() {
                for experiment in 0..3 {
                    assert!(
                        sample_peak(
                            &realization
                                .signal
                                .slice(s![experiment, channel, ..])
                                .to_vec()
                        ) <= peak * (1.0 + 1e-12)
                    );
                }
            }
        }
    }

    #[test]
    fn only_the_excited_lines_carry_power_and_channels_differ_by_the_phasing() {
        let signal = multisine()
            .realize(&draw(&[1.0, 1.0, 1.0]))
            .expect("sound")
            .signal;
        let n = signal.len_of(ndarray::Axis(2));
        let line = |experiment: usize, channel: usize, k: usize| {
            let row = signal.slice(s![experiment, channel, ..]);
            row.iter()
                .enumerate()
                .map(|(i, x)| x * Complex64::cis(-TAU * ((k * i) % n) as f64 / n as f64))
                .sum::<Complex64>()
                * 2.0
                / n as f64
        };
        let amplitude = line(0, 0, 13).norm();
        assert!(
            line(0, 0, 14).norm() < 1e-13 && (line(2, 1, 737).norm() - amplitude).abs() < 1e-13
        );
        let turn = line(2, 1, 13) / line(0, 0, 13);
        assert!((turn - Complex64::cis(Phasing::Orthogonal.phase_rad(1, 2, 3))).norm() < 1e-10);
    }

    #[test]
    fn the_shape_sets_the_ratios_of_the_lines() {
        let shaped = Multisine {
            shape: Profile {
                points: vec![(30.0, 2.0), (40.0, 1.0)],
            },
            ..multisine()
        };
        let signal = shaped.realize(&draw(&[1.0])).expect("sound").signal;
        let row: Vec<f64> = signal.iter().copied().collect();
        let n = row.len();
        let line = |k: usize| {
            row.iter()
                .enumerate()
                .map(|(i, x)| x * Complex64::cis(-TAU * ((k * i) % n) as f64 / n as f64))
                .sum::<Complex64>()
                .norm()
        };
        assert!((line(13) / line(737) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn bad_peaks_and_shapes_are_refused() {
        for peak in [vec![], vec![0.0], vec![f64::NAN], vec![1.0, -1.0]] {
            assert!(multisine().realize(&draw(&peak)).is_err());
        }
        let silent = Multisine {
            shape: Profile::constant(0.0),
            ..multisine()
        };
        assert!(silent.realize(&draw(&[1.0])).is_err());
    }
}
