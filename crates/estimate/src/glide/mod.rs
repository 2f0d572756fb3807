//! Glide subtraction: what a constant velocity alone leaves in a record is taken off.

pub(crate) mod by_position;
pub(crate) mod in_time;
pub(crate) mod ripple_residual;
pub(crate) mod torque_table;
