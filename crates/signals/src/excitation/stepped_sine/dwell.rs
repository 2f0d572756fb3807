//! Dwells of a stepped sine: its frequencies and the samples of each.

use std::ops::Range;

use crate::error::SignalError;
use crate::excitation::stepped_sine::SteppedSine;
use crate::number::checks::{LONGEST_SIGNAL, at_most, below_nyquist, positive};
use crate::number::spacing::log_spaced;

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
    /// Every frequency with its samples, on a clock of `sample_time_s`.
    ///
    /// # Errors
    /// [`SignalError`] for a band that reaches Nyquist, frequencies too close to be told apart, or
    /// more than 2^26 samples.
    pub fn dwells(&self, sample_time_s: f64) -> Result<Vec<Dwell>, SignalError> {
        self.check()?;
        positive("sample_time_s", sample_time_s)?;
        below_nyquist(self.high_hz, sample_time_s)?;
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
                let found = self.n_frequencies as f64;
                return Err(SignalError::parameter("n_frequencies", found, needed));
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
    pub(super) fn ramp_samples(&self, sample_time_s: f64) -> usize {
        (self.ramp_s / sample_time_s).round() as usize
    }
}
