//! The table of a flexible joint: motor, gear, sensor and limits of one axis of an arm.

use std::f64::consts::TAU;

use frfid_plant::{FlexibleJoint, Ripple, Sensor};
use frfid_signals::checks::positive;
use frfid_signals::{Limit, SignalError};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::robot::sensor::SensorTable;
use crate::description::robot::single_joint::default_knee_rad;
use crate::description::text::{ConfigError, Source};

/// A motor behind an elastic gear, with its sensor and its limits. Everything on the joint side of
/// the gear: behind a ratio n an inertia, damping, stiffness or viscous friction of the motor side
/// times n^2, a torque times |n|, a speed over |n|.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointTable {
    /// Turns of the motor for a turn of the joint, of either sign; needed by what is counted in
    /// turns of the motor.
    #[serde(default = "one")]
    pub gear_ratio: f64,
    /// Inertia of the motor in kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Stiffness of the gear in N m/rad up to the knee.
    pub stiffness_nm_per_rad: f64,
    /// Stiffness of the gear beyond the knee in N m/rad; the same as before it without this.
    pub stiffness_beyond_nm_per_rad: Option<f64>,
    /// Deflection in rad at which the stiffness changes.
    #[serde(default = "default_knee_rad")]
    pub knee_rad: f64,
    /// Damping of the gear in N m s/rad.
    pub damping_nms_per_rad: f64,
    /// Coulomb friction of the motor in N m.
    #[serde(default)]
    pub coulomb_nm: f64,
    /// Viscous friction of the motor in N m s/rad.
    #[serde(default)]
    pub viscous_nms_per_rad: f64,
    /// Counts of the encoder in a turn of the motor; `sensor.position_increment_rad` says the same
    /// on the joint side.
    pub encoder_counts_per_motor_turn: Option<f64>,
    /// Lowest position in rad.
    pub min_position: Option<f64>,
    /// Highest position in rad.
    pub max_position: Option<f64>,
    /// Largest motor velocity in rad/s.
    pub max_velocity: Option<f64>,
    /// Largest motor acceleration in rad/s^2.
    pub max_acceleration: Option<f64>,
    /// Largest motor jerk in rad/s^3.
    pub max_jerk: Option<f64>,
    /// Largest motor torque in N m.
    pub max_effort: Option<f64>,
    /// Largest rate of the motor torque in N m/s.
    pub max_effort_rate: Option<f64>,
    /// Sensors and torque resolution; ideal without this table.
    #[serde(default)]
    pub sensor: SensorTable,
    /// Harmonics of the torque ripple.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ripple: Vec<MotorRippleTable>,
}

/// One harmonic of the torque ripple behind a gear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotorRippleTable {
    /// Cycles in a turn of the motor.
    pub cycles_per_motor_turn: f64,
    /// Amplitude in N m on the joint side.
    pub amplitude_nm: f64,
    /// Phase in rad at position 0.
    #[serde(default)]
    pub phase_rad: f64,
}

fn one() -> f64 {
    1.0
}

impl JointTable {
    /// Motor and gear with their defaults filled in.
    #[must_use]
    pub fn joint(&self) -> FlexibleJoint {
        let ripple = |ripple: &MotorRippleTable| Ripple {
            cycles_per_turn: ripple.cycles_per_motor_turn * self.gear_ratio.abs(),
            amplitude_nm: ripple.amplitude_nm,
            phase_rad: ripple.phase_rad,
        };
        FlexibleJoint {
            motor_inertia_kg_m2: self.motor_inertia_kg_m2,
            damping_nms_per_rad: self.damping_nms_per_rad,
            stiffness_nm_per_rad: self.stiffness_nm_per_rad,
            stiffness_beyond_nm_per_rad: self
                .stiffness_beyond_nm_per_rad
                .unwrap_or(self.stiffness_nm_per_rad),
            knee_rad: self.knee_rad,
            coulomb_nm: self.coulomb_nm,
            viscous_nms_per_rad: self.viscous_nms_per_rad,
            ripple: self.ripple.iter().map(ripple).collect(),
        }
    }

    /// The sensor; an increment is a count of the encoder behind the gear.
    #[must_use]
    pub fn sensor(&self) -> Sensor {
        let sensor = self.sensor.sensor();
        let count_rad = self
            .encoder_counts_per_motor_turn
            .map(|counts| TAU / (counts * self.gear_ratio.abs()));
        Sensor {
            position_increment_rad: sensor.position_increment_rad.or(count_rad),
            ..sensor
        }
    }

    /// The value of a limit, if there is one.
    #[must_use]
    pub fn limit(&self, limit: Limit) -> Option<f64> {
        match limit {
            Limit::LowestPosition => self.min_position,
            Limit::HighestPosition => self.max_position,
            Limit::Velocity => self.max_velocity,
            Limit::Acceleration => self.max_acceleration,
            Limit::Jerk => self.max_jerk,
            Limit::Torque => self.max_effort,
            Limit::TorqueRate => self.max_effort_rate,
            Limit::Travel => None,
        }
    }

    /// Checks every number; errors name the joint and point into the table at `path`.
    pub(super) fn check(
        &self,
        name: &str,
        source: &Source,
        path: &[&str],
    ) -> Result<(), ConfigError> {
        let at = |keys: &[&str], message: String| {
            source.error(&[path, keys].concat(), format!("joint {name}: {message}"))
        };
        let located = |error: &SignalError| match error {
            // the key is the parameter's own name, in the table or in one of those inside it
            SignalError::Parameter { name, .. }
                if source.has(&[path, &["sensor", name]].concat()) =>
            {
                at(&["sensor", name], error.to_string())
            }
            SignalError::Parameter {
                name: "cycles_per_turn" | "amplitude_nm" | "phase_rad",
                ..
            } => at(&["ripple"], error.to_string()),
            SignalError::Parameter { name, .. } => at(&[name], error.to_string()),
            error => at(&[], error.to_string()),
        };
        if !self.gear_ratio.is_finite() || self.gear_ratio == 0.0 {
            let message = format!(
                "gear_ratio is {}, needed: a finite number of either sign, not 0",
                self.gear_ratio
            );
            return Err(at(&["gear_ratio"], message));
        }
        self.joint().check().map_err(|error| located(&error))?;
        if let Some(counts) = self.encoder_counts_per_motor_turn {
            positive("encoder_counts_per_motor_turn", counts).map_err(|error| located(&error))?;
            if self.sensor.position_increment_rad.is_some() {
                let message = "encoder counts and a position increment are given; keep one of them"
                    .to_owned();
                return Err(at(&["encoder_counts_per_motor_turn"], message));
            }
        }
        self.sensor().check().map_err(|error| located(&error))?;
        self.check_limits()
            .map_err(|(key, message)| at(&[key], message))
    }

    /// The first limit that allows nothing, with what is wrong about it.
    fn check_limits(&self) -> Result<(), (&'static str, String)> {
        for &limit in Limit::ALL.iter().filter(|limit| limit.is_size()) {
            let found = self.limit(limit);
            if let Some(found) = found.filter(|found| found.is_nan() || *found <= 0.0) {
                let key = limit.key();
                return Err((key, format!("{key} is {found}, needed: a number above 0")));
            }
        }
        let (lowest, highest) = (self.min_position, self.max_position);
        let range = (
            lowest.unwrap_or(f64::NEG_INFINITY),
            highest.unwrap_or(f64::INFINITY),
        );
        if range.0 < range.1 {
            return Ok(());
        }
        let message = format!(
            "the range from {} to {} rad is empty; needed: min_position below max_position",
            range.0, range.1
        );
        Err((
            if highest.is_some() {
                "max_position"
            } else {
                "min_position"
            },
            message,
        ))
    }
}
