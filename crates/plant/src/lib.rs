//! A flexible-joint robot in software: friction, spring, RK4, sensors, controller, testbeds.
//!
//! Everything on the joint side of the gear, SI units inside, Hz for public frequencies. The
//! numeric core knows no files, no clock and no global random state. Equation numbers are those of
//! Saupe and Knoblach, MSSP 52-53 (2015) 60-72 (SK15).

mod arm;
mod challenges;
mod control;
mod error;
mod joint;
mod linear_loop;
mod motion;
mod robot;
mod single_joint;
mod state_space;
mod testbed;

pub use arm::inertia::Inertia;
pub use arm::{Arm, Body, BodyJoint, Payload};
pub use challenges::{Challenges, is_posed};
pub use control::pi::PiController;
pub use control::sensor::Sensor;
pub use control::watch::Watch;
pub use error::PlantError;
pub use joint::flexible_joint::FlexibleJoint;
pub use joint::friction::{Friction, Slip};
pub use joint::ripple::Ripple;
pub use joint::spring::{Branch, Spring};
pub use linear_loop::loop_frf::LoopFrf;
pub use linear_loop::loop_poles::{check_stability, loop_poles};
pub use motion::equations::{Links, Machine, SingleLink};
pub use motion::integrator::Integrator;
pub use motion::scalar::Scalar;
pub use motion::segment::Segment;
pub use motion::trajectory::Trajectory;
pub use motion::{Acting, Motion};
pub use robot::Robot;
pub use single_joint::SingleJoint;
pub use state_space::{Hold, StateSpace};
pub use testbed::closed_loop::ClosedLoop;
pub use testbed::open_loop::OpenLoop;
pub use testbed::simulate::{Clock, Torque, simulate};
