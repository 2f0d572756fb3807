//! Listing of a recording: its topics, tables and arrays, and every signal of numbers in them by the name that a
//! log map has for it.

use std::path::Path;

use serde::Serialize;

use crate::error::FileError;
use crate::log::bag::folder;
use crate::log::formats::Format;

/// How many first values of a signal are listed.
pub(crate) const N_FIRST: usize = 64;

/// What is in a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Listing {
    /// Name of the format.
    pub format: &'static str,
    /// Topics of a bag, the table of a CSV, arrays of one length.
    pub groups: Vec<SignalGroup>,
    /// How it was read, and what could not be.
    pub told: Vec<String>,
}

/// Signals that are sampled together.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct SignalGroup {
    /// Name of the topic; what else it is.
    pub name: String,
    /// Type of the topic's messages.
    pub type_name: Option<String>,
    /// Number of messages or samples; `None` where the file was not read to its end.
    pub n_rows: Option<usize>,
    /// Its signals; none where it has no numbers.
    pub signals: Vec<ListedSignal>,
}

/// A signal of numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ListedSignal {
    /// Its name in a log map.
    pub source: String,
    /// Its unit as the file writes it; `None` where it says none.
    pub unit: Option<String>,
    /// Its first values, for a look at them; NaN where there is none.
    #[serde(skip)]
    pub first: Vec<f64>,
    /// Whether its values are moments, a date or a time of day.
    pub is_moment: bool,
}

impl ListedSignal {
    /// A signal of plain numbers.
    pub(crate) fn of(source: String, unit: Option<String>, first: Vec<f64>) -> Self {
        Self {
            source,
            unit,
            first,
            is_moment: false,
        }
    }
}

/// Lists what is in a recording of any of the formats, or in the folder of one by rosbag2.
///
/// # Errors
/// [`FileError`]: no recording, or one that cannot be read.
pub fn list_recording(path: &Path) -> Result<Listing, FileError> {
    if folder::is_bag_folder(path) {
        return folder::list(path);
    }
    Format::list_any(path)
}
