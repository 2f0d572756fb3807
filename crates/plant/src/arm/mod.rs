//! Robot arm: rigid bodies in a chain, a flexible joint in front of each that moves. The
//! description; what follows from it is in `chain.rs` (mass matrix, gravity, Coriolis) and
//! `robot.rs` (motion, linear truth).

mod chain;
mod chain_dynamics;
mod chains;
pub(crate) mod challenges;
mod composite;
pub(crate) mod inertia;
mod links_at_pose;
mod positive_definite;
mod rigid;
mod robot;
mod stance;
mod unrolled;
mod validation;
mod wrench;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::arm::challenges::Challenges;
use crate::arm::inertia::Inertia;
use crate::joint::flexible_joint::FlexibleJoint;

/// A serial chain of rigid bodies on revolute joints, from the base to the tip.
///
/// M(qo) qo'' + C(qo, qo') qo' + g(qo) = tau, J_m qm'' = u - tau_f(qm') - ripple(qm) - tau, tau =
/// tau_s(dq) + d dq', dq = qm - qo: the rotors turn about their own axes only (Spong's reduced
/// model, J. Dyn. Sys. Meas. Control 109 (1987) 310).
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// The bodies, each hanging on the one before it, the first on the base.
    pub bodies: Vec<Body>,
    /// What the last body carries.
    pub payload: Option<Payload>,
    /// Acceleration of gravity in m/s^2 in the frame of the base, e.g. (0, 0, -9.81) with z up.
    pub gravity_m_s2: [f64; 3],
    /// The pose: link positions in rad of the moving joints.
    pub pose_rad: Vec<f64>,
    /// What makes the robot hard to identify.
    pub challenges: Challenges,
}

/// A rigid body and the joint that carries it. The body's frame is the joint's, turned by the
/// joint's position about its axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name, for messages.
    pub name: String,
    /// Origin of the joint in the parent's frame in m.
    pub offset_m: [f64; 3],
    /// Orientation of the joint's frame in the parent's at position 0, row by row: a vector of this
    /// frame times the matrix is the vector in the parent's. The identity in most descriptions, the
    /// matrix of `rpy` in URDF.
    pub rotation: [[f64; 3]; 3],
    /// Axis of the joint in its own frame, of any length but 0.
    pub axis: [f64; 3],
    /// Mass in kg.
    pub mass_kg: f64,
    /// Centre of mass in m in the body's frame.
    pub center_of_mass_m: [f64; 3],
    /// Inertia tensor in kg m^2 about the centre of mass in the body's frame.
    pub inertia_kg_m2: Inertia,
    /// Moments of inertia that cannot move are left out: principal moments need not obey the
    /// triangle inequality.
    pub simplified: bool,
    /// Whether and how the joint moves.
    pub joint: BodyJoint,
}

/// Whether and how the joint of a body moves.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyJoint {
    /// Rigid, at this position.
    Locked {
        /// Position in rad.
        position_rad: f64,
    },
    /// Driven by a motor behind an elastic gear.
    Flexible(FlexibleJoint),
}

/// A rigid load on the last body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    /// Mass in kg.
    pub mass_kg: f64,
    /// Centre of mass in m in the frame of the last body.
    pub center_of_mass_m: [f64; 3],
    /// Inertia in kg m^2 about the centre of mass in the frame of the last body; a point mass
    /// without it.
    #[serde(default)]
    pub inertia_kg_m2: Inertia,
}

impl Arm {
    /// The joints that move, from the base to the tip.
    pub fn joints(&self) -> impl Iterator<Item = &FlexibleJoint> {
        self.bodies.iter().filter_map(|body| match &body.joint {
            BodyJoint::Flexible(joint) => Some(joint),
            BodyJoint::Locked { .. } => None,
        })
    }

    /// Number of joints that move.
    #[must_use]
    pub fn n_axes(&self) -> usize {
        self.joints().count()
    }

    /// The same arm at another pose, link positions in rad of the moving joints; a wrong number of
    /// them is found by [`Arm::check`].
    #[must_use]
    pub fn at_pose(&self, pose_rad: &[f64]) -> Self {
        Self {
            pose_rad: pose_rad.to_vec(),
            ..self.clone()
        }
    }
}
