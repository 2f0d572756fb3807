//! Reader of a file that gives out a bounded number of bytes: an index that leads to itself ends.

use std::fs::File;
use std::sync::atomic::{AtomicU64, Ordering};

use hdf5_pure::{FormatError, ReadSeekSource, Source};

/// A sound file is read a few times over at most: its index, its headers and its numbers.
const TIMES: u64 = 16;
/// What a small file may ask for in addition.
const BYTES: u64 = 16 << 20;
/// What a read costs beside its bytes.
const READ: u64 = 64;

/// A file with the bytes that may still be read.
pub(super) struct Metered {
    file: ReadSeekSource<File>,
    left: AtomicU64,
}

impl Metered {
    /// Of a file, with its size.
    pub(super) fn of(file: File) -> Result<(Self, u64), FormatError> {
        let file = ReadSeekSource::new(file)?;
        let size = file.len();
        let left = size.saturating_mul(TIMES).saturating_add(BYTES).into();
        Ok((Self { file, left }, size))
    }
}

impl Source for Metered {
    fn len(&self) -> u64 {
        self.file.len()
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> Result<(), FormatError> {
        let cost = READ + buffer.len() as u64;
        let spent = |left: u64| left.checked_sub(cost);
        let order = Ordering::Relaxed;
        match self.left.fetch_update(order, order, spent) {
            Ok(_) => self.file.read_at(offset, buffer),
            Err(_) => Err(FormatError::Source(
                "its index leads to the same places again and again".into(),
            )),
        }
    }
}
