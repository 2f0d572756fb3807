//! Estimates: from the records of a plan, or of somebody else, to an FRF with its checks.

pub(crate) mod estimator;
pub(crate) mod glide_baseline;
pub(crate) mod others_logs;
pub(crate) mod our_logs;
pub(crate) mod outcome;
pub(crate) mod records;
pub(crate) mod ripple_residual;
pub(crate) mod strength;
