//! Distortion levels: what the lines that a multisine leaves out show of noise, odd and even
//! nonlinearities.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Levels of noise and nonlinear distortion at every input and output.
///
/// Every level is the rms of one line, sqrt(2) |X| / N in the unit of the signal, in one realization:
/// the square of that at an output is the power of `Y_S`, which makes [`crate::Frf::nonlinear_variance`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Distortion {
    /// One for each input of the plant.
    pub inputs: Vec<SignalLevels>,
    /// One for each output, what the plant answers to its input on these lines taken off.
    pub outputs: Vec<SignalLevels>,
}

/// Levels of one signal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SignalLevels {
    /// Odd lines that are not excited, in groups, rising.
    pub odd: Vec<DistortionLevel>,
    /// Even lines.
    pub even: Vec<DistortionLevel>,
}

/// Levels of one signal in a group of lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DistortionLevel {
    /// Geometric mean of the first and the last line of the group in Hz.
    pub frequency_hz: f64,
    /// Number of lines.
    pub n_lines: usize,
    /// Of an excited line there.
    pub excited: f64,
    /// Of the noise of one period; `None` where no two periods tell.
    pub noise: Option<f64>,
    /// Of the distortion, the noise taken off; with it where that is not known. `None` where it does not stand out
    /// of the noise.
    pub level: Option<f64>,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

impl Distortion {
    /// Every group of every signal.
    pub fn levels(&self) -> impl Iterator<Item = &DistortionLevel> {
        let signals = self.inputs.iter().chain(&self.outputs);
        signals.flat_map(|signal| signal.odd.iter().chain(&signal.even))
    }

    /// Whether the noise is known, so that the levels are without it.
    #[must_use]
    pub fn is_without_noise(&self) -> bool {
        self.levels().all(|level| level.noise.is_some())
    }
}

/// Median over groups of a level over that of the excited lines, in dB; `-inf` where half of them do not stand out,
/// `None` without groups or excitation.
#[must_use]
pub fn median_db(
    groups: &[DistortionLevel],
    level: impl Fn(&DistortionLevel) -> Option<f64>,
) -> Option<f64> {
    let ratio = |group: &DistortionLevel| level(group).unwrap_or(0.0) / group.excited;
    let db: Vec<f64> = groups
        .iter()
        .map(|group| 20.0 * ratio(group).log10())
        .collect();
    crate::median(db).filter(|db| !db.is_nan() && *db < f64::INFINITY)
}
