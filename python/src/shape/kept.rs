//! Folder of a shaping in memory: its records, kept as they are measured.

use std::path::Path;

use frfid_experiment::KeptReferences;
use frfid_files::Overwrite;
use frfid_signals::Testbed;
use pyo3::PyResult;

use crate::error;

/// The same testbed with its records kept in a folder.
pub(super) fn kept<'a>(
    testbed: &'a dyn Testbed,
    folder: Option<&'a Path>,
    replaces: bool,
) -> PyResult<Option<KeptReferences<'a>>> {
    let overwrite = if replaces {
        Overwrite::Replace
    } else {
        Overwrite::Resume
    };
    let kept = folder.map(|folder| KeptReferences::new(testbed, folder, overwrite));
    kept.transpose().map_err(error::experiment)
}
