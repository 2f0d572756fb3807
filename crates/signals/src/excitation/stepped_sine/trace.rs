//! Trace of a stepped sine: its phase and the amplitudes of its channels, sample by sample.

use crate::error::SignalError;
use crate::excitation::stepped_sine::SteppedSine;
use crate::excitation::stepped_sine::sine_ramp::{SineRamp, advance_rad};

/// Takes a sample with the phase in rad and the amplitude of each channel.
type Put<'a> = dyn FnMut(usize, f64, &[f64]) + 'a;

/// A trace up to a sample, at which its phase runs on without a jump.
struct Trace<'a> {
    sample_time_s: f64,
    sample: usize,
    phase_rad: f64,
    put: &'a mut Put<'a>,
}

impl SteppedSine {
    /// Gives every sample to `put`.
    pub(super) fn trace<'a>(
        &self,
        sample_time_s: f64,
        n_inputs: usize,
        put: &'a mut Put<'a>,
    ) -> Result<(), SignalError> {
        let dwells = self.dwells(sample_time_s)?;
        let mut trace = Trace {
            sample_time_s,
            sample: 0,
            phase_rad: 0.0,
            put,
        };
        // at rest before the first and behind the last, at their frequencies
        let rest = vec![0.0; n_inputs];
        let (mut hz, mut amplitudes) = (dwells[0].hz, rest.clone());
        for dwell in &dwells {
            let next = self.amplitudes(n_inputs, dwell.hz);
            let ramp = dwell.arrival - dwell.start;
            trace.glide([hz, dwell.hz], [&amplitudes, &next], ramp);
            trace.stay(dwell.hz, &next, dwell.measured.end - dwell.arrival);
            (hz, amplitudes) = (dwell.hz, next);
        }
        let ramp = self.ramp_samples(sample_time_s);
        trace.glide([hz, hz], [&amplitudes, &rest], ramp);
        Ok(())
    }

    /// Amplitude of every channel at a frequency in Hz.
    fn amplitudes(&self, n_inputs: usize, hz: f64) -> Vec<f64> {
        let profiles = self.amplitude.iter().cycle().take(n_inputs);
        profiles.map(|profile| profile.at(hz)).collect()
    }
}

impl Trace<'_> {
    /// Glides from one frequency in Hz and its amplitudes to the next.
    fn glide(&mut self, [from_hz, to_hz]: [f64; 2], [from, to]: [&[f64]; 2], samples: usize) {
        let ramp = SineRamp {
            from_hz,
            to_hz,
            samples,
            sample_time_s: self.sample_time_s,
        };
        for k in 0..samples {
            let phase_rad = self.phase_rad + ramp.phase_at(k);
            (self.put)(self.sample + k, phase_rad, &ramp.between(k, from, to));
        }
        self.sample += samples;
        self.phase_rad += ramp.phase_at(samples);
    }

    /// Stays at a frequency in Hz and its amplitudes.
    fn stay(&mut self, hz: f64, amplitudes: &[f64], samples: usize) {
        for k in 0..samples {
            let phase_rad = self.phase_rad + advance_rad(hz, k, self.sample_time_s);
            (self.put)(self.sample + k, phase_rad, amplitudes);
        }
        self.sample += samples;
        self.phase_rad += advance_rad(hz, samples, self.sample_time_s);
    }
}
