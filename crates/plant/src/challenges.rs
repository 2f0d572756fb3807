//! What makes finding a robot's FRFs hard: the seven challenges of SK15 section 2, each a switch.

use serde::{Deserialize, Serialize};

/// Which of the challenges A to G a simulated robot poses; all by default. An [`Arm`](crate::arm::Arm)
/// applies B, C, D, E and G itself. A and F are not the arm's: whoever builds its testbed leaves
/// out the torque limit (A), the increments, noise and quanta of the sensors (F).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Challenges {
    /// A: the torque that the gears bear is limited.
    pub gear_load_limit: bool,
    /// B: Coulomb friction. The viscous part belongs to the linear truth and stays.
    pub coulomb_friction: bool,
    /// C: the gears grow stiffer beyond their knee.
    pub stiffening: bool,
    /// D: mass matrix and gravity depend on the position. Off: the mass matrix stays that of the
    /// pose, there are no Coriolis torques, gravity changes linearly about the pose.
    pub position_dependence: bool,
    /// E: torque ripple.
    pub torque_ripple: bool,
    /// F: readings by increments and differences with noise, quantised torque.
    pub sensing: bool,
    /// G: gravity, Coriolis and centrifugal torques.
    pub gravity: bool,
}

impl Default for Challenges {
    fn default() -> Self {
        Self {
            gear_load_limit: true,
            coulomb_friction: true,
            stiffening: true,
            position_dependence: true,
            torque_ripple: true,
            sensing: true,
            gravity: true,
        }
    }
}
