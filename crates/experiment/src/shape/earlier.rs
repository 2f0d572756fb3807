//! Earlier shaping in a folder: whether it is the same one, unchanged, and its removal.

use std::path::{Path, PathBuf};

use frfid_files::{FileError, sha256_file};

use crate::error::ExperimentError;
use crate::shape::iteration_files::{BEST, NAMES, iteration_name};
use crate::shape::report::{ANOTHER_FOLDER, FILE, IterationReport, ShapeReport};

/// Refuses a folder that holds another shaping, or files that were changed since they were written.
pub(crate) fn check_same(
    folder: &Path,
    before: &ShapeReport,
    now: &ShapeReport,
) -> Result<(), ExperimentError> {
    if before.config_sha256 != now.config_sha256 {
        return Err(ExperimentError::trail(
            &folder.join(FILE),
            "the shaping of another description",
            "one of this description",
            ANOTHER_FOLDER,
        ));
    }
    for (path, hash) in written(folder, before) {
        if path.exists() && sha256_file(&path)? != hash {
            return Err(ExperimentError::trail(
                &path,
                "another content",
                "the file as it was written",
                "put the original back; or delete it, and it is made again",
            ));
        }
    }
    Ok(())
}

/// Every file that a shaping wrote, with its hash.
fn written<'a>(
    folder: &'a Path,
    report: &'a ShapeReport,
) -> impl Iterator<Item = (PathBuf, &'a str)> {
    let best = report.frf_sha256.iter();
    let best = best.map(|hash| (folder.join(BEST), hash.as_str()));
    let iterations = report.iterations.iter();
    best.chain(iterations.flat_map(|iteration| files_of(folder, iteration)))
}

/// Every file of an iteration, with its hash.
fn files_of<'a>(
    folder: &Path,
    iteration: &'a IterationReport,
) -> impl Iterator<Item = (PathBuf, &'a str)> + use<'a> {
    let folder = folder.join(iteration_name(iteration.number));
    let files = iteration.files.iter();
    files.map(move |(name, hash)| (folder.join(name), hash.as_str()))
}

/// Removes the best FRF and the iterations of an earlier shaping, of their folders what frfid wrote
/// into them.
pub(crate) fn clear(folder: &Path) -> Result<(), FileError> {
    let best = folder.join(BEST);
    if best.exists() {
        remove(&best)?;
    }
    for number in 1.. {
        if !clear_iteration(&folder.join(iteration_name(number)))? {
            break;
        }
    }
    Ok(())
}

/// Removes what frfid wrote into the folder of an iteration, and the folder where nothing else is
/// in it; returns whether there was one.
fn clear_iteration(folder: &Path) -> Result<bool, FileError> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Ok(false);
    };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        if is_ours(&path) {
            remove(&path)?;
        }
    }
    std::fs::remove_dir(folder).ok(); // stays where somebody keeps files of his own in it
    Ok(true)
}

/// Whether a file in the folder of an iteration has a name that frfid gives, complete or not.
fn is_ours(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".part").unwrap_or(&name);
    name.ends_with(".mcap") || NAMES.contains(&name)
}

fn remove(path: &Path) -> Result<(), FileError> {
    std::fs::remove_file(path).map_err(FileError::cannot("remove", path))
}
