//! Inspection of a recording: what is in it, how it is sampled, what is odd about every signal, and which log map its
//! names suggest.

mod axes;
mod family;
pub(crate) mod guess;
mod kind;
mod looked;
pub(crate) mod map_text;
mod times;

use std::path::Path;

use frfid_files::{Listing, list_recording};
use serde::Serialize;

use crate::error::ExperimentError;
use crate::inspect::guess::GuessedMap;
use crate::inspect::looked::looked;

pub use crate::inspect::looked::{GroupLook, SignalLook};

/// What a look at a recording found.
#[derive(Debug, Clone, Serialize)]
pub struct Inspection {
    /// What is in it.
    pub listing: Listing,
    /// How the signals of a group are sampled and what is odd about them, in the order of the listing's groups.
    pub looks: Vec<GroupLook>,
    /// The log map that names, types and values suggest; `None` without an input or an output among them.
    pub map: Option<GuessedMap>,
}

impl Inspection {
    /// Whether there are no numbers over time in it.
    #[must_use]
    pub fn has_no_signal(&self) -> bool {
        self.looks.iter().all(|look| look.signals.is_empty())
    }
}

/// Looks at every signal of a recording that frfid did not make.
///
/// # Errors
/// [`ExperimentError::File`]: no recording, or one of which nothing can be read. A group that cannot be read is
/// no error: its look says why.
pub fn inspect_recording(path: &Path) -> Result<Inspection, ExperimentError> {
    let listing = list_recording(path)?;
    let groups = listing.groups.iter();
    let looks: Vec<GroupLook> = groups.map(|group| looked(path, group)).collect();
    let map = GuessedMap::of(&listing, &looks);
    Ok(Inspection {
        listing,
        looks,
        map,
    })
}
