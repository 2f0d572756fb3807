//! Exponential chirps with an amplitude over frequency, SK15 (15) and (16).

use std::f64::consts::{PI, TAU};

use ndarray::{Array3, Axis};
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Profile;
use crate::number::checks::{LONGEST_SIGNAL, not_negative, positive};

/// A sine whose frequency runs exponentially from `low_hz` to `high_hz`:
/// `r(t) = A(f(t)) sin(phi(t) + phase)` with `f(t) = low_hz e^{a t}`,
/// `a = ln(high_hz/low_hz)/duration_s`, `phi(t) = 2 pi (f(t) - low_hz)/a`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chirp {
    /// Frequency at the start in Hz.
    pub low_hz: f64,
    /// Frequency at the end in Hz.
    pub high_hz: f64,
    /// Length of the sweep in s, without the tail.
    pub duration_s: f64,
    /// Amplitude over frequency: one profile for every channel, or one for each, in the unit of the
    /// reference.
    pub amplitude: Vec<Profile>,
    /// Length of the half-cosine fades at both ends of the sweep in s; 0 for none.
    pub fade_s: f64,
    /// Rest after the sweep in s, recorded until the response has died out.
    pub tail_s: f64,
}

impl Chirp {
    /// Checks band, duration, fades, tail and profiles.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] naming the first value out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("low_hz", self.low_hz)?;
        positive("high_hz", self.high_hz)?;
        positive("duration_s", self.duration_s)?;
        not_negative("fade_s", self.fade_s)?;
        not_negative("tail_s", self.tail_s)?;
        if self.high_hz <= self.low_hz {
            return Err(SignalError::Parameter {
                key: "high_hz",
                found: self.high_hz,
                needed: "a frequency above low_hz",
            });
        }
        if 2.0 * self.fade_s > self.duration_s {
            return Err(SignalError::Parameter {
                key: "fade_s",
                found: self.fade_s,
                needed: "at most half of duration_s",
            });
        }
        self.amplitude.iter().try_for_each(Profile::check)
    }

    /// Growth rate `a` of the frequency in 1/s.
    fn rate(&self) -> f64 {
        (self.high_hz / self.low_hz).ln() / self.duration_s
    }

    /// Instantaneous frequency in Hz at `time_s` after the start.
    #[must_use]
    pub fn frequency_at(&self, time_s: f64) -> f64 {
        self.low_hz * (self.rate() * time_s).exp()
    }

    /// Time in s after the start at which the chirp passes `hz`: exact, SK15 (16) inverted.
    #[must_use]
    pub fn instant_of(&self, hz: f64) -> f64 {
        (hz / self.low_hz).ln() / self.rate()
    }

    /// Phase in rad at `time_s`: 2 pi times the integral of the frequency.
    fn phase_at(&self, time_s: f64) -> f64 {
        TAU * self.low_hz * (self.rate() * time_s).exp_m1() / self.rate()
    }

    /// Factor of the fades at `time_s`, 0 outside the sweep.
    fn fade_at(&self, time_s: f64) -> f64 {
        let from_end = time_s.min(self.duration_s - time_s);
        if from_end < 0.0 {
            0.0
        } else if from_end < self.fade_s {
            0.5 - 0.5 * (PI * from_end / self.fade_s).cos()
        } else {
            1.0
        }
    }

    /// Number of samples of sweep and tail.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] if they are none or more than 2^26.
    pub fn n_samples(&self, sample_time_s: f64) -> Result<usize, SignalError> {
        let found = ((self.duration_s + self.tail_s) / sample_time_s).round();
        if (1.0..=LONGEST_SIGNAL).contains(&found) {
            Ok(found as usize)
        } else {
            Err(SignalError::Derived {
                key: "duration_s",
                quantity: "number of samples of the chirp",
                found,
                needed: "between 1 and 2^26",
            })
        }
    }

    /// The chirp of every experiment and channel, `(experiment, input, sample)`, tail included.
    ///
    /// # Errors
    /// A parameter out of range, a band that reaches Nyquist, or neither one profile nor `n_inputs`
    /// of them.
    pub fn sample(
        &self,
        sample_time_s: f64,
        n_inputs: usize,
        phasing: Phasing,
    ) -> Result<Array3<f64>, SignalError> {
        self.check()?;
        positive("sample_time_s", sample_time_s)?;
        let nyquist_hz = 0.5 / sample_time_s;
        if self.high_hz >= nyquist_hz {
            return Err(SignalError::AboveNyquist {
                high_hz: self.high_hz,
                nyquist_hz,
                sample_time_s,
            });
        }
        if phasing == Phasing::Independent {
            return Err(SignalError::Parameter {
                key: "phasing `independent` of a chirp, with lines",
                found: 1.0,
                needed: "many lines with random phases, a multisine; take `orthogonal` or `sign-flip`",
            });
        }
        if n_inputs == 0 || (self.amplitude.len() != 1 && self.amplitude.len() != n_inputs) {
            let needed = format!(
                "one profile for all, or one for each of the {n_inputs} inputs (at least one)"
            );
            return Err(SignalError::Shape {
                name: "amplitude",
                found: vec![self.amplitude.len()],
                needed,
            });
        }
        let turn = |channel, experiment| phasing.phase_rad(channel, experiment, n_inputs);
        let mut signal = Array3::zeros((n_inputs, n_inputs, self.n_samples(sample_time_s)?));
        for (k, mut now) in signal.axis_iter_mut(Axis(2)).enumerate() {
            let time_s = k as f64 * sample_time_s;
            let (fade, hz, phase) = (
                self.fade_at(time_s),
                self.frequency_at(time_s),
                self.phase_at(time_s),
            );
            if fade > 0.0 {
                for channel in 0..n_inputs {
                    let amplitude = fade * self.amplitude[channel % self.amplitude.len()].at(hz);
                    for experiment in 0..n_inputs {
                        now[[experiment, channel]] =
                            amplitude * (phase + turn(channel, experiment)).sin();
                    }
                }
            }
        }
        Ok(signal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chirp() -> Chirp {
        Chirp {
            low_hz: 1.0,
            high_hz: 60.0,
            duration_s: 20.0,
            amplitude: vec![Profile::constant(150.0)],
            fade_s: 0.0,
            tail_s: 0.0,
        }
    }

    #[test]
    fn instants_are_exact_and_the_phase_is_the_integral_of_the_frequency() {
        for hz in [1.0, 7.3, 60.0] {
            assert!((chirp().frequency_at(chirp().instant_of(hz)) - hz).abs() < 1e-12 * hz);
        }
        assert!((chirp().instant_of(60.0) - 20.0).abs() < 1e-12);
        let (time_s, step_s) = (11.0, 1e-4);
        let slope = (chirp().phase_at(time_s + step_s) - chirp().phase_at(time_s - step_s))
            / (2.0 * step_s)
            / TAU;
        assert!((slope - chirp().frequency_at(time_s)).abs() < 1e-6);
    }

    #[test]
    fn fades_and_tail_start_and_end_at_rest() {
        let soft = Chirp {
            fade_s: 0.1,
            tail_s: 1.0,
            ..chirp()
        };
        let signal = soft.sample(1e-3, 2, Phasing::Orthogonal).expect("sound");
        assert_eq!(signal.shape(), [2, 2, 21_000]);
        assert_eq!(signal[[0, 0, 0]], 0.0);
        assert!(signal[[0, 0, 19_999]].abs() < 0.1 && signal[[0, 0, 20_500]] == 0.0);
        assert!(
            (signal[[1, 1, 10_000]] + signal[[0, 1, 10_000]]).abs() < 1e-9,
            "phase pi flips the sign"
        );
    }

    #[test]
    fn each_channel_follows_its_own_profile() {
        let table = [(100.0, 50.0), (150.0, 75.0), (120.0, 60.0)].map(|(low, high)| Profile {
            points: vec![(36.0, low), (44.0, high)],
        });
        let signal = Chirp {
            amplitude: table.to_vec(),
            ..chirp()
        }
        .sample(1e-3, 3, Phasing::SignFlip)
        .expect("sound");
        let peak = |channel: usize, from: usize, to: usize| {
            (from..to)
                .map(|k| signal[[0, channel, k]].abs())
                .fold(0.0, f64::max)
        };
        assert!(
            (peak(1, 0, 15_000) - 150.0).abs() < 0.1
                && (peak(2, 19_500, 20_000) - 60.0).abs() < 1.0
        );
    }

    #[test]
    fn bad_chirps_are_refused() {
        for bad in [
            Chirp {
                low_hz: f64::NAN,
                ..chirp()
            },
            Chirp {
                high_hz: 1.0,
                ..chirp()
            },
            Chirp {
                duration_s: -1.0,
                ..chirp()
            },
            Chirp {
                fade_s: 11.0,
                ..chirp()
            },
            Chirp {
                high_hz: 500.0,
                ..chirp()
            },
            Chirp {
                amplitude: vec![],
                ..chirp()
            },
            Chirp {
                amplitude: vec![Profile::constant(-1.0)],
                ..chirp()
            },
        ] {
            assert!(bad.sample(1e-3, 1, Phasing::Orthogonal).is_err(), "{bad:?}");
        }
        assert!(chirp().sample(1e-3, 2, Phasing::Independent).is_err());
    }
}
