//! Files that an object was read from: they are not replaced by what is made of it.

use std::path::{Path, PathBuf};

use frfid_files::check_not_read;
use pyo3::prelude::*;

use crate::error;

/// The files; none for what was made in memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sources(Vec<PathBuf>);

impl Sources {
    /// Those that were read.
    pub(crate) fn of(paths: impl IntoIterator<Item = PathBuf>) -> Self {
        Self(paths.into_iter().collect())
    }

    /// Refuses an output that is one of them, whatever was said of replacing.
    ///
    /// # Errors
    /// `FileExistsError`.
    pub(crate) fn check(&self, output: &Path) -> PyResult<()> {
        let paths = self.0.iter().map(PathBuf::as_path);
        check_not_read(output, paths).map_err(error::file)
    }
}
