//! Folder of a shaping in memory: its records, kept as they are measured.

use std::path::Path;

use frfid_experiment::KeptReferences;
use frfid_signals::Testbed;
use pyo3::PyResult;

use crate::choice::resume_unless;
use crate::error;

/// The same testbed with its records kept in a folder.
pub(super) fn kept<'a>(
    testbed: &'a dyn Testbed,
    folder: Option<&'a Path>,
    replaces: bool,
) -> PyResult<Option<KeptReferences<'a>>> {
    let overwrite = resume_unless(replaces);
    let kept = folder.map(|folder| KeptReferences::new(testbed, folder, overwrite));
    kept.transpose().map_err(error::experiment)
}
