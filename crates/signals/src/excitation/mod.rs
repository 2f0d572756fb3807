//! What is injected: a multisine or a chirp, as a torque or as a velocity.

pub(crate) mod chirp;
pub(crate) mod grid;
pub(crate) mod harmonic_sum;
pub(crate) mod low_crest;
pub(crate) mod multisine;
pub(crate) mod phasing;
pub(crate) mod profile;

use serde::{Deserialize, Serialize};

use crate::excitation::chirp::Chirp;
use crate::excitation::multisine::Multisine;
use crate::excitation::profile::Profile;

/// What excites the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Excitation {
    /// A periodic multisine, repeated back to back.
    Multisine {
        /// Lines, amplitude shape and phases.
        #[serde(flatten)]
        signal: Multisine,
        /// Largest value per channel, in the unit of the injected quantity.
        peak: Vec<f64>,
    },
    /// A chirp, once per run.
    Chirp(Chirp),
}

impl Excitation {
    /// Largest value per channel, in the unit of the injected quantity; for a chirp with one
    /// profile for all that of any.
    #[must_use]
    pub fn peaks(&self) -> Vec<f64> {
        match self {
            Self::Multisine { peak, .. } => peak.clone(),
            Self::Chirp(chirp) => chirp.amplitude.iter().map(Profile::peak).collect(),
        }
    }
}

/// The quantity the reference stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Injection {
    /// Motor torque in N m: open loop.
    #[default]
    Torque,
    /// Reference velocity in rad/s: closed loop; a constant velocity is part of the reference.
    Velocity,
}

impl Injection {
    /// Unit of the quantity.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Torque => "N m",
            Self::Velocity => "rad/s",
        }
    }
}
