//! Runs: done on a testbed, several at once, and kept.

pub(crate) mod folder;
pub(crate) mod load;
pub(crate) mod parallel;
pub(crate) mod planned_runs;
pub(crate) mod provenance;
pub(crate) mod simulated;
