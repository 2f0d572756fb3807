//! Runs, plans and robot logs in MCAP (ROS 2), CSV and NPZ; results in JSON.
//!
//! Every file is written to `NAME.part`, synced and renamed, and never replaces another unless told
//! so. Every reader expects cut, flipped and hostile files: no panic, no memory beyond a stated
//! limit, and nothing lost without a [`Loss`] that says which samples are gone and why.

mod alignment;
mod atomic;
mod bytes;
mod cdr_read;
mod cdr_write;
mod clock;
mod csv_read;
mod error;
mod frf_columns;
#[cfg(test)]
mod hostile_tests;
mod joint_state;
mod json_array;
mod log;
mod log_map;
mod log_mcap;
#[cfg(test)]
mod log_tests;
mod loss;
mod mcap_chunk;
mod mcap_open;
mod mcap_read;
mod mcap_record;
mod mcap_summary;
mod mcap_write;
mod npz_read;
mod npz_write;
mod number;
mod plan_file;
mod plan_read;
#[cfg(test)]
mod plan_tests;
mod plan_write;
mod recover;
mod result;
mod ros2msg;
mod run_file;
mod run_read;
#[cfg(test)]
mod run_tests;
mod selector;
mod sha256;
mod structure;
mod topics;
mod value;

pub use atomic::{BoxError, Overwrite, check_free, create_folder, part_path, write_bytes};
pub use error::FileError;
pub use frf_columns::write_frf_csv;
pub use log::{Log, read_log};
pub use log_map::{LogMap, Signal};
pub use loss::Loss;
pub use npz_read::read_npz_array;
pub use npz_write::write_frf_npz;
pub use plan_file::{PlanEntry, PlanFile, PlanHead, PlannedRun};
pub use plan_write::write_plan;
pub use recover::{Recovered, recover};
pub use result::{Check, ResultFile, read_result, write_result};
pub use run_file::{RunFile, write_run};
pub use run_read::{RunLabel, read_run, read_run_label};
pub use sha256::{sha256_file, sha256_hex};
