//! Table `[chirp]` of a description.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::Excitation;
use crate::excitation::chirp::Chirp;
use crate::excitation::design::{Design, Target};
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Amplitude;

/// An exponential chirp (SK15 section 5): the table `[chirp]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChirpDesign {
    /// Frequency at the start in Hz.
    pub low_hz: f64,
    /// Frequency at the end in Hz.
    pub high_hz: f64,
    /// Length of the sweep in s.
    pub duration_s: f64,
    /// Amplitude of the motor torque in N m, one for each input: a number, or points [[Hz, value],
    /// ...]; open loop.
    pub amplitude_nm: Option<Vec<Amplitude>>,
    /// Amplitude of the reference velocity in rad/s, one for each input: a number, or points;
    /// closed loop.
    pub amplitude_rad_s: Option<Vec<Amplitude>>,
    /// Amplitude in the unit of each channel, where `[channels]` stand in the place of a robot: a
    /// number, or points.
    pub amplitude: Option<Vec<Amplitude>>,
    /// Length of the fades at both ends in s.
    #[serde(default)]
    pub fade_s: f64,
    /// Rest recorded after the sweep in s, until the response has died out.
    #[serde(default)]
    pub tail_s: f64,
    /// Phases between channels and experiments: orthogonal, sign-flip or one-at-a-time.
    #[serde(default)]
    pub mimo: Phasing,
}

impl Design for ChirpDesign {
    fn phasing(&self) -> Phasing {
        self.mimo
    }

    fn excitation(&self, target: &Target) -> Result<Excitation, SignalError> {
        Ok(Excitation::Chirp(Chirp {
            low_hz: self.low_hz,
            high_hz: self.high_hz,
            duration_s: self.duration_s,
            amplitude: target.profiles([
                &self.amplitude_nm,
                &self.amplitude_rad_s,
                &self.amplitude,
            ])?,
            fade_s: self.fade_s,
            tail_s: self.tail_s,
        }))
    }
}
