//! Runs, plans and robot logs in MCAP (ROS 2), CSV and NPZ; results in JSON.
//!
//! Every file is written to `NAME.part`, synced and renamed, and never replaces another unless told
//! so. Every reader expects cut, flipped and hostile files: no panic, no memory beyond a stated
//! limit, and nothing lost without a [`Loss`] that says which samples are gone and why.

mod atomic_write;
mod bytes;
mod error;
#[cfg(test)]
mod hostile_tests;
mod log;
mod loss;
mod mcap;
mod plan;
mod result;
mod ros;
mod run;
mod sha256;

pub use atomic_write::{BoxError, Overwrite, check_free, create_folder, part_path, write_bytes};
pub use error::FileError;
pub use log::map::{LogMap, Signal};
pub use log::npz::read_npz_array;
pub use log::{Log, read_log};
pub use loss::Loss;
pub use mcap::recover::{Recovered, recover};
pub use plan::write::write_plan;
pub use plan::{PlanEntry, PlanFile, PlanHead, PlannedRun};
pub use result::csv::write_frf_csv;
pub use result::npz::write_frf_npz;
pub use result::{Check, ResultFile, read_result, write_result};
pub use run::read::{RunLabel, read_run, read_run_label};
pub use run::write::{RunFile, write_run};
pub use sha256::{sha256_file, sha256_hex};
