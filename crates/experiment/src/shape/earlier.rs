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
        return Err(unfit(
            &folder.join(FILE),
            "the shaping of another description".into(),
            "one of this description",
            ANOTHER_FOLDER,
        ));
    }
    for (path, hash) in written(folder, before) {
        if path.exists() && sha256_file(&path)? != hash {
            let advice = "put the original back; or delete it, and it is made again";
            return Err(unfit(
                &path,
                "another content".into(),
                "the file as it was written",
                advice,
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
    let of_iteration = |iteration: &'a IterationReport| {
        let folder = folder.join(iteration_name(iteration.number));
        let files = iteration.files.iter();
        files.map(move |(name, hash)| (folder.join(name), hash.as_str()))
    };
    best.chain(report.iterations.iter().flat_map(of_iteration))
}

pub(crate) fn unfit(
    path: &Path,
    found: String,
    needed: &'static str,
    advice: &'static str,
) -> ExperimentError {
    ExperimentError::Trail {
        path: path.to_owned(),
        found,
        needed,
        advice,
    }
}

/// Removes the best FRF and the iterations of an earlier shaping, of their folders what frfid wrote
/// into them.
pub(crate) fn clear(folder: &Path) -> Result<(), FileError> {
    if folder.join(BEST).exists() {
        remove(&folder.join(BEST))?;
    }
    for number in 1.. {
        let iteration = folder.join(iteration_name(number));
        let Ok(entries) = std::fs::read_dir(&iteration) else {
            break;
        };
        for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
            if is_ours(&path) {
                remove(&path)?;
            }
        }
        std::fs::remove_dir(&iteration).ok(); // stays where somebody keeps files of his own in it
    }
    Ok(())
}

/// Whether a file in the folder of an iteration has a name that frfid gives, complete or not.
fn is_ours(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".part").unwrap_or(&name);
    name.ends_with(".mcap") || NAMES.contains(&name)
}

fn remove(path: &Path) -> Result<(), FileError> {
    std::fs::remove_file(path).map_err(|error| FileError::Io {
        path: path.to_owned(),
        action: "remove",
        reason: error.to_string(),
    })
}
