//! Zstandard-compressed recordings (`.zst` of any format), unpacked into a temporary file while they are read.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use zstd::Decoder;

use crate::error::FileError;
use crate::file_kind::start_of;

const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// More than this is no recording but a file that fills a disk: 64 GiB.
const MOST_BYTES: u64 = 64 << 30;
/// A compressed file may be this many times longer when unpacked.
const MOST_RATIO: u64 = 2000;
/// As long as this any ratio is fine: 64 MiB.
const ANY_RATIO: u64 = 64 << 20;

/// A file, or what was compressed in it.
pub(crate) struct Unpacked<'p> {
    original: &'p Path,
    /// Deleted when it is dropped.
    temporary: Option<NamedTempFile>,
    /// Why the rest could not be unpacked.
    pub(crate) damage: Option<String>,
}

impl<'p> Unpacked<'p> {
    /// Unpacks a file that starts as Zstandard does; any other is taken as it is.
    ///
    /// # Errors
    /// [`FileError::Io`] where nothing of it can be unpacked; [`FileError::Format`] for one that grows beyond
    /// reason.
    pub(crate) fn of(path: &'p Path) -> Result<Self, FileError> {
        let mut unpacked = Self {
            original: path,
            temporary: None,
            damage: None,
        };
        if start_of(path)?.starts_with(ZSTD) {
            unpacked.unpack()?;
        }
        Ok(unpacked)
    }

    /// Unpacks it as far as it can be.
    fn unpack(&mut self) -> Result<(), FileError> {
        let path = self.original;
        let failed = FileError::cannot("unpack", path);
        let file = File::open(path).map_err(failed)?;
        let limit = limit(file.metadata().map_err(failed)?.len());
        let mut bytes = Decoder::new(file).map_err(failed)?.take(limit);
        let mut temporary = NamedTempFile::new().map_err(failed)?;
        let copied = io::copy(&mut bytes, &mut temporary);
        if bytes.limit() == 0 {
            return Err(too_long(path, limit));
        }
        if let Err(error) = copied {
            let n_bytes = temporary.as_file().metadata().map_err(failed)?.len();
            if n_bytes == 0 {
                return Err(failed(error));
            }
            self.damage = Some(format!("unpacked as far as {n_bytes} bytes: {error}"));
        }
        self.temporary = Some(temporary);
        Ok(())
    }

    /// Where the bytes are.
    pub(crate) fn path(&self) -> &Path {
        self.temporary
            .as_ref()
            .map_or(self.original, NamedTempFile::path)
    }

    /// The name of the file without the ending of the compression, by which its format is told.
    pub(crate) fn name(&self) -> PathBuf {
        match self.temporary {
            Some(_) => self.original.with_extension(""),
            None => self.original.to_owned(),
        }
    }

    /// An error under the name of the file that was given.
    pub(crate) fn renamed(&self, error: FileError) -> FileError {
        error.of_file(self.original)
    }
}

/// What a file of so many bytes may unpack to.
fn limit(n_bytes: u64) -> u64 {
    n_bytes
        .saturating_mul(MOST_RATIO)
        .clamp(ANY_RATIO, MOST_BYTES)
}

fn too_long(path: &Path, limit: u64) -> FileError {
    let found = format!("more than {limit} bytes in a small compressed file");
    let advice = "if it is one, unpack it yourself and give what was in it";
    FileError::format(path, found, "a recording", advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zstandard_is_unpacked_and_the_rest_is_left() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("log.csv.zst");
        let text = b"t,u\n0,1\n";
        let zstd = zstd::encode_all(&text[..], 3).expect("packed");
        for bytes in [zstd, text.to_vec()] {
            std::fs::write(&path, bytes).expect("written");
            let unpacked = Unpacked::of(&path).expect("sound");
            assert_eq!(std::fs::read(unpacked.path()).expect("there"), text);
            assert_eq!(unpacked.damage, None);
        }
    }

    #[test]
    fn what_grows_without_end_is_refused_and_of_what_is_cut_the_beginning_is_kept() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("log.mcap.zst");
        let bomb = zstd::encode_all(io::repeat(0).take(ANY_RATIO + 1), 3).expect("packed");
        std::fs::write(&path, &bomb).expect("written");
        let error = Unpacked::of(&path).map(|_| ()).expect_err("a bomb");
        assert!(error.to_string().contains("in a small compressed file"));
        std::fs::write(&path, &bomb[..bomb.len() / 2]).expect("written");
        let unpacked = Unpacked::of(&path).expect("the first half");
        assert!(unpacked.damage.is_some());
    }
}
