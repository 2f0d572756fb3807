//! Challenges in finding a robot's FRFs: the seven of SK15 section 2, each a switch.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::joint::flexible_joint::FlexibleJoint;

/// Which of the challenges A to G a simulated robot poses; a switch that is not given is on. An
/// [`Arm`](crate::arm::Arm) applies B, C, D, E and G itself. A and F are not the arm's: whoever
/// builds its testbed leaves out the torque limit (A), the increments, noise and quanta of the
/// sensors (F).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Challenges {
    /// A: the torque that the gears bear is limited.
    pub gear_load_limit: Option<bool>,
    /// B: Coulomb friction; viscous friction is linear and stays.
    pub coulomb_friction: Option<bool>,
    /// C: gears that grow stiffer beyond their knee.
    pub stiffening: Option<bool>,
    /// D: mass matrix and gravity depend on the position. Off: the mass matrix stays that of the
    /// pose, there are no Coriolis torques, gravity changes linearly about the pose.
    pub position_dependence: Option<bool>,
    /// E: torque ripple.
    pub torque_ripple: Option<bool>,
    /// F: readings by increments and differences with noise, quantised torque.
    pub sensing: Option<bool>,
    /// G: gravity, Coriolis and centrifugal torques.
    pub gravity: Option<bool>,
}

/// Whether a challenge with this switch is posed.
#[must_use]
pub fn is_posed(switch: Option<bool>) -> bool {
    switch.unwrap_or(true)
}

impl Challenges {
    /// The switches, those that are not given taken from `others`.
    #[must_use]
    pub fn or(self, others: Self) -> Self {
        Self {
            gear_load_limit: self.gear_load_limit.or(others.gear_load_limit),
            coulomb_friction: self.coulomb_friction.or(others.coulomb_friction),
            stiffening: self.stiffening.or(others.stiffening),
            position_dependence: self.position_dependence.or(others.position_dependence),
            torque_ripple: self.torque_ripple.or(others.torque_ripple),
            sensing: self.sensing.or(others.sensing),
            gravity: self.gravity.or(others.gravity),
        }
    }
}

impl FlexibleJoint {
    /// The joint without the challenges that are switched off: friction (B), stiffening (C), ripple
    /// (E).
    #[must_use]
    pub fn with(&self, challenges: Challenges) -> Self {
        let mut joint = self.clone();
        if !is_posed(challenges.coulomb_friction) {
            joint.friction.coulomb_nm = 0.0;
        }
        if !is_posed(challenges.stiffening) {
            joint.spring.stiffness_beyond_nm_per_rad = joint.spring.stiffness_nm_per_rad;
        }
        if !is_posed(challenges.torque_ripple) {
            joint.ripple.clear();
        }
        joint
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_given_goes_before_the_others_and_the_rest_is_on() {
        let (on, off) = (Some(true), Some(false));
        let experiment = Challenges {
            gravity: on,
            ..Challenges::default()
        };
        let robot = Challenges {
            gravity: off,
            sensing: off,
            ..Challenges::default()
        };
        let both = experiment.or(robot);
        assert_eq!(
            both,
            Challenges {
                gravity: on,
                sensing: off,
                ..Challenges::default()
            }
        );
        assert!(is_posed(both.gravity) && is_posed(both.stiffening) && !is_posed(both.sensing));
    }
}
