//! Path as text in JSON: what of it is no UTF-8 is replaced, never refused.

use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};

/// A path as text, U+FFFD in place of what is no UTF-8.
#[must_use]
pub fn path_text(path: impl AsRef<Path>) -> String {
    path.as_ref().to_string_lossy().into_owned()
}

/// Serializes a path as its text.
///
/// # Errors
/// Those of the serializer.
pub fn serialize_path<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    path.to_string_lossy().serialize(serializer)
}

/// Serializes paths as their texts.
///
/// # Errors
/// Those of the serializer.
pub fn serialize_paths<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(paths.iter().map(path_text))
}
