//! Ramp from one sine to the next, and how far a phase advances.

use std::f64::consts::{PI, TAU};

/// Phase in rad that a frequency in Hz advances by in so many samples.
pub(crate) fn advance_rad(hz: f64, samples: usize, sample_time_s: f64) -> f64 {
    TAU * (hz * samples as f64 * sample_time_s).fract()
}

/// The way from one frequency and amplitude to the next, by a half-cosine.
pub(crate) struct SineRamp {
    pub from_hz: f64,
    pub to_hz: f64,
    pub samples: usize,
    pub sample_time_s: f64,
}

impl SineRamp {
    /// Phase in rad since its start at one of its samples: 2 pi times the integral of the frequency
    /// f0 + (f1 - f0) (1 - cos(pi x)) / 2.
    pub(crate) fn phase_at(&self, sample: usize) -> f64 {
        if self.samples == 0 {
            return 0.0;
        }
        let x = sample as f64 / self.samples as f64;
        let ramp_s = self.samples as f64 * self.sample_time_s;
        let risen = 0.5 * (x - (PI * x).sin() / PI);
        TAU * ramp_s * (self.from_hz * x + (self.to_hz - self.from_hz) * risen)
    }

    /// Amplitudes at one of its samples.
    pub(crate) fn between(&self, sample: usize, from: &[f64], to: &[f64]) -> Vec<f64> {
        let x = sample as f64 / self.samples as f64;
        let share = 0.5 * (1.0 - (PI * x).cos());
        let pairs = from.iter().zip(to);
        pairs.map(|(from, to)| from + (to - from) * share).collect()
    }
}
