//! Stepped sine: one frequency after the other, each approached, settled and measured over whole
//! periods (Pintelon, Schoukens, System Identification, 2nd ed. 2012, section 5.2.2).

use std::ops::Range;

use ndarray::{Array3, s};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::Excitation;
use crate::excitation::design::{Design, Target};
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::{Amplitude, Profile};
use crate::excitation::sine_ramp::{SineRamp, advance_rad};
use crate::excitation::waveform::{Draw, Fact, Waveform};
use crate::number::checks::{LONGEST_SIGNAL, at_most, not_negative, positive};
use crate::number::format::{band, count, significant};
use crate::number::spacing::log_spaced;

/// A sine that dwells at one frequency after the other, from `low_hz` to `high_hz`. A dwell is a
/// ramp, in which frequency and amplitude glide over from the dwell before, a time to settle, and
/// whole periods that are measured; the phase runs through without a jump.
///
/// The frequencies are spaced logarithmically and moved a little, so that the measured periods fill
/// whole samples: p periods in M samples of T are p / (M T).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SteppedSine {
    /// Lowest frequency in Hz, the first.
    pub low_hz: f64,
    /// Highest frequency in Hz, the last.
    pub high_hz: f64,
    /// Number of frequencies.
    pub n_frequencies: usize,
    /// Amplitude over frequency: one profile for every channel, or one for each, in the unit of the
    /// reference.
    pub amplitude: Vec<Profile>,
    /// Length of a ramp in s; one more brings the last dwell to rest.
    pub ramp_s: f64,
    /// Time at a frequency in s before it is measured.
    pub settle_s: f64,
    /// Least number of measured periods.
    pub periods: usize,
    /// Least measured time in s.
    pub measure_s: f64,
}

/// A stepped sine: the table `[stepped_sine]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SteppedSineDesign {
    /// Lowest frequency in Hz, the first.
    pub low_hz: f64,
    /// Highest frequency in Hz, the last.
    pub high_hz: f64,
    /// Number of frequencies, logarithmically spaced.
    pub n_frequencies: usize,
    /// Amplitude of the motor torque in N m, one for each input: a number, or points [[Hz, value],
    /// ...]; open loop.
    pub amplitude_nm: Option<Vec<Amplitude>>,
    /// Amplitude of the reference velocity in rad/s, one for each input: a number, or points;
    /// closed loop.
    pub amplitude_rad_s: Option<Vec<Amplitude>>,
    /// Time in s in which frequency and amplitude glide to the next.
    #[serde(default = "default_ramp_s")]
    pub ramp_s: f64,
    /// Time in s at each frequency before it is measured, until the transient has died out.
    #[serde(default = "default_settle_s")]
    pub settle_s: f64,
    /// Measured periods of each frequency, at least.
    #[serde(default = "default_periods")]
    pub periods: usize,
    /// Measured time of each frequency in s, at least.
    #[serde(default)]
    pub measure_s: f64,
    /// How the experiments differ: sign-flip, one-at-a-time or orthogonal.
    #[serde(default = "default_phasing")]
    pub mimo: Phasing,
}

fn default_ramp_s() -> f64 {
    0.2
}

fn default_settle_s() -> f64 {
    1.0
}

fn default_periods() -> usize {
    10
}

fn default_phasing() -> Phasing {
    Phasing::SignFlip
}

/// One frequency of a stepped sine and its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Dwell {
    /// Frequency in Hz.
    pub hz: f64,
    /// Periods in the measured samples.
    pub periods: usize,
    /// Sample at which the ramp to this frequency begins.
    pub start: usize,
    /// Sample at which the ramp is over.
    pub arrival: usize,
    /// Samples that are measured.
    pub measured: Range<usize>,
}

impl SteppedSine {
    /// Checks every number but those that belong to the inputs.
    ///
    /// # Errors
    /// [`SignalError`] naming the first value out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("low_hz", self.low_hz)?;
        positive("high_hz", self.high_hz)?;
        not_negative("ramp_s", self.ramp_s)?;
        not_negative("settle_s", self.settle_s)?;
        positive("periods", self.periods as f64)?;
        not_negative("measure_s", self.measure_s)?;
        if self.high_hz <= self.low_hz {
            return Err(SignalError::Parameter {
                key: "high_hz",
                found: self.high_hz,
                needed: "a frequency above low_hz",
            });
        }
        self.amplitude.iter().try_for_each(Profile::check)
    }

    /// Every frequency with its samples, on a clock of `sample_time_s`.
    ///
    /// # Errors
    /// [`SignalError`] for a band that reaches Nyquist, frequencies too close to be told apart, or
    /// more than 2^26 samples.
    pub fn dwells(&self, sample_time_s: f64) -> Result<Vec<Dwell>, SignalError> {
        self.check()?;
        positive("sample_time_s", sample_time_s)?;
        let nyquist_hz = 0.5 / sample_time_s;
        if self.high_hz >= nyquist_hz {
            let high_hz = self.high_hz;
            return Err(SignalError::AboveNyquist {
                high_hz,
                nyquist_hz,
                sample_time_s,
            });
        }
        at_most(
            "n_frequencies",
            "number of frequencies",
            self.n_frequencies as f64,
            1e6,
            "at most 10^6",
        )?;
        let mut dwells: Vec<Dwell> = Vec::with_capacity(self.n_frequencies);
        for asked_hz in log_spaced(self.low_hz, self.high_hz, self.n_frequencies)? {
            let before = dwells.last();
            let dwell = self.dwell(
                asked_hz,
                before.map_or(0, |d| d.measured.end),
                sample_time_s,
            )?;
            if before.is_some_and(|before| before.hz >= dwell.hz) {
                let needed = "frequencies far enough apart that each has whole samples of its own: \
                              fewer, or more periods";
                let (key, found) = ("n_frequencies", self.n_frequencies as f64);
                return Err(SignalError::Parameter { key, found, needed });
            }
            dwells.push(dwell);
        }
        Ok(dwells)
    }

    /// The dwell at the frequency nearest to one in Hz whose periods fill whole samples.
    fn dwell(&self, asked_hz: f64, start: usize, sample_time_s: f64) -> Result<Dwell, SignalError> {
        let periods = (self.periods as f64).max((self.measure_s * asked_hz).ceil());
        let samples = (periods / (asked_hz * sample_time_s)).round();
        let [ramp, settle] = [self.ramp_s, self.settle_s].map(|s| (s / sample_time_s).round());
        at_most(
            "low_hz",
            "samples of the stepped sine",
            start as f64 + 2.0 * ramp + settle + samples,
            LONGEST_SIGNAL,
            "at most 2^26: fewer frequencies or periods, a shorter time for each, or a higher low_hz",
        )?;
        let arrival = start + ramp as usize;
        let first = arrival + settle as usize;
        Ok(Dwell {
            hz: periods / (samples * sample_time_s),
            periods: periods as usize,
            start,
            arrival,
            measured: first..first + samples as usize,
        })
    }

    /// Samples of a ramp.
    fn ramp_samples(&self, sample_time_s: f64) -> usize {
        (self.ramp_s / sample_time_s).round() as usize
    }

    fn amplitude(&self, channel: usize, hz: f64) -> f64 {
        self.amplitude[channel % self.amplitude.len()].at(hz)
    }

    /// Phase in rad and, for each channel, amplitude of every sample, given to `put`.
    fn trace(
        &self,
        sample_time_s: f64,
        n_inputs: usize,
        put: &mut dyn FnMut(usize, f64, &[f64]),
    ) -> Result<(), SignalError> {
        let amplitudes = |hz: f64| -> Vec<f64> {
            (0..n_inputs)
                .map(|channel| self.amplitude(channel, hz))
                .collect()
        };
        let dwells = self.dwells(sample_time_s)?;
        // at rest before the first and behind the last, at their frequencies
        let (mut from_hz, mut from, mut phase) = (dwells[0].hz, vec![0.0; n_inputs], 0.0);
        for Dwell {
            hz,
            start,
            arrival,
            measured,
            ..
        } in &dwells
        {
            let to = amplitudes(*hz);
            let ramp = SineRamp {
                from_hz,
                to_hz: *hz,
                samples: arrival - start,
                sample_time_s,
            };
            for k in 0..ramp.samples {
                put(
                    start + k,
                    phase + ramp.phase_at(k),
                    &ramp.between(k, &from, &to),
                );
            }
            phase += ramp.phase_at(ramp.samples);
            for k in 0..measured.end - arrival {
                put(arrival + k, phase + advance_rad(*hz, k, sample_time_s), &to);
            }
            phase += advance_rad(*hz, measured.end - arrival, sample_time_s);
            (from_hz, from) = (*hz, to);
        }
        let (end, rest) = (dwells[dwells.len() - 1].measured.end, vec![0.0; n_inputs]);
        let samples = self.ramp_samples(sample_time_s);
        let ramp = SineRamp {
            from_hz,
            to_hz: from_hz,
            samples,
            sample_time_s,
        };
        for k in 0..samples {
            put(
                end + k,
                phase + ramp.phase_at(k),
                &ramp.between(k, &from, &rest),
            );
        }
        Ok(())
    }
}

impl Waveform for SteppedSine {
    fn name(&self) -> &'static str {
        "stepped-sine"
    }

    fn is_periodic(&self) -> bool {
        false
    }

    fn check_for(&self, n_inputs: usize) -> Result<(), SignalError> {
        self.check()?;
        if n_inputs == 0 || (self.amplitude.len() != 1 && self.amplitude.len() != n_inputs) {
            return Err(SignalError::Shape {
                name: "amplitude",
                found: vec![self.amplitude.len()],
                needed: format!(
                    "one profile for all, or one for each of the {n_inputs} inputs (at least one)"
                ),
            });
        }
        Ok(())
    }

    fn period_samples(&self, sample_time_s: f64) -> Result<usize, SignalError> {
        let dwells = self.dwells(sample_time_s)?;
        Ok(dwells[dwells.len() - 1].measured.end + self.ramp_samples(sample_time_s))
    }

    fn period(
        &self,
        sample_time_s: f64,
        n_inputs: usize,
        draw: &Draw,
    ) -> Result<Array3<f64>, SignalError> {
        self.check_for(n_inputs)?;
        if draw.phasing == Phasing::Independent {
            let what = "independent phases need many lines, a multisine; for a stepped sine take \
                        `sign-flip`, `one-at-a-time` or `orthogonal`";
            return Err(SignalError::Unfit {
                key: "mimo",
                what: what.to_owned(),
            });
        }
        let n_samples = self.period_samples(sample_time_s)?;
        let mut signal = Array3::zeros((n_inputs, n_inputs, n_samples));
        self.trace(
            sample_time_s,
            n_inputs,
            &mut |sample, phase_rad, amplitudes| {
                let mut now = signal.slice_mut(s![.., .., sample]);
                for ((experiment, channel), value) in now.indexed_iter_mut() {
                    let turn_rad = draw.phasing.phase_rad(channel, experiment, n_inputs);
                    let amplitude = draw.phasing.weight(channel, experiment) * amplitudes[channel];
                    *value = amplitude * (phase_rad + turn_rad).sin();
                }
            },
        )?;
        Ok(signal)
    }

    fn band_hz(&self) -> [f64; 2] {
        [self.low_hz, self.high_hz]
    }

    fn peaks(&self) -> Vec<f64> {
        self.amplitude.iter().map(Profile::peak).collect()
    }

    fn default_lead_in_s(&self) -> f64 {
        0.0
    }

    fn excited_s(&self, sample_time_s: f64) -> f64 {
        let samples = self.period_samples(sample_time_s).unwrap_or_default();
        samples as f64 * sample_time_s
    }

    fn seconds_in(&self, [low_hz, high_hz]: [f64; 2], sample_time_s: f64) -> Option<[f64; 2]> {
        const ROUNDING: f64 = 1e-9;
        // the upper edge belongs to the next band, but for that of the last band
        let is_last = high_hz >= self.high_hz * (1.0 - ROUNDING);
        let is_inside = |dwell: &Dwell| {
            let hz = dwell.hz.clamp(self.low_hz, self.high_hz);
            hz >= low_hz * (1.0 - ROUNDING) && (is_last || hz < high_hz * (1.0 - ROUNDING))
        };
        let mut dwells = self.dwells(sample_time_s).unwrap_or_default();
        dwells.retain(is_inside);
        let samples = match (dwells.first(), dwells.last()) {
            (Some(first), Some(last)) => [first.start, last.measured.end],
            _ => [0, 0],
        };
        Some(samples.map(|sample| sample as f64 * sample_time_s))
    }

    fn described(&self, _sample_time_s: f64) -> Vec<(&'static str, String)> {
        let (number, band) = (self.n_frequencies, band(self.band_hz()));
        let frequencies = if number == 1 {
            "frequency"
        } else {
            "frequencies"
        };
        let [ramp_s, settle_s, measure_s] =
            [self.ramp_s, self.settle_s, self.measure_s].map(|s| significant(s, 4));
        let periods = count(self.periods, "period");
        vec![
            (self.name(), format!("{number} {frequencies}, {band}")),
            (
                "each frequency",
                format!(
                    "ramp {ramp_s} s, settle {settle_s} s, measured over at least {periods} and \
                     {measure_s} s"
                ),
            ),
        ]
    }

    fn facts(&self) -> Vec<(&'static str, Fact)> {
        vec![("n_frequencies", Fact::Count(self.n_frequencies))]
    }
}

impl Design for SteppedSineDesign {
    fn phasing(&self) -> Phasing {
        self.mimo
    }

    fn excitation(&self, target: &Target) -> Result<Excitation, SignalError> {
        let keys = [
            ("amplitude_nm", &self.amplitude_nm),
            ("amplitude_rad_s", &self.amplitude_rad_s),
        ];
        let amplitude = target.of_injection(keys, Amplitude::check)?;
        Ok(Excitation::SteppedSine(SteppedSine {
            low_hz: self.low_hz,
            high_hz: self.high_hz,
            n_frequencies: self.n_frequencies,
            amplitude: amplitude.iter().map(Amplitude::profile).collect(),
            ramp_s: self.ramp_s,
            settle_s: self.settle_s,
            periods: self.periods,
            measure_s: self.measure_s,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const T: f64 = 1e-3;
    const DRAW: Draw = Draw {
        seed: 0,
        realization: 0,
        phasing: Phasing::SignFlip,
    };

    fn stepped() -> SteppedSine {
        let points = vec![(2.0, 100.0), (50.0, 20.0)];
        SteppedSine {
            low_hz: 1.0,
            high_hz: 60.0,
            n_frequencies: 17,
            amplitude: vec![Profile { points }],
            ramp_s: 0.3,
            settle_s: 0.4,
            periods: 3,
            measure_s: 0.25,
        }
    }

    #[test]
    fn every_frequency_is_measured_over_whole_periods_at_its_amplitude() {
        let (stepped, signal) = (stepped(), stepped().period(T, 1, &DRAW).expect("sound"));
        let dwells = stepped.dwells(T).expect("sound");
        assert_eq!(dwells.len(), 17);
        for (dwell, asked) in dwells.iter().zip(log_spaced(1.0, 60.0, 17).expect("sound")) {
            let n = dwell.measured.len() as f64;
            assert!((dwell.hz / asked - 1.0).abs() < 0.5 / n + 1e-12);
            assert!(dwell.periods >= 3 && n * T >= 0.25 - T);
            let window = signal.slice(s![0, 0, dwell.measured.clone()]);
            let turn = |k: usize| TAU * (dwell.periods * k) as f64 / n;
            let part = |of: fn(f64) -> f64| {
                let terms = window.iter().enumerate().map(|(k, r)| r * of(turn(k)));
                2.0 / n * terms.sum::<f64>()
            };
            let amplitude = part(f64::cos).hypot(part(f64::sin));
            assert!((amplitude / stepped.amplitude[0].at(dwell.hz) - 1.0).abs() < 1e-10);
            let power = window.iter().map(|r| r * r).sum::<f64>() / n;
            assert!(
                (2.0 * power / amplitude.powi(2) - 1.0).abs() < 1e-10,
                "one line and no other"
            );
        }
    }

    #[test]
    fn it_starts_and_ends_at_rest_and_never_jumps() {
        let stepped = stepped();
        let signal = stepped.period(T, 1, &DRAW).expect("sound");
        let signal = signal.slice(s![0, 0, ..]).to_vec();
        assert_eq!(Some(signal.len()), stepped.period_samples(T).ok());
        assert_eq!(signal[0], 0.0);
        assert!(signal[signal.len() - 1].abs() < 1e-2);
        let largest = signal
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(0.0, f64::max);
        // amplitude 100 at 2 Hz, 20 at 60 Hz: no slope exceeds what lies between
        assert!(largest < TAU * 20.0 * 60.0 * T * 1.7, "{largest}");
    }

    #[test]
    fn inputs_differ_by_the_phasing() {
        let of = |phasing| {
            stepped()
                .period(T, 3, &Draw { phasing, ..DRAW })
                .expect("sound")
        };
        let (flipped, single) = (of(Phasing::SignFlip), of(Phasing::OneAtATime));
        assert_eq!(flipped.slice(s![0, 1, ..]), single.slice(s![1, 1, ..]));
        assert!(
            (&flipped.slice(s![1, 1, ..]) + &flipped.slice(s![0, 1, ..]))
                .iter()
                .all(|x| x.abs() < 1e-9)
        );
        assert!(single.slice(s![1, 2, ..]).iter().all(|r| *r == 0.0));
        let error = stepped().period(
            T,
            1,
            &Draw {
                phasing: Phasing::Independent,
                ..DRAW
            },
        );
        assert_eq!(error.expect_err("no lines").path(), ["mimo"]);
    }

    #[test]
    fn bands_are_passed_one_after_the_other_and_leave_no_frequency_out() {
        let stepped = stepped();
        let dwells = stepped.dwells(T).expect("sound");
        let bands = [[1.0, 3.0], [3.0, 17.0], [17.0, 60.0]];
        let seconds = bands.map(|band| stepped.seconds_in(band, T).expect("passed"));
        let end_s = dwells[16].measured.end as f64 * T;
        assert_eq!((seconds[0][0], seconds[2][1]), (0.0, end_s));
        assert!(seconds.windows(2).all(|pair| pair[0][1] == pair[1][0]));
        assert_eq!(stepped.seconds_in([1.01, 1.02], T), Some([0.0, 0.0]));
    }

    #[test]
    fn what_cannot_be_is_refused_by_name() {
        let refused = |change: &dyn Fn(&mut SteppedSine)| {
            let mut stepped = stepped();
            change(&mut stepped);
            let error = stepped.period(T, 1, &DRAW).expect_err("out of range");
            error
                .path()
                .last()
                .map(|&key| key.to_owned())
                .unwrap_or_default()
        };
        assert_eq!(refused(&|s| s.high_hz = 500.0), "high_hz");
        assert_eq!(refused(&|s| s.high_hz = 0.5), "high_hz");
        assert_eq!(refused(&|s| s.low_hz = -1.0), "low_hz");
        assert_eq!(refused(&|s| s.low_hz = 1e-9), "low_hz");
        assert_eq!(refused(&|s| s.n_frequencies = 1), "n_frequencies");
        assert_eq!(refused(&|s| s.n_frequencies = 5000), "n_frequencies");
        assert_eq!(refused(&|s| s.n_frequencies = usize::MAX), "n_frequencies");
        assert_eq!(refused(&|s| s.periods = 0), "periods");
        assert_eq!(refused(&|s| s.ramp_s = f64::NAN), "ramp_s");
        assert_eq!(refused(&|s| s.settle_s = f64::INFINITY), "settle_s");
        assert_eq!(refused(&|s| s.measure_s = -1.0), "measure_s");
        assert_eq!(refused(&|s| s.amplitude = vec![]), "amplitude");
    }
}
