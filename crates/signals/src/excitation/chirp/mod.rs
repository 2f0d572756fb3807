//! Exponential chirps with an amplitude over frequency, SK15 (15) and (16).

mod design;

use std::f64::consts::{PI, TAU};

use ndarray::{Array3, ArrayViewMut2, Axis};
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::{Profile, check_one_or_each};
use crate::excitation::waveform::{Draw, Fact, GoOn, Waveform};
use crate::number::checks::{LONGEST_SIGNAL, below_nyquist, not_negative, positive, require};
use crate::number::format::{band, significant};
use crate::number::room::{possible_inputs, zeros};

pub use design::ChirpDesign;

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
    /// [`SignalError`] naming the first value out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("low_hz", self.low_hz)?;
        positive("high_hz", self.high_hz)?;
        positive("duration_s", self.duration_s)?;
        not_negative("fade_s", self.fade_s)?;
        not_negative("tail_s", self.tail_s)?;
        let is_band = self.high_hz > self.low_hz;
        require("high_hz", self.high_hz, is_band, "a frequency above low_hz")?;
        let fits = 2.0 * self.fade_s <= self.duration_s;
        require("fade_s", self.fade_s, fits, "at most half of duration_s")?;
        self.amplitude.iter().try_for_each(Profile::check)
    }

    /// Growth rate `a` of the frequency in 1/s.
    #[must_use]
    pub fn rate(&self) -> f64 {
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

    /// `sin(n phi(t))` with the fades, amplitude 1, in `n_samples` that begin with the sweep.
    #[must_use]
    pub fn harmonic(&self, order: usize, sample_time_s: f64, n_samples: usize) -> Vec<f64> {
        let at = |time_s: f64| match self.fade_at(time_s) {
            0.0 => 0.0,
            fade => fade * (order as f64 * self.phase_at(time_s)).sin(),
        };
        let times_s = (0..n_samples).map(|k| k as f64 * sample_time_s);
        times_s.map(at).collect()
    }

    /// The chirp of every experiment and channel, `(experiment, input, sample)`, tail included.
    ///
    /// ```
    /// use frfid_signals::{Chirp, Phasing, Profile};
    ///
    /// let chirp = Chirp {
    ///     low_hz: 1.0,
    ///     high_hz: 60.0,
    ///     duration_s: 20.0,
    ///     amplitude: vec![Profile::constant(150.0)],
    ///     fade_s: 0.1,
    ///     tail_s: 1.0,
    /// };
    /// let signal = chirp.sample(1e-3, 2, Phasing::SignFlip)?;
    /// assert_eq!(signal.dim(), (2, 2, 21_000)); // (experiment, input, sample)
    /// # Ok::<(), frfid_signals::SignalError>(())
    /// ```
    ///
    /// # Errors
    /// A parameter out of range, a band that reaches Nyquist, neither one profile nor `n_inputs`
    /// of them, or more than can be held.
    pub fn sample(
        &self,
        sample_time_s: f64,
        n_inputs: usize,
        phasing: Phasing,
    ) -> Result<Array3<f64>, SignalError> {
        self.check_for(n_inputs)?;
        positive("sample_time_s", sample_time_s)?;
        below_nyquist(self.high_hz, sample_time_s)?;
        phasing.check_for_one_sine("a chirp", "`orthogonal` or `sign-flip`")?;
        possible_inputs(n_inputs)?;
        let n_samples = self.period_samples(sample_time_s)?;
        let mut signal = zeros("n_inputs", [n_inputs, n_inputs, n_samples])?;
        for (k, now) in signal.axis_iter_mut(Axis(2)).enumerate() {
            self.put_instant(k as f64 * sample_time_s, phasing, now);
        }
        Ok(signal)
    }

    /// The chirp of every experiment and channel at `time_s`, put into `(experiment, input)`.
    fn put_instant(&self, time_s: f64, phasing: Phasing, mut now: ArrayViewMut2<f64>) {
        let fade = self.fade_at(time_s);
        if fade == 0.0 {
            return;
        }
        let (hz, phase) = (self.frequency_at(time_s), self.phase_at(time_s));
        let n_inputs = now.ncols();
        for channel in 0..n_inputs {
            let amplitude = fade * self.amplitude[channel % self.amplitude.len()].at(hz);
            for experiment in 0..n_inputs {
                let turn = phasing.phase_rad(channel, experiment, n_inputs);
                now[[experiment, channel]] =
                    phasing.weight(channel, experiment) * amplitude * (phase + turn).sin();
            }
        }
    }
}

impl Waveform for Chirp {
    fn name(&self) -> &'static str {
        "chirp"
    }

    fn is_periodic(&self) -> bool {
        false
    }

    fn check_for(&self, n_inputs: usize) -> Result<(), SignalError> {
        self.check()?;
        check_one_or_each(&self.amplitude, n_inputs)
    }

    fn period_samples(&self, sample_time_s: f64) -> Result<usize, SignalError> {
        let found = ((self.duration_s + self.tail_s) / sample_time_s).round();
        if (1.0..=LONGEST_SIGNAL).contains(&found) {
            return Ok(found as usize);
        }
        let quantity = "number of samples of the chirp";
        let needed = "between 1 and 2^26";
        Err(SignalError::derived("duration_s", quantity, found, needed))
    }

    fn period(
        &self,
        sample_time_s: f64,
        n_inputs: usize,
        draw: &Draw,
        _go_on: GoOn,
    ) -> Result<Array3<f64>, SignalError> {
        self.sample(sample_time_s, n_inputs, draw.phasing)
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

    fn excited_s(&self, _sample_time_s: f64) -> f64 {
        self.duration_s
    }

    fn seconds_in(&self, band_hz: [f64; 2], _sample_time_s: f64) -> Option<[f64; 2]> {
        Some(band_hz.map(|hz| self.instant_of(hz.clamp(self.low_hz, self.high_hz))))
    }

    fn described(&self, sample_time_s: f64) -> Vec<(&'static str, String)> {
        let (band, duration_s) = (band(self.band_hz()), self.duration_s);
        let samples = self.period_samples(sample_time_s).unwrap_or_default();
        let whole_s = significant(samples as f64 * sample_time_s, 6);
        vec![(
            self.name(),
            format!("{band} in {duration_s} s, {whole_s} s with its tail"),
        )]
    }

    fn facts(&self) -> Vec<(&'static str, Fact)> {
        vec![("duration_s", Fact::Value(self.duration_s))]
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
        let refused = |change: fn(&mut Chirp), n_inputs, phasing| {
            let mut bad = chirp();
            change(&mut bad);
            let error = bad
                .sample(1e-3, n_inputs, phasing)
                .expect_err("a bad chirp");
            error.path().join(".")
        };
        let changed = |change| refused(change, 1, Phasing::Orthogonal);
        assert_eq!(changed(|chirp| chirp.low_hz = f64::NAN), "low_hz");
        assert_eq!(changed(|chirp| chirp.high_hz = 1.0), "high_hz");
        assert_eq!(changed(|chirp| chirp.duration_s = -1.0), "duration_s");
        assert_eq!(changed(|chirp| chirp.fade_s = 11.0), "fade_s");
        assert_eq!(changed(|chirp| chirp.high_hz = 500.0), "high_hz");
        assert_eq!(changed(|chirp| chirp.amplitude = vec![]), "amplitude");
        assert_eq!(
            changed(|chirp| chirp.amplitude = vec![Profile::constant(-1.0)]),
            "amplitude"
        );
        assert_eq!(refused(|_| (), 2, Phasing::Independent), "mimo");
    }
}
