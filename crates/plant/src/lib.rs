//! Flexible-joint robots in software: friction, spring, RK4, sensors, controller, testbeds.
//!
//! Everything on the joint side of the gear, SI units inside, Hz for public frequencies. The
//! numeric core knows no files, no clock and no global random state. Equation numbers are those of
//! Saupe and Knoblach, MSSP 52-53 (2015) 60-72 (SK15).

mod arm;
/// Control: sensors, controllers of the motor velocity, and the watch over limits.
mod control {
    pub(crate) mod biquad;
    pub(crate) mod changes;
    pub(crate) mod controller;
    pub(crate) mod filtered_pi;
    pub(crate) mod pi;
    pub(crate) mod sensor;
    pub(crate) mod torque_limits;
    pub(crate) mod watch;
}
mod error;
/// A flexible joint: motor, gear, friction and torque ripple of one axis.
mod joint {
    pub(crate) mod flexible_joint;
    pub(crate) mod friction;
    pub(crate) mod ripple;
    pub(crate) mod spring;
}
/// The linear closed loop at the pose: its FRFs and poles.
mod linear {
    pub(crate) mod loop_frf;
    pub(crate) mod loop_poles;
}
mod lanes;
mod motion;
mod register;
mod robot;
mod scalar;
mod sine;
mod single_joint;
mod state_space;
/// Testbeds: a run goes in, a record comes out, sample by sample.
mod testbed {
    pub(crate) mod command;
    pub(crate) mod integration;
    pub(crate) mod recorder;
    pub(crate) mod run_loop;
    pub(crate) mod runs;
    pub(crate) mod simulate;
    pub(crate) mod simulated_robot;
}

pub use arm::challenges::{Challenges, is_posed};
pub use arm::inertia::Inertia;
pub use arm::{Arm, Body, BodyJoint, Payload};
pub use control::controller::{Controller, ControllerAxis, ControllerOutput, LinearController};
pub use control::filtered_pi::{FilteredPi, TorqueLowPass, TorqueNotch};
pub use control::pi::PiController;
pub use control::sensor::Sensor;
pub use control::watch::{Reached, Watch};
pub use error::PlantError;
pub use joint::flexible_joint::FlexibleJoint;
pub use joint::friction::Friction;
pub use joint::ripple::Ripple;
pub use joint::spring::Spring;
pub use linear::loop_frf::LoopFrf;
pub use linear::loop_poles::{check_stability, loop_poles};
pub use motion::mechanics::LinkDynamics;
pub use motion::trajectory::Trajectory;
pub use motion::{Acting, Motion};
pub use robot::Robot;
pub use single_joint::SingleJoint;
pub use state_space::{Hold, StateSpace};
pub use testbed::integration::Integration;
pub use testbed::simulate::{Torque, simulate};
pub use testbed::simulated_robot::{Actuation, Simulated, SimulatedRobot, simulate_robots};
