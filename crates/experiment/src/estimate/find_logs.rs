//! Logs among files and folders.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use frfid_files::{FORMATS, FileError, Format};

use crate::error::ExperimentError;

/// The files among `paths` in the order given, the recordings of a folder by name, each file once.
///
/// The recordings of a folder are of one format: the first of [`FORMATS`] that it holds.
///
/// # Errors
/// [`ExperimentError::File`] for a path that does not exist or cannot be listed,
/// [`ExperimentError::Logs`] for none.
pub(crate) fn find_logs(paths: &[PathBuf]) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut found: Vec<PathBuf> = Vec::new();
    for path in paths {
        let metadata = std::fs::metadata(path).map_err(FileError::cannot("read", path))?;
        if metadata.is_dir() {
            found.extend(recordings_inside(path)?);
        } else {
            found.push(path.clone());
        }
    }
    if found.is_empty() {
        return Err(no_recordings());
    }
    Ok(each_once(found))
}

fn each_once(mut paths: Vec<PathBuf>) -> Vec<PathBuf> {
    let mut seen = BTreeSet::new();
    paths.retain(|path| seen.insert(path.clone()));
    paths
}

fn no_recordings() -> ExperimentError {
    let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    ExperimentError::logs(
        "recordings",
        format!("no {} file", names.join(", ")),
        "at least one",
        "name files, or folders that hold them",
    )
}

/// The recordings of a folder, by name.
fn recordings_inside(folder: &Path) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut files = BTreeSet::new();
    let unreadable = FileError::cannot("read", folder);
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        files.insert(entry.map_err(unreadable)?.path());
    }
    let has_any = |format: &&Format| files.iter().any(|path| format.has(path));
    if let Some(format) = FORMATS.iter().find(has_any) {
        files.retain(|path| format.has(path));
        return Ok(files.into_iter().collect());
    }
    Ok(Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_holds_recordings_of_one_format_by_name() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let paths = [folder.path().to_owned()];
        let touch = |name: &str| std::fs::write(folder.path().join(name), "x").expect("written");
        let names = || -> Vec<String> {
            let found = find_logs(&paths).expect("some");
            let name = |path: &PathBuf| path.file_name()?.to_str().map(String::from);
            found.iter().filter_map(name).collect()
        };
        touch("metadata.yaml");
        let error = find_logs(&paths).expect_err("no recording").to_string();
        assert!(
            error.contains("no MCAP, rosbag2 SQLite, CSV, MAT, NPZ file"),
            "{error}"
        );
        touch("b.CSV");
        touch("a.csv.gz");
        assert_eq!(names(), ["a.csv.gz", "b.CSV"]);
        touch("z.mcap");
        assert_eq!(names(), ["z.mcap"]);
    }
}
