//! Reading of recordings: each one that can be read, cut to what is asked for; the others are named.

use std::path::{Path, PathBuf};

use frfid_files::{FileError, Log, LogMap, read_log, recording_parts, sha256_file};

use crate::error::ExperimentError;
use crate::estimate::others::recording::cut::cut;
use crate::estimate::others::recording::{Recording, Unused};
use crate::run::provenance::Metadata;

/// What was read.
pub(in crate::estimate::others) struct Read {
    pub(in crate::estimate::others) recordings: Vec<Recording>,
    pub(in crate::estimate::others) unused: Vec<Unused>,
}

/// Reads every recording. One that cannot be read does not stop the others.
///
/// # Errors
/// [`ExperimentError`] of the first recording if none can be read.
pub(in crate::estimate::others) fn read(
    paths: &[PathBuf],
    map: &LogMap,
) -> Result<Read, ExperimentError> {
    let (mut recordings, mut unused, mut first_error) = (Vec::new(), Vec::new(), None);
    for (place, path) in paths.iter().enumerate() {
        let name = path.display().to_string();
        match read_one(path, map) {
            Ok(log) => recordings.push(Recording::new(place, name, log)),
            Err(stopped @ ExperimentError::File(FileError::Stopped { .. })) => return Err(stopped),
            Err(error) => {
                unused.push(Unused::new(place, name, error.to_string()));
                first_error.get_or_insert(error);
            }
        }
    }
    match first_error {
        Some(error) if recordings.is_empty() => Err(error),
        _ => Ok(Read { recordings, unused }),
    }
}

fn read_one(path: &Path, map: &LogMap) -> Result<Log, ExperimentError> {
    cut(read_log(path, map)?, map.start_s, map.end_s)
}

/// The hash of every file, so that a result can be traced to its data.
///
/// # Errors
/// [`ExperimentError`] for files that are equal byte for byte: what was measured once is no second
/// measurement.
pub(in crate::estimate::others) fn hashes(paths: &[PathBuf]) -> Result<Metadata, ExperimentError> {
    let mut hashes: Vec<(String, PathBuf)> = Vec::new();
    for path in paths {
        for part in recording_parts(path)?
            .into_iter()
            .filter(|part| part.exists())
        {
            let hash = sha256_file(&part)?;
            if let Some((_, same)) = hashes.iter().find(|(other, _)| *other == hash) {
                return Err(copied(same, &part));
            }
            hashes.push((hash, part));
        }
    }
    let named = hashes.into_iter().map(|(hash, path)| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        (format!("sha256 of {name}"), hash)
    });
    Ok(named.collect())
}

fn copied(first: &Path, second: &Path) -> ExperimentError {
    ExperimentError::logs(
        "recordings",
        format!(
            "the same bytes in {} and {}",
            first.display(),
            second.display()
        ),
        "each recording once",
        "a copy is no second measurement: leave it out",
    )
}
