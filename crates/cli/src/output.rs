
/// Makes a folder with those above it; one that exists is fine.
///
/// # Errors
/// [`FileError::Io`].
pub(crate) fn make_folder(path: &Path) -> Result<(), FileError> {
    let failed =
        |error: std::io::Error| FileError::Io { path: path.to_path_buf(), action: "create", reason: error.to_string() };
    std::fs::create_dir_all(path).map_err(failed)
}
