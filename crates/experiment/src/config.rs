//! `experiment.toml`: one description of robot, excitation, averaging, limits and estimator.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use frfid_estimate::Averaging;
use frfid_signals::{GridKind, Phases, Phasing, Profile};

use crate::robot::{ControllerTable, RobotTable};

/// An experiment, as `experiment.toml` describes it. Frequencies in Hz, everything else in SI units on the joint side of
/// the gear; the unit ends the name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Seed of every random number: phases of the excitation and noise of the simulated sensors.
    pub seed: u64,
    /// Sample time of the controller in s: the clock of references and records.
    pub sample_time_s: f64,
    /// The machine.
    pub robot: RobotTable,
    /// The controller; without this table the experiment runs in open loop and the reference is the motor torque.
    pub controller: Option<ControllerTable>,
    /// A random-phase multisine. Exactly one of `[multisine]` and `[chirp]` is needed.
    pub multisine: Option<MultisineTable>,
    /// An exponential chirp. Exactly one of `[multisine]` and `[chirp]` is needed.
    pub chirp: Option<ChirpTable>,
    /// How often what is repeated.
    #[serde(default)]
    pub averaging: AveragingTable,
    /// A constant velocity beneath the excitation, to stay clear of sticking.
    pub constant_velocity: Option<ConstantVelocityTable>,
    /// Limits that no run may exceed.
    #[serde(default)]
    pub limits: LimitsTable,
    /// How the records become an FRF.
    #[serde(default)]
    pub estimate: EstimateTable,
}

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
    /// Number of logarithmically spaced frequencies before those on the same line merge; every line without it.
    pub n_lines: Option<usize>,
    /// Lines that may be excited: odd, full or odd-random.
    #[serde(default)]
    #[schemars(with = "GridKindName")]
    pub grid: GridKind,
    /// Largest motor torque in N m, one for each input; for experiments in open loop.
    pub peak_nm: Option<Vec<f64>>,
    /// Largest reference velocity in rad/s, one for each input; for experiments in closed loop.
    pub peak_rad_s: Option<Vec<f64>>,
    /// Shape of the amplitude over frequency as points [Hz, value]; only ratios count. Flat without it.
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
    /// Amplitude of the motor torque in N m, one for each input: a number, or points [[Hz, value], ...]; open loop.
    pub amplitude_nm: Option<Vec<Amplitude>>,
    /// Amplitude of the reference velocity in rad/s, one for each input: a number, or points; closed loop.
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
#[serde(untagged, expecting = "expected a number, or points [[Hz, value], ...]")]
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
            Self::Points(points) => Profile { points: points.clone() },
        }
    }
}

/// How often what is repeated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AveragingTable {
    /// Draws of the random phases, n_p: more than one tells the nonlinear distortion.
    pub realizations: usize,
    /// Separate runs of the same reference.
    pub repetitions: usize,
    /// Measured periods back to back in a run; repetitions times periods is n_q: more than one tells the noise.
    pub periods: usize,
    /// Time before the first measured period in s, for transients to die out. One period of a multisine and nothing before
    /// a chirp without it.
    pub lead_in_s: Option<f64>,
}

impl Default for AveragingTable {
    fn default() -> Self {
        Self { realizations: 1, repetitions: 1, periods: 1, lead_in_s: None }
    }
}

/// A constant velocity beneath the excitation (SK15 section 4.4 B).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstantVelocityTable {
    /// Velocity in rad/s, one for each input.
    pub velocity_rad_s: Vec<f64>,
    /// Runs of the constant velocity alone, subtracted from the others sample by sample; 0 for no subtraction.
    #[serde(default)]
    pub glides: usize,
}

/// Limits on the joint side, named as in ros2_control; one number for each axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitsTable {
    /// Largest motor torque in N m.
    pub max_effort: Option<Vec<f64>>,
    /// Largest rate of the motor torque in N m/s.
    pub max_effort_rate: Option<Vec<f64>>,
    /// Largest motor velocity in rad/s.
    pub max_velocity: Option<Vec<f64>>,
    /// Largest way from the start in rad (SK15 allows 4 degrees, 0.0698 rad).
    pub max_travel: Option<Vec<f64>>,
}

impl LimitsTable {
    /// The limits that are given, with their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &Vec<f64>)> {
        let all = [
            ("max_effort", &self.max_effort),
            ("max_effort_rate", &self.max_effort_rate),
            ("max_velocity", &self.max_velocity),
            ("max_travel", &self.max_travel),
        ];
        all.into_iter().filter_map(|(name, limit)| limit.as_ref().map(|limit| (name, limit)))
    }
}

/// How the records become an FRF.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct EstimateTable {
    /// What is averaged over periods: the FRFs (the paper) or the spectra (better when u is noisy).
    pub average: Average,
    /// Estimate through the reference (joint input-output), which noise on u does not bias.
    pub indirect: bool,
    /// Frequencies at which a chirp is evaluated: their number, logarithmically spaced over the band.
    pub n_frequencies: usize,
}

impl Default for EstimateTable {
    fn default() -> Self {
        Self { average: Average::Frfs, indirect: false, n_frequencies: 200 }
    }
}

/// What is averaged over periods.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Average {
    /// The FRFs of single periods, SK15 (14).
    #[default]
    Frfs,
    /// The spectra, before dividing.
    Spectra,
}

impl From<Average> for Averaging {
    fn from(average: Average) -> Self {
        match average {
            Average::Frfs => Self::Frfs,
            Average::Spectra => Self::Spectra,
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
