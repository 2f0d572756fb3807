//! A flexible-joint robot in software: friction, spring, RK4, sensors, controller, testbeds.
//!
//! Everything on the joint side of the gear, SI units inside, Hz for public frequencies. The
//! numeric core knows no files, no clock and no global random state. Equation numbers are those of
//! Saupe and Knoblach, MSSP 52-53 (2015) 60-72 (SK15).

mod arm;
mod arm_check;
mod arm_robot;
mod chain;
mod chain_dynamics;
mod challenges;
mod closed_loop;
mod controller;
pub mod dynamics;
#[cfg(test)]
mod dynamics_tests;
mod error;
mod exit;
mod flexible_joint;
mod friction;
mod frozen;
mod joint;
mod lane;
mod linear;
mod loop_frf;
mod loop_poles;
mod mechanics;
mod motion;
mod moving;
mod open_loop;
mod positive_definite;
mod recorder;
mod rig;
mod rigid;
mod ripple;
mod robot;
mod root;
mod segment;
mod sensor;
mod simulate;
mod spring;
mod trajectory;
mod truth;
mod watch;

pub use arm::{Arm, Body, BodyJoint, Payload};
pub use challenges::Challenges;
pub use closed_loop::ClosedLoop;
pub use controller::PiController;
pub use dynamics::{Drive, Inertia, Links, Machine};
pub use error::PlantError;
pub use flexible_joint::FlexibleJoint;
pub use friction::{Friction, Slip};
pub use joint::SingleJoint;
pub use lane::Lane;
pub use linear::{Hold, StateSpace};
pub use loop_frf::LoopFrf;
pub use loop_poles::{check_stability, loop_poles};
pub use motion::Motion;
pub use moving::{Acting, Moving};
pub use open_loop::OpenLoop;
pub use ripple::Ripple;
pub use robot::Robot;
pub use segment::Segment;
pub use sensor::{Sensor, Velocity};
pub use simulate::{Clock, Torque, simulate};
pub use spring::{Branch, Spring};
pub use trajectory::Trajectory;
pub use watch::Watch;
