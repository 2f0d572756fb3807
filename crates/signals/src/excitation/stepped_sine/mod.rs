//! Stepped sine: one frequency after the other, each approached, settled and measured over whole
//! periods (Pintelon, Schoukens, System Identification, 2nd ed. 2012, section 5.2.2).

mod design;
mod dwell;
mod sine_ramp;
#[cfg(test)]
mod tests;
mod trace;

use ndarray::{Array3, s};
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::profile::{Profile, check_one_or_each};
use crate::excitation::waveform::{Draw, Fact, GoOn, Waveform};
use crate::number::checks::{not_negative, positive, require};
use crate::number::format::{band, count, significant};
use crate::number::room::{possible_inputs, zeros};

pub use design::SteppedSineDesign;
pub use dwell::Dwell;

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
        let is_band = self.high_hz > self.low_hz;
        require("high_hz", self.high_hz, is_band, "a frequency above low_hz")?;
        self.amplitude.iter().try_for_each(Profile::check)
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
        check_one_or_each(&self.amplitude, n_inputs)
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
        _go_on: GoOn,
    ) -> Result<Array3<f64>, SignalError> {
        self.check_for(n_inputs)?;
        draw.phasing.check_for_one_sine(
            "a stepped sine",
            "`sign-flip`, `one-at-a-time` or `orthogonal`",
        )?;
        let n_samples = self.period_samples(sample_time_s)?;
        possible_inputs(n_inputs)?;
        let mut signal = zeros("n_inputs", [n_inputs, n_inputs, n_samples])?;
        let mut put = |sample: usize, phase_rad: f64, amplitudes: &[f64]| {
            let mut now = signal.slice_mut(s![.., .., sample]);
            for ((experiment, channel), value) in now.indexed_iter_mut() {
                let turn_rad = draw.phasing.phase_rad(channel, experiment, n_inputs);
                let amplitude = draw.phasing.weight(channel, experiment) * amplitudes[channel];
                *value = amplitude * (phase_rad + turn_rad).sin();
            }
        };
        self.trace(sample_time_s, n_inputs, &mut put)?;
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
