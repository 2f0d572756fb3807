//! Estimate of a plan's FRF, with what was found out on the way.

use std::iter::zip;

use frfid_estimate::{NoiseBias, PeriodIndex};
use frfid_signals::{Distortion, Frf, Harmonics};

use crate::estimate::loop_response::LoopResponse;
use crate::estimate::unsettled::Unsettled;

/// An FRF with what a careful reader should know besides.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// The FRF; lines that were left out are NaN.
    pub frf: Frf,
    /// The response of the loop that is asked for in place of the plant.
    pub(crate) response: Option<LoopResponse>,
    /// Levels of distortion, where the excitation leaves lines out.
    pub distortion: Option<Distortion>,
    /// Lines that were left out, realizations that were counted as repetitions, in words.
    pub remarks: Vec<String>,
    /// Number of lines that were left out.
    pub n_left_out: usize,
    /// Lines that noise on the input biases.
    pub noise_bias: Option<NoiseBias>,
    /// What has not settled from period to period, run by run.
    pub unsettled: Unsettled,
    /// Runs that were missing: their periods are not in the estimate.
    pub missing: Vec<PeriodIndex>,
    /// Whether what remains of the ripple exceeds the noise, line by line; `None` where it cannot
    /// be told: no glide was subtracted, or every reference was applied but once.
    pub ripple: Option<Vec<bool>>,
    /// Harmonics of a chirp; `None` of other excitations.
    pub harmonics: Option<Harmonics>,
}

impl Estimated {
    /// Frequencies in Hz at which what remains of the ripple exceeds the noise.
    #[must_use]
    pub fn disturbed_hz(&self) -> Vec<f64> {
        let lines = zip(&self.frf.frequency_hz, self.ripple.iter().flatten());
        lines
            .filter(|(_, exceeds)| **exceeds)
            .map(|(hz, _)| *hz)
            .collect()
    }
}
