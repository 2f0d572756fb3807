//! The linear closed loop at the pose: its FRFs and its poles.

pub(crate) mod loop_frf;
pub(crate) mod loop_poles;
