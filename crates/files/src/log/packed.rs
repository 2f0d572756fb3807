//! Zstandard-compressed recordings (`.zst` of any format), unpacked into a temporary file while they are read.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use zstd::Decoder;

use crate::budget::Budget;
use crate::error::FileError;
use crate::file_kind::start_of;

const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// As much is unpacked at once.
const BLOCK: u64 = 1 << 20;

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
        let budget = Budget::on_disk(path, file.metadata().map_err(failed)?.len());
        let mut bytes = Decoder::new(file).map_err(failed)?;
        let mut temporary = NamedTempFile::new().map_err(failed)?;
        let (n_bytes, ended) = copy(&mut bytes, &mut temporary, budget)?;
        if let Err(error) = ended {
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

/// Copies block by block within the budget; returns how many bytes, and why there are no more.
fn copy(
    from: &mut impl Read,
    to: &mut impl Write,
    mut budget: Budget,
) -> Result<(u64, io::Result<()>), FileError> {
    let mut n_bytes = 0;
    loop {
        budget.take("what is packed in it", BLOCK)?;
        match io::copy(&mut from.by_ref().take(BLOCK), to) {
            Ok(0) => return Ok((n_bytes, Ok(()))),
            Ok(n) => n_bytes += n,
            Err(error) => return Ok((n_bytes, Err(error))),
        }
    }
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
        let bomb = zstd::encode_all(io::repeat(0).take(65 << 20), 3).expect("packed");
        std::fs::write(&path, &bomb).expect("written");
        let error = Unpacked::of(&path).map(|_| ()).expect_err("a bomb");
        assert!(
            error
                .to_string()
                .contains("what is packed in it would take")
        );
        std::fs::write(&path, &bomb[..bomb.len() / 2]).expect("written");
        let unpacked = Unpacked::of(&path).expect("the first half");
        assert!(unpacked.damage.is_some());
    }
}
