//! A motor and the elastic gear behind it: the part of a flexible joint that does not depend on
//! what it drives.

use frfid_signals::SignalError;
use frfid_signals::checks::{finite, not_negative, positive};
use serde::{Deserialize, Serialize};

use crate::challenges::Challenges;
use crate::joint::friction::Friction;
use crate::joint::ripple::Ripple;
use crate::joint::spring::Spring;
use crate::motion::equations::Drive;

/// Motor and gear of one axis; everything on the joint side of the gear (behind a ratio n: inertia,
/// damping, stiffness and viscous friction of the motor side times n^2, torques times |n|).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlexibleJoint {
    /// Inertia J_m of the motor in kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Damping d of the gear in N m s/rad.
    pub damping_nms_per_rad: f64,
    /// Stiffness k1 of the gear in N m/rad up to the knee: the stiffness of the linear truth.
    pub stiffness_nm_per_rad: f64,
    /// Stiffness k2 beyond the knee in N m/rad.
    pub stiffness_beyond_nm_per_rad: f64,
    /// Deflection in rad at which the stiffness changes.
    pub knee_rad: f64,
    /// Coulomb friction F_c of the motor in N m.
    pub coulomb_nm: f64,
    /// Viscous friction of the motor in N m s/rad.
    pub viscous_nms_per_rad: f64,
    /// Harmonics of the torque ripple; empty for none.
    pub ripple: Vec<Ripple>,
}

impl FlexibleJoint {
    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] naming the first one that is not finite or out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("motor_inertia_kg_m2", self.motor_inertia_kg_m2)?;
        not_negative("damping_nms_per_rad", self.damping_nms_per_rad)?;
        positive("stiffness_nm_per_rad", self.stiffness_nm_per_rad)?;
        positive(
            "stiffness_beyond_nm_per_rad",
            self.stiffness_beyond_nm_per_rad,
        )?;
        positive("knee_rad", self.knee_rad)?;
        not_negative("coulomb_nm", self.coulomb_nm)?;
        not_negative("viscous_nms_per_rad", self.viscous_nms_per_rad)?;
        self.ripple.iter().try_for_each(|ripple| {
            not_negative("cycles_per_turn", ripple.cycles_per_turn)?;
            not_negative("amplitude_nm", ripple.amplitude_nm)?;
            finite("phase_rad", ripple.phase_rad)
        })
    }

    /// The gear's spring.
    #[must_use]
    pub fn spring(&self) -> Spring {
        Spring {
            stiffness_nm_per_rad: self.stiffness_nm_per_rad,
            stiffness_beyond_nm_per_rad: self.stiffness_beyond_nm_per_rad,
            knee_rad: self.knee_rad,
        }
    }

    /// The motor's friction.
    #[must_use]
    pub fn friction(&self) -> Friction {
        Friction {
            coulomb_nm: self.coulomb_nm,
            viscous_nms_per_rad: self.viscous_nms_per_rad,
        }
    }

    /// The joint as it takes part in the equations of motion.
    #[must_use]
    pub fn drive(&self) -> Drive {
        Drive {
            motor_inertia_kg_m2: self.motor_inertia_kg_m2,
            damping_nms_per_rad: self.damping_nms_per_rad,
            spring: self.spring(),
            friction: self.friction(),
            ripple: self.ripple.clone(),
        }
    }

    /// The joint without the challenges that are switched off: friction (B), stiffening (C), ripple
    /// (E).
    #[must_use]
    pub fn with(&self, challenges: Challenges) -> Self {
        let mut joint = self.clone();
        if !challenges.coulomb_friction {
            joint.coulomb_nm = 0.0;
        }
        if !challenges.stiffening {
            joint.stiffness_beyond_nm_per_rad = joint.stiffness_nm_per_rad;
        }
        if !challenges.torque_ripple {
            joint.ripple.clear();
        }
        joint
    }
}
