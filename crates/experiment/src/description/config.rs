//! Tables of `experiment.toml`: one description of robot, excitation, averaging, limits and
//! estimator.

use frfid_plant::Integration;
use frfid_signals::{ChirpDesign, Design, MultisineDesign, SteppedSineDesign};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::channels::ChannelsTable;
use crate::description::controller::ControllerTable;
use crate::description::estimate::EstimateTable;
use crate::description::fault::Fault;
use crate::description::limits::LimitsTable;
use crate::description::robot::RobotTable;
use crate::description::shape::ShapeTable;

/// An experiment, as `experiment.toml` describes it. Frequencies in Hz, everything else in SI units
/// on the joint side of the gear; the unit ends the name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Seed of every random number: phases of the excitation and noise of the simulated sensors.
    pub seed: u64,
    /// Sample time of the controller in s: the clock of references and records.
    pub sample_time_s: f64,
    /// How the robot is simulated: by Runge-Kutta steps (`rk4`), or exactly (`exact`), which needs a
    /// single joint without torque ripple.
    #[serde(default, skip_serializing_if = "is_default")]
    pub integrator: Integration,
    /// The machine; this or `[channels]` is needed.
    #[serde(default, skip_serializing_if = "RobotTable::is_left_out")]
    pub robot: RobotTable,
    /// A machine without a model, in the place of `[robot]`.
    pub channels: Option<ChannelsTable>,
    /// The controller; without this table the experiment runs in open loop and the reference is the
    /// motor torque.
    pub controller: Option<ControllerTable>,
    /// A random-phase multisine. Exactly one excitation is needed: `[multisine]`, `[chirp]` or
    /// `[stepped_sine]`.
    pub multisine: Option<MultisineDesign>,
    /// An exponential chirp.
    pub chirp: Option<ChirpDesign>,
    /// A stepped sine.
    pub stepped_sine: Option<SteppedSineDesign>,
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
    /// What the reference of the chirp is shaped towards, by `frfid shape`.
    pub shape: Option<ShapeTable>,
}

impl Config {
    /// Tables whose key `kind` says what they describe, and what they describe without it.
    pub(crate) const TABLES_OF_KINDS: [(&str, &str); 1] = [("controller", "pi")];

    /// The first key under which another file is named.
    pub(crate) fn names_file(&self) -> Option<&'static [&'static str]> {
        let keys: [(bool, &[&str]); 3] = [
            (self.robot.file.is_some(), &["robot", "file"]),
            (self.robot.urdf.is_some(), &["robot", "urdf"]),
            (self.limits.file.is_some(), &["limits", "file"]),
        ];
        let named = keys.into_iter().find(|(is_named, _)| *is_named);
        named.map(|(_, key)| key)
    }

    /// The table of the excitation, by its name.
    pub(crate) fn excitation(&self) -> Result<(&'static str, &dyn Design), Fault> {
        let tables = self.excitations();
        let mut given = tables
            .into_iter()
            .filter_map(|(name, table)| Some((name, table?)));
        match (given.next(), given.next()) {
            (Some(table), None) => Ok(table),
            (Some((first, _)), Some((second, _))) => {
                let message = format!("both [{first}] and [{second}] are given; keep one of them");
                Err(Fault::new(&[second], message))
            }
            (None, _) => {
                let names = tables.map(|(name, _)| format!("[{name}]")).join(" or ");
                let message = format!("no excitation: a table {names} is needed");
                Err(Fault::new(&[], message))
            }
        }
    }

    /// The tables of all excitations with their names, `None` for those that are not there.
    fn excitations(&self) -> [(&'static str, Option<&dyn Design>); 3] {
        [
            ("multisine", of_table(&self.multisine)),
            ("chirp", of_table(&self.chirp)),
            ("stepped_sine", of_table(&self.stepped_sine)),
        ]
    }
}

fn of_table<T: Design>(table: &Option<T>) -> Option<&dyn Design> {
    table.as_ref().map(|table| table as &dyn Design)
}

/// How often what is repeated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AveragingTable {
    /// Draws of the random phases, n_p: more than one tells the nonlinear distortion.
    pub realizations: usize,
    /// Separate runs of the same reference.
    pub repetitions: usize,
    /// Measured periods back to back in a run; repetitions times periods is n_q: more than one
    /// tells the noise.
    pub periods: usize,
    /// Time before the first measured period in s, for transients to die out. Without it one
    /// period of a multisine, and nothing before other excitations.
    pub lead_in_s: Option<f64>,
    /// Time in s over which a multisine rises from 0, at the begin of the lead-in, and falls to 0
    /// after the last period, so that torque rate, acceleration and jerk keep their limits from rest
    /// to rest. At most `lead_in_s`; chirps and stepped sines have fades of their own.
    #[serde(skip_serializing_if = "is_none")]
    pub ramp_s: f64,
}

/// The integrator where none is named: left out of what travels, so that descriptions without one
/// keep their hash.
fn is_default(integrator: &Integration) -> bool {
    *integrator == Integration::default()
}

/// No ramp: left out of what travels, so that descriptions without one keep their hash.
fn is_none(ramp_s: &f64) -> bool {
    *ramp_s == 0.0
}

impl Default for AveragingTable {
    fn default() -> Self {
        Self {
            realizations: 1,
            repetitions: 1,
            periods: 1,
            lead_in_s: None,
            ramp_s: 0.0,
        }
    }
}

/// A constant velocity beneath the excitation (SK15 section 4.4 B).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstantVelocityTable {
    /// Velocity in rad/s, one for each input; its sign is the direction.
    pub velocity_rad_s: Option<Vec<f64>>,
    /// Way of a whole run in rad, lead-in included, one for each input: the velocity is the way
    /// over the run's duration. The runs lie symmetrically about the pose, half the way on either
    /// side.
    pub travel_rad: Option<Vec<f64>>,
    /// Runs of the constant velocity alone, subtracted from the others sample by sample; 0 for no
    /// subtraction.
    #[serde(default)]
    pub glides: usize,
}
