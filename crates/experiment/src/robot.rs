//! The robot's tables in `experiment.toml` and in a robot file of its own.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use frfid_plant::{PiController, Ripple, Sensor, SingleJoint, Velocity};
use frfid_signals::SignalError;

use crate::source::{ConfigError, Source};

/// The machine: either `file`, a robot file of its own, or the tables of such a file right here.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotTable {
    /// A robot file, relative to the file that names it.
    pub file: Option<String>,
    /// One motor and one link with a gear between them.
    pub single_joint: Option<SingleJointTable>,
    /// Sensors and torque resolution; ideal without this table.
    pub sensor: Option<SensorTable>,
}

/// A single flexible joint (SK15 section 6.1); everything on the joint side of the gear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SingleJointTable {
    /// Inertia of the motor in kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Inertia of the link in kg m^2.
    pub link_inertia_kg_m2: f64,
    /// Damping of the gear in N m s/rad.
    pub damping_nms_per_rad: f64,
    /// Stiffness of the gear in N m/rad up to the knee.
    pub stiffness_nm_per_rad: f64,
    /// Stiffness beyond the knee in N m/rad; the same as before it without this.
    pub stiffness_beyond_nm_per_rad: Option<f64>,
    /// Deflection in rad at which the stiffness changes.
    #[serde(default = "default_knee_rad")]
    pub knee_rad: f64,
    /// Coulomb friction of the motor in N m.
    #[serde(default)]
    pub coulomb_nm: f64,
    /// Viscous friction of the motor in N m s/rad.
    #[serde(default)]
    pub viscous_nms_per_rad: f64,
    /// Harmonics of the torque ripple, as `[[robot.single_joint.ripple]]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ripple: Vec<RippleTable>,
}

/// One harmonic of the torque ripple.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RippleTable {
    /// Cycles per turn on the joint side: those per motor turn times the gear ratio.
    pub cycles_per_turn: f64,
    /// Amplitude in N m.
    pub amplitude_nm: f64,
    /// Phase in rad at position 0.
    #[serde(default)]
    pub phase_rad: f64,
}

/// Sensors and torque resolution; whatever is not given is ideal.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SensorTable {
    /// The velocity is the difference of the last two positions over the sample time, not the true velocity.
    pub velocity_by_differencing: bool,
    /// Position increment in rad: one encoder count on the joint side.
    pub position_increment_rad: Option<f64>,
    /// Rms of the white noise on the position in rad.
    pub position_noise_rad: Option<f64>,
    /// Rms of the white noise on the velocity in rad/s, before it is filtered.
    pub velocity_noise_rad_s: Option<f64>,
    /// Corner in Hz of a low-pass of first order on the velocity reading.
    pub velocity_filter_hz: Option<f64>,
    /// Resolution of the motor torque in N m.
    pub torque_quantum_nm: Option<f64>,
    /// Rms of the white noise on the torque reading in N m; with it the recorded input is a measurement.
    pub torque_noise_nm: Option<f64>,
}

/// A sampled PI controller of the motor velocity: the reference is a velocity then.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControllerTable {
    /// Proportional gain in N m s/rad, one for each axis.
    pub gain_nms_per_rad: Vec<f64>,
    /// Integral gain in N m/rad, one for each axis.
    pub integral_gain_nm_per_rad: Vec<f64>,
    /// Whole samples from reading the velocity to the torque's acting.
    #[serde(default)]
    pub delay_samples: usize,
    /// Torque limit in N m, one for each axis; none without it.
    pub max_torque_nm: Option<Vec<f64>>,
    /// Largest change of the torque in N m/s, one for each axis; none without it.
    pub max_torque_rate_nm_per_s: Option<Vec<f64>>,
    /// Gain of a position loop around the velocity loop in 1/s, one for each axis; no position loop without it.
    pub position_gain_per_s: Option<Vec<f64>>,
}

fn default_knee_rad() -> f64 {
    SingleJoint::default().knee_rad
}

impl RobotTable {
    /// Number of axes.
    #[must_use]
    pub fn n_axes(&self) -> usize {
        1
    }

    /// Names of the joints, as they stand in the logs.
    #[must_use]
    pub fn joint_names(&self) -> Vec<String> {
        (1..=self.n_axes()).map(|axis| format!("joint_{axis}")).collect()
    }

    /// Puts the tables of the robot file, if one is named, in the place of its name.
    pub(crate) fn read_file(&mut self, source: &Source, folder: &Path) -> Result<(), ConfigError> {
        let Some(file) = self.file.take() else { return Ok(()) };
        if *self != Self::default() {
            return Err(
                source.error(&["robot", "file"], "a robot file and tables of a robot are given; keep one of them")
            );
        }
        let robot =
            Source::read(&folder.join(&file)).map_err(|error| source.error(&["robot", "file"], error.to_string()))?;
        *self = robot.parse()?;
        match self.file {
            Some(_) => Err(robot.error(&["file"], "a robot file cannot name another one")),
            None => self.check_at(&robot, &[]),
        }
    }

    /// Checks every number; errors point into `source`.
    pub(crate) fn check(&self, source: &Source) -> Result<(), ConfigError> {
        self.check_at(source, &["robot"])
    }

    fn check_at(&self, source: &Source, table: &[&str]) -> Result<(), ConfigError> {
        let Some(joint) = &self.single_joint else {
            return Err(source.error(table, "no robot: `file` or a table [single_joint] is needed"));
        };
        let located = |sub: &str, error: &SignalError| {
            let key = if let SignalError::Parameter { name, .. } = error { name } else { "" };
            source.error(&[table, &[sub, key]].concat(), error.to_string())
        };
        joint.joint().check().map_err(|error| located("single_joint", &error))?;
        self.sensor().check().map_err(|error| located("sensor", &error))
    }

    /// The sensor of every axis.
    #[must_use]
    pub fn sensor(&self) -> Sensor {
        let table = self.sensor.clone().unwrap_or_default();
        Sensor {
            velocity: if table.velocity_by_differencing { Velocity::Differenced } else { Velocity::True },
            position_increment_rad: table.position_increment_rad,
            position_noise_rad: table.position_noise_rad,
            velocity_noise_rad_s: table.velocity_noise_rad_s,
            velocity_filter_hz: table.velocity_filter_hz,
            torque_quantum_nm: table.torque_quantum_nm,
            torque_noise_nm: table.torque_noise_nm,
        }
    }

    /// The joint to be simulated, if one is described.
    #[must_use]
    pub fn joint(&self) -> Option<SingleJoint> {
        self.single_joint.as_ref().map(SingleJointTable::joint)
    }
}

impl ControllerTable {
    /// The controller on the clock of the experiment.
    #[must_use]
    pub fn controller(&self, sample_time_s: f64) -> PiController {
        PiController {
            gain: self.gain_nms_per_rad.clone(),
            integral_gain: self.integral_gain_nm_per_rad.clone(),
            sample_time_s,
            delay_samples: self.delay_samples,
            max_torque_nm: self.max_torque_nm.clone(),
            max_torque_rate_nm_per_s: self.max_torque_rate_nm_per_s.clone(),
            position_gain: self.position_gain_per_s.clone(),
        }
    }
}

impl RippleTable {
    fn ripple(&self) -> Ripple {
        Ripple { cycles_per_turn: self.cycles_per_turn, amplitude_nm: self.amplitude_nm, phase_rad: self.phase_rad }
    }
}

impl SingleJointTable {
    /// The joint with its defaults filled in.
    #[must_use]
    pub fn joint(&self) -> SingleJoint {
        SingleJoint {
            motor_inertia_kg_m2: self.motor_inertia_kg_m2,
            link_inertia_kg_m2: self.link_inertia_kg_m2,
            damping_nms_per_rad: self.damping_nms_per_rad,
            stiffness_nm_per_rad: self.stiffness_nm_per_rad,
            stiffness_beyond_nm_per_rad: self.stiffness_beyond_nm_per_rad.unwrap_or(self.stiffness_nm_per_rad),
            knee_rad: self.knee_rad,
            coulomb_nm: self.coulomb_nm,
            viscous_nms_per_rad: self.viscous_nms_per_rad,
            ripple: self.ripple.iter().map(RippleTable::ripple).collect(),
        }
    }
}
