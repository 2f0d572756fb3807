//! Formats of recordings: the table that every reader, listing, help and error goes by. A format is
//! a file of this folder and a row here.

use std::path::Path;

use crate::error::FileError;
use crate::file_kind::{kind_of, start_of};
use crate::log::map::{LogMap, Signals};
use crate::log::packed::Unpacked;
use crate::log::recording::Recording;
use crate::log::{csv, db3, mat, mcap, npz};

/// A format of recordings.
#[derive(Debug)]
pub struct Format {
    /// Its name.
    pub name: &'static str,
    /// How the names of its files end, in lower case.
    pub endings: &'static [&'static str],
    /// How a signal is named in a [`LogMap`].
    pub source: &'static str,
    /// First bytes of its files; empty for text.
    magic: &'static [u8],
    /// Reads the signals of the map.
    pub(crate) read: fn(&Path, &LogMap, &Signals) -> Result<Recording, FileError>,
}

/// The formats of recordings.
pub const FORMATS: [Format; 5] = [
    Format {
        name: "MCAP",
        endings: &[".mcap"],
        source: "TOPIC:FIELD[INDEX or JOINT]",
        magic: ::mcap::MAGIC,
        read: mcap::read,
    },
    Format {
        name: "rosbag2 SQLite",
        endings: &[".db3"],
        source: "TOPIC:FIELD[INDEX or JOINT]",
        magic: db3::MAGIC,
        read: db3::read,
    },
    Format {
        name: "CSV",
        endings: &[".csv", ".csv.gz", ".txt", ".txt.gz"],
        source: "COLUMN",
        magic: b"",
        read: csv::read,
    },
    Format {
        name: "MAT",
        endings: &[".mat"],
        source: "NAME, STRUCT.FIELD, or either with [CHANNEL]",
        magic: mat::MAGIC,
        read: mat::read,
    },
    Format {
        name: "NPZ",
        endings: &[".npz"],
        source: "ARRAY or ARRAY[ROW]",
        magic: b"PK\x03\x04",
        read: npz::read,
    },
];

impl Format {
    /// Whether a file's name ends as this format's do, with `.zst` or `.zstd` behind it or not.
    #[must_use]
    pub fn has(&self, path: &Path) -> bool {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.to_lowercase();
        let packed = [".zst", ".zstd"].map(|ending| name.strip_suffix(ending));
        let name = packed.into_iter().flatten().next().unwrap_or(&name);
        self.endings.iter().any(|ending| name.ends_with(ending))
    }

    /// Reads the signals of a file of any format, told by its first bytes, then by the ending of its name.
    ///
    /// # Errors
    /// [`FileError`], [`FileError::Format`] that says what the file is instead of a recording.
    pub(crate) fn read_any(
        path: &Path,
        map: &LogMap,
        signals: &Signals,
    ) -> Result<Recording, FileError> {
        let unpacked = Unpacked::of(path)?;
        let start = start_of(unpacked.path())?;
        let format = Self::known(&unpacked.name(), &start);
        let format = format.ok_or_else(|| no_recording(path, &start))?;
        let read = (format.read)(unpacked.path(), map, signals);
        let mut recording = read.map_err(|error| unpacked.renamed(error))?;
        let damage = unpacked.damage.map(|reason| (None, reason));
        recording.damages.extend(damage);
        Ok(recording)
    }

    fn known(path: &Path, start: &[u8]) -> Option<&'static Self> {
        let by_content = FORMATS.iter().find(|format| format.begins(start));
        by_content.or_else(|| FORMATS.iter().find(|format| format.has(path)))
    }

    /// Whether a file that starts like this is of the format.
    fn begins(&self, start: &[u8]) -> bool {
        !self.magic.is_empty() && start.starts_with(self.magic)
    }
}

/// That a file of such a beginning is no recording.
pub(crate) fn no_recording(path: &Path, start: &[u8]) -> FileError {
    let (found, advice) = other_kind(start);
    FileError::format(path, found, "a recording", advice)
}

/// What a file of none of the formats is, and what to do with it.
fn other_kind(start: &[u8]) -> (&'static str, String) {
    match kind_of(start) {
        Some((found, advice)) => (found, advice.to_owned()),
        None => (
            "an unknown kind of file",
            format!("frfid reads {}; each of them as .zst, too", described()),
        ),
    }
}

/// Every format with the endings of its files.
fn described() -> String {
    let described = |format: &Format| format!("{} ({})", format.name, format.endings.join(", "));
    FORMATS.iter().map(described).collect::<Vec<_>>().join(", ")
}
