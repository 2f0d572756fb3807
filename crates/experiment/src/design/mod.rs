//! Design: from a description to its plan, and what the plan will ask of the robot.

pub(crate) mod cost;
pub(crate) mod plan;
pub(crate) mod predict;
pub(crate) mod preflight;
