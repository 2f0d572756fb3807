//! Order of play: which file holds which run, how often and how long it is played.

use std::path::Path;

use crate::atomic_write::{Overwrite, write_bytes};
use crate::error::FileError;

/// A run in the order of play.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderEntry {
    /// The first of its repetitions.
    pub run: String,
    /// How often it is played, one after the other.
    pub n_repetitions: usize,
    /// The file that holds it, beside the list.
    pub file: String,
    /// Its first sample in that file.
    pub first_k: usize,
    /// Samples of each repetition, from rest to rest.
    pub n_samples: usize,
    /// Samples of the run itself, lead-in and periods, and where it begins within the repetition.
    pub run_first_k: usize,
    /// See [`OrderEntry::run_first_k`].
    pub run_samples: usize,
    /// Duration of each repetition in s.
    pub duration_s: f64,
    /// The plan, see [`PlaybackFile::plan_id`](crate::PlaybackFile::plan_id).
    pub plan_id: u32,
}

const COLUMNS: &str =
    "order,run,repetitions,file,first_k,samples,run_first_k,run_samples,duration_s,plan_id";

/// Writes `runs.csv`: a row for each run, in the order in which they are played.
///
/// # Errors
/// Those of writing (see [`Overwrite`]).
pub fn write_order(
    path: &Path,
    overwrite: Overwrite,
    order: &[OrderEntry],
) -> Result<(), FileError> {
    let rows = order.iter().enumerate();
    let rows: String = rows.map(|(place, entry)| entry.row(place + 1)).collect();
    let text = format!("{COLUMNS}\n{rows}");
    write_bytes(path, overwrite, text.as_bytes())
}

impl OrderEntry {
    fn row(&self, place: usize) -> String {
        let (run, file, n_repetitions) = (&self.run, &self.file, self.n_repetitions);
        let samples = [
            self.first_k,
            self.n_samples,
            self.run_first_k,
            self.run_samples,
        ];
        let samples = samples.map(|number| number.to_string()).join(",");
        let (duration_s, plan_id) = (self.duration_s, self.plan_id);
        format!("{place},{run},{n_repetitions},{file},{samples},{duration_s:?},{plan_id}\n")
    }
}
