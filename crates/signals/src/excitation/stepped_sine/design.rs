//! Table `[stepped_sine]` of a description.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::Excitation;
use crate::excitation::design::{Design, Target};
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Amplitude;
use crate::excitation::stepped_sine::SteppedSine;

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
    /// Amplitude in the unit of each channel, where `[channels]` stand in the place of a robot: a
    /// number, or points.
    pub amplitude: Option<Vec<Amplitude>>,
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

impl Design for SteppedSineDesign {
    fn phasing(&self) -> Phasing {
        self.mimo
    }

    fn excitation(&self, target: &Target) -> Result<Excitation, SignalError> {
        Ok(Excitation::SteppedSine(SteppedSine {
            low_hz: self.low_hz,
            high_hz: self.high_hz,
            n_frequencies: self.n_frequencies,
            amplitude: target.profiles([
                &self.amplitude_nm,
                &self.amplitude_rad_s,
                &self.amplitude,
            ])?,
            ramp_s: self.ramp_s,
            settle_s: self.settle_s,
            periods: self.periods,
            measure_s: self.measure_s,
        }))
    }
}
