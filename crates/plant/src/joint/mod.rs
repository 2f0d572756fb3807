//! A flexible joint: motor, gear, friction and torque ripple of one axis.

pub(crate) mod flexible_joint;
pub(crate) mod friction;
pub(crate) mod ripple;
pub(crate) mod spring;
