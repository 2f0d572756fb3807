//! Excitation: what is injected, as a torque or as a velocity. A kind of excitation is a folder
//! here (the waveform in `mod.rs`, the table of a description in `design.rs`) and a variant below.

mod chirp;
mod design;
mod grid;
mod multisine;
mod phasing;
mod profile;
mod stepped_sine;
mod waveform;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use chirp::{Chirp, ChirpDesign};
pub use design::{Design, Target};
pub use grid::{GridDesign, GridKind, LineGrid};
pub use multisine::{Multisine, MultisineDesign, Phases, Realization};
pub use phasing::Phasing;
pub use profile::{Amplitude, Profile};
pub use stepped_sine::{Dwell, SteppedSine, SteppedSineDesign};
pub use waveform::{Draw, Fact, GoOn, Waveform};

/// What excites the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Excitation {
    /// A periodic multisine, repeated back to back.
    Multisine(Multisine),
    /// A chirp, once per run.
    Chirp(Chirp),
    /// A stepped sine, once per run.
    SteppedSine(SteppedSine),
}

impl Excitation {
    /// Its waveform, whichever kind it is.
    #[must_use]
    pub fn waveform(&self) -> &dyn Waveform {
        match self {
            Self::Multisine(multisine) => multisine,
            Self::Chirp(chirp) => chirp,
            Self::SteppedSine(stepped) => stepped,
        }
    }
}

/// The quantity the reference stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
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
