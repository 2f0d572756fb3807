//! Source of imported runs: a recording, told by its content.

use std::path::{Path, PathBuf};

use frfid_files::sha256_file;

use crate::error::ExperimentError;
use crate::play::import::ImportedRun;
use crate::run::provenance::{Metadata, metadata};

const NAME: &str = "recording";
const HASH: &str = "recording_sha256";
const START: &str = "recording_start_s";
/// Two runs of one recording begin farther apart than this, in s.
const APART_S: f64 = 0.1;

/// A recording of others.
pub(super) struct Source {
    pub(super) path: PathBuf,
    /// Name and, of a file, hash.
    identity: Metadata,
}

impl Source {
    pub(super) fn of(path: &Path) -> Result<Self, ExperimentError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let mut identity = metadata([(NAME, name.into_owned())]);
        if path.is_file() {
            identity.insert(HASH.into(), sha256_file(path)?);
        }
        Ok(Self {
            path: path.into(),
            identity,
        })
    }

    /// Whether a run that is there already came from this place in this recording.
    pub(super) fn is_origin_of(&self, run: &Metadata, start_s: f64) -> bool {
        let key = if self.identity.contains_key(HASH) {
            HASH
        } else {
            NAME
        };
        let began_s = run.get(START).and_then(|start| start.parse().ok());
        let is_here = began_s.is_some_and(|began_s: f64| (began_s - start_s).abs() < APART_S);
        is_here && run.get(key) == self.identity.get(key)
    }

    /// Where a run comes from, as its file says.
    pub(super) fn provenance(&self, told: &ImportedRun) -> Metadata {
        let mut provenance = self.identity.clone();
        provenance.extend(metadata([
            (START, told.start_s.to_string()),
            ("recording_clock_ppm", told.clock_ppm.to_string()),
            ("recording_likeness", told.likeness.to_string()),
        ]));
        provenance
    }
}
