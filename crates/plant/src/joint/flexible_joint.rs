//! Motor and the elastic gear behind it: the part of a flexible joint that does not depend on
//! what it drives.

use frfid_signals::SignalError;
use frfid_signals::checks::{not_negative, positive};

use crate::joint::friction::{Friction, Slip};
use crate::joint::ripple::Ripple;
use crate::joint::spring::{Branch, Spring};

/// Motor and gear of one axis; everything on the joint side of the gear (behind a ratio n: inertia,
/// damping, stiffness and viscous friction of the motor side times n^2, torques times |n|).
#[derive(Debug, Clone, PartialEq)]
pub struct FlexibleJoint {
    /// Inertia J_m of the motor in kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Damping d of the gear in N m s/rad.
    pub damping_nms_per_rad: f64,
    /// Elasticity of the gear.
    pub spring: Spring,
    /// Friction of the motor.
    pub friction: Friction,
    /// Harmonics of the torque ripple; empty for none.
    pub ripple: Vec<Ripple>,
}

/// The branch of friction and spring that an axis is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Mode {
    /// Stuck or slipping.
    pub slip: Slip,
    /// Branch of the spring.
    pub branch: Branch,
}

/// What a mode contributes to the right-hand side of an axis, as numbers, so that lanes in
/// different modes run together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Regime<L> {
    /// 1/J_m in 1/(kg m^2) while the motor can move, 0 when it is stuck.
    pub mobility: L,
    /// Coulomb torque in N m.
    pub coulomb_nm: L,
    /// Slope of the spring in N m/rad.
    pub slope_nm_per_rad: L,
    /// Torque in N m of the spring's straight line at zero deflection.
    pub offset_nm: L,
}

impl Regime<f64> {
    /// The part of it that is linear: without the torques that do not depend on the state.
    pub(crate) fn linear(&self) -> Self {
        Self {
            coulomb_nm: 0.0,
            offset_nm: 0.0,
            ..*self
        }
    }
}

impl FlexibleJoint {
    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError`] naming the first one that is not finite or out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("motor_inertia_kg_m2", self.motor_inertia_kg_m2)?;
        not_negative("damping_nms_per_rad", self.damping_nms_per_rad)?;
        self.spring.check()?;
        self.friction.check()?;
        for (index, ripple) in self.ripple.iter().enumerate() {
            ripple.check().map_err(|error| {
                let path = vec!["ripple".to_owned(), index.to_string()];
                error.within(format!("ripple {}", index + 1), path)
            })?;
        }
        Ok(())
    }

    /// 1/J_m in 1/(kg m^2).
    pub(crate) fn motor_mobility(&self) -> f64 {
        1.0 / self.motor_inertia_kg_m2
    }

    /// Energy in J of the motor at a velocity in rad/s and of the gear at a deflection in rad.
    pub(crate) fn energy_j(&self, velocity_rad_s: f64, deflection_rad: f64) -> f64 {
        0.5 * self.motor_inertia_kg_m2 * velocity_rad_s * velocity_rad_s
            + self.spring.energy_j(deflection_rad)
    }

    /// The numbers of a mode.
    #[must_use]
    pub(crate) fn regime(&self, mode: Mode) -> Regime<f64> {
        let (slope_nm_per_rad, offset_nm) = self.spring.line(mode.branch);
        let is_stuck = mode.slip == Slip::Stuck;
        Regime {
            mobility: if is_stuck { 0.0 } else { self.motor_mobility() },
            coulomb_nm: self.friction.coulomb(mode.slip),
            slope_nm_per_rad,
            offset_nm,
        }
    }
}
