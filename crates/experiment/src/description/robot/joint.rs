//! Flexible joint: motor and gear of a single joint (`[single_joint]`) and of one axis of an arm
//! (`[body.joint]`), the latter with its sensor and limits.

use std::f64::consts::TAU;

use frfid_plant::{FlexibleJoint, Friction, Ripple, Sensor, SingleJoint, Spring};
use frfid_signals::Limit;
use frfid_signals::checks::positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::fault::Fault;

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
    /// Stiffness of the gear beyond the knee in N m/rad; the same as before it without this.
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
    pub ripple: Vec<Ripple>,
}

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
    pub sensor: Sensor,
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

/// The example of SK15 section 6.1 with its nonlinearities off.
impl Default for SingleJointTable {
    fn default() -> Self {
        let SingleJoint {
            joint,
            link_inertia_kg_m2,
        } = SingleJoint::default();
        Self {
            motor_inertia_kg_m2: joint.motor_inertia_kg_m2,
            link_inertia_kg_m2,
            damping_nms_per_rad: joint.damping_nms_per_rad,
            stiffness_nm_per_rad: joint.spring.stiffness_nm_per_rad,
            stiffness_beyond_nm_per_rad: None,
            knee_rad: joint.spring.knee_rad,
            coulomb_nm: joint.friction.coulomb_nm,
            viscous_nms_per_rad: joint.friction.viscous_nms_per_rad,
            ripple: joint.ripple,
        }
    }
}

fn one() -> f64 {
    1.0
}

fn default_knee_rad() -> f64 {
    SingleJoint::default().joint.spring.knee_rad
}

/// Motor and gear of either table, defaults filled in; a trait would have to name each number once
/// more.
macro_rules! motor_and_gear {
    ($table:expr, $ripple:expr) => {
        FlexibleJoint {
            motor_inertia_kg_m2: $table.motor_inertia_kg_m2,
            damping_nms_per_rad: $table.damping_nms_per_rad,
            spring: Spring {
                stiffness_nm_per_rad: $table.stiffness_nm_per_rad,
                stiffness_beyond_nm_per_rad: $table
                    .stiffness_beyond_nm_per_rad
                    .unwrap_or($table.stiffness_nm_per_rad),
                knee_rad: $table.knee_rad,
            },
            friction: Friction {
                coulomb_nm: $table.coulomb_nm,
                viscous_nms_per_rad: $table.viscous_nms_per_rad,
            },
            ripple: $ripple,
        }
    };
}

impl SingleJointTable {
    /// The joint with its defaults filled in, every challenge that is described on.
    #[must_use]
    pub fn single_joint(&self) -> SingleJoint {
        SingleJoint {
            joint: motor_and_gear!(self, self.ripple.clone()),
            link_inertia_kg_m2: self.link_inertia_kg_m2,
        }
    }
}

impl MotorRippleTable {
    /// The harmonic as the joint sees it.
    fn behind(&self, gear_ratio: f64) -> Ripple {
        Ripple {
            cycles_per_turn: self.cycles_per_motor_turn * gear_ratio.abs(),
            amplitude_nm: self.amplitude_nm,
            phase_rad: self.phase_rad,
        }
    }
}

impl JointTable {
    /// Motor and gear with their defaults filled in.
    #[must_use]
    pub fn joint(&self) -> FlexibleJoint {
        let harmonics = self.ripple.iter();
        let ripple = harmonics.map(|harmonic| harmonic.behind(self.gear_ratio));
        motor_and_gear!(self, ripple.collect())
    }

    /// The sensor; an increment is a count of the encoder behind the gear.
    #[must_use]
    pub fn sensor(&self) -> Sensor {
        let count_rad = self
            .encoder_counts_per_motor_turn
            .map(|counts| TAU / (counts * self.gear_ratio.abs()));
        Sensor {
            position_increment_rad: self.sensor.position_increment_rad.or(count_rad),
            ..self.sensor
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

    /// Lowest and highest position.
    pub(super) fn range_rad(&self) -> (f64, f64) {
        (
            self.min_position.unwrap_or(f64::NEG_INFINITY),
            self.max_position.unwrap_or(f64::INFINITY),
        )
    }

    /// Checks every number.
    pub(super) fn check(&self) -> Result<(), Fault> {
        self.check_gear_ratio()?;
        self.joint().check()?;
        self.check_encoder()?;
        self.sensor.check().map_err(Fault::in_table("sensor"))?;
        self.check_limits()
    }

    /// Checks that every limit allows something.
    fn check_limits(&self) -> Result<(), Fault> {
        self.check_sizes()?;
        self.check_range()
    }

    fn check_gear_ratio(&self) -> Result<(), Fault> {
        let found = self.gear_ratio;
        if found.is_finite() && found != 0.0 {
            return Ok(());
        }
        let message =
            format!("gear_ratio is {found}, needed: a finite number of either sign, not 0");
        Err(Fault::new(&["gear_ratio"], message))
    }

    /// Checks that the encoder has counts, and one resolution.
    fn check_encoder(&self) -> Result<(), Fault> {
        if let Some(counts) = self.encoder_counts_per_motor_turn {
            let key = "encoder_counts_per_motor_turn";
            positive(key, counts)?;
            if self.sensor.position_increment_rad.is_some() {
                let message = "encoder counts and a position increment are given; keep one of them";
                return Err(Fault::new(&[key], message));
            }
        }
        Ok(())
    }

    /// Checks the limits of sizes.
    fn check_sizes(&self) -> Result<(), Fault> {
        for &limit in Limit::ALL.iter().filter(|limit| limit.is_size()) {
            let found = self.limit(limit);
            if let Some(found) = found.filter(|found| found.is_nan() || *found <= 0.0) {
                let key = limit.key();
                let message = format!("{key} is {found}, needed: a number above 0");
                return Err(Fault::new(&[key], message));
            }
        }
        Ok(())
    }

    /// Checks the limits of the position.
    fn check_range(&self) -> Result<(), Fault> {
        let (lowest, highest) = self.range_rad();
        if lowest < highest {
            return Ok(());
        }
        let limit = match self.max_position {
            Some(_) => Limit::HighestPosition,
            None => Limit::LowestPosition,
        };
        let message = format!(
            "the range from {lowest} to {highest} rad is empty; needed: min_position below \
             max_position"
        );
        Err(Fault::new(&[limit.key()], message))
    }
}
