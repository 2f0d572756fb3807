//! Formats of recordings: the table that every reader, listing, help and error goes by. A format is
//! a file of this folder and a row here.

use std::path::Path;

use crate::error::FileError;
use crate::file_kind::{kind_of, start_of};
use crate::log::arrays::npz;
use crate::log::bag::{db3, mcap};
use crate::log::listing::Listing;
use crate::log::map::{LogMap, Signals};
use crate::log::packed::Unpacked;
use crate::log::recording::Recording;
use crate::log::{csv, mat};

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
    /// Lists what is in it.
    list: fn(&Path) -> Result<Listing, FileError>,
}

/// The formats of recordings.
pub const FORMATS: [Format; 5] = [
    Format {
        name: "MCAP",
        endings: &[".mcap"],
        source: "TOPIC:FIELD[INDEX or JOINT]",
        magic: ::mcap::MAGIC,
        read: mcap::read,
        list: mcap::list,
    },
    Format {
        name: "rosbag2 SQLite",
        endings: &[".db3"],
        source: "TOPIC:FIELD[INDEX or JOINT]",
        magic: db3::MAGIC,
        read: db3::read,
        list: db3::list,
    },
    Format {
        name: "CSV",
        endings: &[
            ".csv", ".csv.gz", ".txt", ".txt.gz", ".tsv", ".dat", ".asc", ".prn",
        ],
        source: "COLUMN",
        magic: b"",
        read: csv::read,
        list: csv::listing::list,
    },
    Format {
        name: "MAT",
        endings: &[".mat"],
        source: "NAME, STRUCT.FIELD, or either with [CHANNEL]",
        magic: mat::MAGIC,
        read: mat::read,
        list: mat::list,
    },
    Format {
        name: "NPZ",
        endings: &[".npz"],
        source: "ARRAY or ARRAY[ROW]",
        magic: b"PK\x03\x04",
        read: npz::read,
        list: npz::list,
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
        let format = Self::of(&unpacked)?;
        let read = (format.read)(unpacked.path(), map, signals);
        let mut recording = read.map_err(|error| unpacked.renamed(error))?;
        let damage = unpacked.damage.map(|reason| (None, reason));
        recording.damages.extend(damage);
        Ok(recording)
    }

    /// Lists what is in a file of any format.
    ///
    /// # Errors
    /// [`FileError`], as [`Format::read_any`].
    pub(crate) fn list_any(path: &Path) -> Result<Listing, FileError> {
        let unpacked = Unpacked::of(path)?;
        let format = Self::of(&unpacked)?;
        let listed = (format.list)(unpacked.path());
        let mut listing = listed.map_err(|error| unpacked.renamed(error))?;
        listing.told.extend(unpacked.damage);
        Ok(listing)
    }

    /// The format of a file, or what else it is.
    fn of(unpacked: &Unpacked) -> Result<&'static Self, FileError> {
        let start = start_of(unpacked.path())?;
        let format = Self::known(&unpacked.name(), &start);
        format.ok_or_else(|| unpacked.renamed(no_recording(unpacked.path(), &start)))
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
