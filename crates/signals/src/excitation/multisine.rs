//! Random-phase multisines, SK15 (8) and (9): a grid of lines, an amplitude over frequency, and
//! their realizations.

use std::f64::consts::PI;

use ndarray::{Array3, indices};
use num_complex::Complex64;
use realfft::RealFftPlanner;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::design::{Design, Target};
use crate::excitation::grid::{GridDesign, GridKind, LineGrid};
use crate::excitation::harmonic_sum::{HarmonicSum, TurnedSum};
use crate::excitation::low_crest::low_crest_phases;
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Profile;
use crate::excitation::waveform::{Draw, Fact, Waveform};
use crate::excitation::{Excitation, Injection};
use crate::number::checks::positive;
use crate::number::format::{band, count, significant};
use crate::number::random;

/// How the phases of the lines are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
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
    /// Largest value that each channel may reach, in the unit of the injected quantity; as many as
    /// inputs.
    pub peak: Vec<f64>,
}

/// A random-phase multisine (SK15 section 4): the table `[multisine]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MultisineDesign {
    /// Lower end of the band in Hz.
    pub low_hz: f64,
    /// Upper end of the band in Hz.
    pub high_hz: f64,
    /// Largest spacing of the lines in Hz: the period becomes at least its inverse.
    pub resolution_hz: f64,
    /// Number of logarithmically spaced frequencies before those on the same line merge; every line
    /// without it.
    pub n_lines: Option<usize>,
    /// Lines that may be excited: odd, full or odd-random.
    #[serde(default)]
    pub grid: GridKind,
    /// Largest motor torque in N m, one for each input; for experiments in open loop.
    pub peak_nm: Option<Vec<f64>>,
    /// Largest reference velocity in rad/s, one for each input; for experiments in closed loop.
    pub peak_rad_s: Option<Vec<f64>>,
    /// Largest reference velocity as a share of the constant velocity beneath it, instead of
    /// `peak_rad_s`: below 1 the reference never changes its direction (SK15 takes 0.75).
    pub peak_of_velocity: Option<f64>,
    /// Shape of the amplitude over frequency as points [Hz, value]; only ratios count. Flat without
    /// it.
    pub shape: Option<Profile>,
    /// Random phases, or low-crest ones where no averaging over realizations is wanted.
    #[serde(default)]
    pub phases: Phases,
    /// Phases between channels and experiments: orthogonal, sign-flip, independent or
    /// one-at-a-time.
    #[serde(default)]
    pub mimo: Phasing,
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
    /// The same amplitude on every line of a grid, with random phases.
    #[must_use]
    pub fn flat(grid: LineGrid, peak: Vec<f64>) -> Self {
        Self {
            grid,
            shape: Profile::constant(1.0),
            phases: Phases::Random,
            peak,
        }
    }

    /// One period of every experiment and channel: SK15 (9), with ONE factor over all channels and
    /// experiments, the largest for which no channel exceeds its peak. A factor for each channel
    /// would spoil the orthogonality.
    ///
    /// # Errors
    /// A grid, shape or peak that is out of range.
    pub fn realize(&self, draw: &Draw) -> Result<Realization, SignalError> {
        let amplitudes = self.line_amplitudes(draw)?;
        let n_inputs = self.peak.len();
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
            let weight = draw.phasing.weight(channel, experiment);
            let turn = Complex64::from_polar(weight * factor * self.peak[channel], phase_rad);
            row.into_iter()
                .zip(drawn[channel % drawn.len()].samples(turn))
                .for_each(|(sample, value)| *sample = value);
        }
        let peak = true_peaks
            .iter()
            .zip(&self.peak)
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
        self.check_for(self.peak.len())?;
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
            self.peak.len()
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
                    Phasing::Orthogonal | Phasing::SignFlip | Phasing::OneAtATime => {
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

impl Waveform for Multisine {
    fn name(&self) -> &'static str {
        "multisine"
    }

    fn is_periodic(&self) -> bool {
        true
    }

    fn check_for(&self, n_inputs: usize) -> Result<(), SignalError> {
        self.grid.check()?;
        self.shape.check()?;
        if n_inputs == 0 || self.peak.len() != n_inputs {
            return Err(SignalError::Shape {
                name: "peak",
                found: vec![self.peak.len()],
                needed: format!("one peak for each of the {n_inputs} inputs, at least one"),
            });
        }
        self.peak
            .iter()
            .try_for_each(|&peak| positive("peak", peak))
    }

    fn period_samples(&self, _sample_time_s: f64) -> Result<usize, SignalError> {
        Ok(self.grid.n_samples)
    }

    fn period(
        &self,
        _sample_time_s: f64,
        _n_inputs: usize,
        draw: &Draw,
    ) -> Result<Array3<f64>, SignalError> {
        Ok(self.realize(draw)?.signal)
    }

    fn band_hz(&self) -> [f64; 2] {
        let period_s = self.grid.period_s();
        let at = |line: Option<&usize>| line.map_or(0.0, |line| *line as f64 / period_s);
        [at(self.grid.excited.first()), at(self.grid.excited.last())]
    }

    fn peaks(&self) -> Vec<f64> {
        self.peak.clone()
    }

    /// One period.
    fn default_lead_in_s(&self) -> f64 {
        self.grid.period_s()
    }

    fn excited_s(&self, _sample_time_s: f64) -> f64 {
        self.grid.period_s()
    }

    fn seconds_in(&self, _band_hz: [f64; 2], _sample_time_s: f64) -> Option<[f64; 2]> {
        None
    }

    fn described(&self, _sample_time_s: f64) -> Vec<(&'static str, String)> {
        let (band, period_s) = (band(self.band_hz()), self.grid.period_s());
        let lines = count(self.grid.excited.len(), "line");
        vec![
            (self.name(), format!("{lines}, {band}")),
            ("period T", format!("{} s", significant(period_s, 6))),
            (
                "line spacing f0",
                format!("{} Hz", significant(1.0 / period_s, 4)),
            ),
        ]
    }

    fn facts(&self) -> Vec<(&'static str, Fact)> {
        vec![
            ("fundamental_hz", Fact::Value(1.0 / self.grid.period_s())),
            ("n_lines", Fact::Count(self.grid.excited.len())),
        ]
    }
}

impl Design for MultisineDesign {
    fn phasing(&self) -> Phasing {
        self.mimo
    }

    fn excitation(&self, target: &Target) -> Result<Excitation, SignalError> {
        let design = GridDesign {
            low_hz: self.low_hz,
            high_hz: self.high_hz,
            sample_time_s: target.sample_time_s,
            resolution_hz: self.resolution_hz,
            n_lines: self.n_lines,
            kind: self.grid,
            seed: target.seed,
        };
        let peak = self.peak(target)?;
        Ok(Excitation::Multisine(Multisine {
            grid: design.design()?,
            shape: self.shape.clone().unwrap_or_else(|| Profile::constant(1.0)),
            phases: self.phases,
            peak,
        }))
    }

    fn ride(&self, excitation: &mut Excitation, velocity_rad_s: &[f64]) -> Result<(), SignalError> {
        let (Some(share), Excitation::Multisine(Multisine { peak, .. })) =
            (self.peak_of_velocity, excitation)
        else {
            return Ok(());
        };
        *peak = velocity_rad_s
            .iter()
            .map(|velocity| share * velocity.abs())
            .collect();
        if peak.iter().all(|peak| peak.is_finite() && *peak > 0.0) {
            return Ok(());
        }
        let what = format!(
            "{share} of the constant velocities {velocity_rad_s:?} rad/s leaves no peak; needed: a share \
             above 0 and a constant velocity on every axis"
        );
        Err(SignalError::Unfit {
            key: "peak_of_velocity",
            what,
        })
    }
}

impl MultisineDesign {
    /// Largest value per channel; 1 where it is put in its place when the velocity is known.
    fn peak(&self, target: &Target) -> Result<Vec<f64>, SignalError> {
        let keys = [("peak_nm", &self.peak_nm), ("peak_rad_s", &self.peak_rad_s)];
        if self.peak_of_velocity.is_none() {
            return target.of_injection(keys, |key, &peak| positive(key, peak));
        }
        let is_closed = target.injection == Injection::Velocity;
        if is_closed && self.peak_nm.is_none() && self.peak_rad_s.is_none() {
            return Ok(vec![1.0; target.n_inputs]);
        }
        let what =
            "a share of the velocity is for experiments in closed loop, and instead of another \
                    peak"
                .to_owned();
        Err(SignalError::Unfit {
            key: "peak_of_velocity",
            what,
        })
    }
}

/// True peak per channel and experiment; a phase that came before, or its opposite, is not searched
/// again.
fn true_peaks(drawn: &[TurnedSum], phasing: Phasing, n_inputs: usize) -> Vec<Vec<f64>> {
    let mut known: Vec<(usize, f64, f64)> = Vec::new();
    let mut peak_of = |channel: usize, experiment: usize| {
        if phasing.weight(channel, experiment) == 0.0 {
            return 0.0;
        }
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

    fn multisine(peak: &[f64]) -> Multisine {
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
            peak: peak.to_vec(),
        }
    }

    const DRAW: Draw = Draw {
        seed: 1,
        realization: 0,
        phasing: Phasing::Orthogonal,
    };

    #[test]
    fn one_factor_serves_all_and_no_channel_exceeds_its_peak() {
        let peaks = [150.0, 100.0, 50.0];
        for phasing in [Phasing::Orthogonal, Phasing::SignFlip, Phasing::Independent] {
            let realization = multisine(&peaks)
                .realize(&Draw { phasing, ..DRAW })
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
        let signal = multisine(&[1.0, 1.0, 1.0])
            .realize(&DRAW)
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
            ..multisine(&[1.0])
        };
        let signal = shaped.realize(&DRAW).expect("sound").signal;
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
    fn one_at_a_time_every_experiment_has_one_channel_at_its_peak() {
        let draw = Draw {
            phasing: Phasing::OneAtATime,
            ..DRAW
        };
        let drawn = multisine(&[3.0, 1.0]).realize(&draw).expect("sound");
        assert!(
            drawn
                .peak
                .iter()
                .zip([3.0, 1.0])
                .all(|(peak, limit)| (peak - limit).abs() < 1e-12)
        );
        for ((experiment, channel), row) in indices((2, 2)).into_iter().zip(drawn.signal.rows()) {
            assert_eq!(row.iter().any(|r| *r != 0.0), experiment == channel);
        }
    }

    #[test]
    fn bad_peaks_and_shapes_are_refused() {
        for peak in [vec![], vec![0.0], vec![f64::NAN], vec![1.0, -1.0]] {
            let error = multisine(&peak).realize(&DRAW).expect_err("a bad peak");
            assert_eq!(error.path(), ["peak"]);
        }
        let silent = Multisine {
            shape: Profile::constant(0.0),
            ..multisine(&[1.0])
        };
        assert!(matches!(
            silent.realize(&DRAW),
            Err(SignalError::Derived { key: "shape", .. })
        ));
    }
}
