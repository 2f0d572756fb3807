//! frfid: frequency response functions of flexible-joint robots by experiment.
//!
//! This crate is the façade: it re-exports the workspace's crates under one roof and adds nothing.

pub use frfid_cli as cli;
pub use frfid_estimate as estimate;
pub use frfid_experiment as experiment;
pub use frfid_files as files;
pub use frfid_paper as paper;
pub use frfid_plant as plant;
pub use frfid_report as report;
pub use frfid_signals as signals;

/// Compiles the Rust of the how-to.
#[cfg(doctest)]
#[doc = include_str!("../docs/how-to.md")]
struct HowTo;
