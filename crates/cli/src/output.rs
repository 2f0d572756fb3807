//! Writes a text file, never over another one unless told so.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use frfid_files::{FileError, Overwrite, part_path};

/// Writes `text` into `NAME.part`, syncs and renames: the file appears complete or not at all.
pub(crate) fn write_text(path: &Path, overwrite: Overwrite, text: &str) -> Result<(), FileError> {
    if overwrite == Overwrite::Refuse && path.symlink_metadata().is_ok() {
        return Err(FileError::Exists { path: path.to_path_buf() });
    }
    let part = part_path(path);
    let failed = |action| {
        let path = part.clone();
        move |error: std::io::Error| FileError::Io { path, action, reason: error.to_string() }
    };
    let mut file = File::create(&part).map_err(failed("create"))?;
    file.write_all(text.as_bytes()).map_err(failed("write"))?;
    file.sync_all().map_err(failed("write"))?;
    std::fs::rename(&part, path).map_err(failed("rename"))
}
