//! Runs, plans and robot logs in MCAP (ROS 2), CSV and NPZ; results in JSON.
//!
//! Every file is written to `NAME.part`, synced and renamed, and never replaces another unless told
//! so. Every reader expects cut, flipped and hostile files: no panic, no memory beyond a stated
//! limit, and nothing lost without a [`Loss`] that says which samples are gone and why.

mod atomic_write;
mod budget;
mod bytes;
mod error;
mod file_kind;
mod found_kind;
#[cfg(test)]
mod hostile_tests;
mod log;
mod loss;
mod mat_write;
/// MCAP containers: read with every checksum, written, recovered.
mod mcap {
    pub(crate) mod chunk;
    pub(crate) mod open;
    pub(crate) mod plain_chunk;
    pub(crate) mod read;
    pub(crate) mod record;
    pub(crate) mod recover;
    pub(crate) mod summary;
    pub(crate) mod walk;
    pub(crate) mod write;
}
mod path_text;
mod plan;
mod playback;
mod result;
/// ROS 2 messages: definitions, CDR, and values picked out of them.
mod ros {
    pub(crate) mod cdr_read;
    pub(crate) mod cdr_write;
    pub(crate) mod definition;
    pub(crate) mod field;
    pub(crate) mod joint_state;
    pub(crate) mod known_types;
    pub(crate) mod layout;
    pub(crate) mod selector;
    pub(crate) mod trajectory;
    pub(crate) mod value;
}
/// Run files: what one run measured, and where it comes from.
mod run {
    pub(crate) mod header;
    pub(crate) mod read;
    mod sample;
    pub(crate) mod samples;
    #[cfg(test)]
    pub(crate) mod tests;
    pub(crate) mod topics;
    pub(crate) mod write;
}
mod sha256;
mod visible;

pub use atomic_write::{
    BoxError, Overwrite, check_free, check_not_read, create_folder, part_path, write_bytes,
};
pub use budget::{limit_memory, stop_reading};
pub use error::FileError;
pub use found_kind::FileKind;
pub use log::arrays::npz::read_npz_array;
pub use log::bag::folder::{is_bag_folder, recording_parts};
pub use log::csv::dialect::CsvTable;
pub use log::formats::{FORMATS, Format};
pub use log::listing::{ListedSignal, Listing, SignalGroup, list_recording};
pub use log::map::{LogMap, Signal};
pub use log::plan_clock::PlanClock;
pub use log::units::si_unit;
pub use log::{ClockFit, Log, read_log};
pub use loss::Loss;
pub use mcap::recover::{Recovered, recover};
pub use path_text::{path_text, serialize_path, serialize_paths};
pub use plan::write::write_plan;
pub use plan::{PlanEntry, PlanFile, PlanHead, PlannedRun};
pub use playback::PlaybackFile;
pub use playback::csv::write_playback_csv;
pub use playback::exported::{Exported, Rehearsal};
pub use playback::form::{AngleUnit, DecimalMark, Separator, TableForm};
pub use playback::formats::{PLAY_FORMATS, PlayFormat};
pub use playback::order::{OrderEntry, write_order};
pub use result::exports::{EXPORTS, Export};
pub use result::json::{read_result, write_result};
pub use result::result_file::{Check, ResultFile};
pub use result::verdict::{Cause, Verdict};
pub use result::verdict_table::{Cell, SOUND, VerdictTable};
pub use run::read::{RunLabel, read_run, read_run_label};
pub use run::write::{RunFile, write_run};
pub use sha256::{sha256_file, sha256_hex};
pub use visible::visible;
