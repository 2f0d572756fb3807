//! The tables of a single flexible joint.

use frfid_plant::{Challenges, Ripple, SingleJoint};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

pub(super) fn default_knee_rad() -> f64 {
    SingleJoint::default().knee_rad
}

impl RippleTable {
    fn ripple(&self) -> Ripple {
        Ripple {
            cycles_per_turn: self.cycles_per_turn,
            amplitude_nm: self.amplitude_nm,
            phase_rad: self.phase_rad,
        }
    }
}

impl SingleJointTable {
    /// The joint with its defaults filled in, every challenge that is described on.
    #[must_use]
    pub fn joint(&self) -> SingleJoint {
        SingleJoint {
            motor_inertia_kg_m2: self.motor_inertia_kg_m2,
            link_inertia_kg_m2: self.link_inertia_kg_m2,
            damping_nms_per_rad: self.damping_nms_per_rad,
            stiffness_nm_per_rad: self.stiffness_nm_per_rad,
            stiffness_beyond_nm_per_rad: self
                .stiffness_beyond_nm_per_rad
                .unwrap_or(self.stiffness_nm_per_rad),
            knee_rad: self.knee_rad,
            coulomb_nm: self.coulomb_nm,
            viscous_nms_per_rad: self.viscous_nms_per_rad,
            ripple: self.ripple.iter().map(RippleTable::ripple).collect(),
        }
    }

    /// The joint without the challenges that are switched off: friction (B), stiffening (C), ripple
    /// (E).
    #[must_use]
    pub fn joint_with(&self, challenges: Challenges) -> SingleJoint {
        let joint = self.joint();
        let left = joint.flexible_joint().with(challenges);
        SingleJoint {
            stiffness_beyond_nm_per_rad: left.stiffness_beyond_nm_per_rad,
            coulomb_nm: left.coulomb_nm,
            ripple: left.ripple,
            ..joint
        }
    }
}
