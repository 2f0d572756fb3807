//! Tables of what excites the machine.

use frfid_signals::{GridKind, Phases, Phasing, Profile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A random-phase multisine (SK15 section 4).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MultisineTable {
    /// Lower end of the band in Hz.
    pub low_hz: f64,
    /// Upper end of the band in Hz.
    pub high_hz: f64,
    /// Largest spacing of the lines in Hz: the period becomes at least its inverse.
    pub resolution_hz: f64,
    /// Number of logarithmically spaced frequencies before those on the same line merge; every line
    /// without it.
    pub n_lines: Option<usize>,
    /// Lines that may be excited: odd, full or odd-random.
    #[serde(default)]
    #[schemars(with = "GridKindName")]
    pub grid: GridKind,
    /// Largest motor torque in N m, one for each input; for experiments in open loop.
    pub peak_nm: Option<Vec<f64>>,
    /// Largest reference velocity in rad/s, one for each input; for experiments in closed loop.
    pub peak_rad_s: Option<Vec<f64>>,
    /// Largest reference velocity as a share of the constant velocity beneath it, instead of
    /// `peak_rad_s`: below 1 the reference never changes its direction (SK15 takes 0.75).
    pub peak_of_velocity: Option<f64>,
    /// Shape of the amplitude over frequency as points [Hz, value]; only ratios count. Flat without
    /// it.
    #[schemars(with = "Option<Vec<[f64; 2]>>")]
    pub shape: Option<Profile>,
    /// Random phases, or low-crest ones where no averaging over realizations is wanted.
    #[serde(default)]
    #[schemars(with = "PhasesName")]
    pub phases: Phases,
    /// Phases between channels and experiments: orthogonal, sign-flip or independent.
    #[serde(default)]
    #[schemars(with = "PhasingName")]
    pub mimo: Phasing,
}

/// An exponential chirp (SK15 section 5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChirpTable {
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
    /// Length of the fades at both ends in s.
    #[serde(default)]
    pub fade_s: f64,
    /// Rest recorded after the sweep in s, until the response has died out.
    #[serde(default)]
    pub tail_s: f64,
    /// Phases between channels and experiments: orthogonal or sign-flip.
    #[serde(default)]
    #[schemars(with = "PhasingName")]
    pub mimo: Phasing,
}

/// A number, or points (Hz, value).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a number, or points [[Hz, value], ...]"
)]
pub enum Amplitude {
    /// The same at every frequency.
    Constant(f64),
    /// Values at frequencies, smooth in between.
    Points(Vec<(f64, f64)>),
}

impl Amplitude {
    /// The profile this stands for.
    #[must_use]
    pub fn profile(&self) -> Profile {
        match self {
            Self::Constant(amplitude) => Profile::constant(*amplitude),
            Self::Points(points) => Profile {
                points: points.clone(),
            },
        }
    }
}

/// Names of [`GridKind`] for the schema; the numeric crates do not know of schemas.
#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
#[allow(dead_code)]
enum GridKindName {
    Odd,
    Full,
    OddRandom,
}

/// Names of [`Phases`] for the schema.
#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
#[allow(dead_code)]
enum PhasesName {
    Random,
    LowCrest,
}

/// Names of [`Phasing`] for the schema.
#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
#[allow(dead_code)]
enum PhasingName {
    Orthogonal,
    SignFlip,
    Independent,
}
