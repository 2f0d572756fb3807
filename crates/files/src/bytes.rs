//! Cursor over bytes that came from a file: every step is checked against the bytes left before
//! anything is allocated.

/// More bytes were asked for than are left.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("needs {needed} bytes at offset {at}, {left} are left")]
pub(crate) struct Short {
    /// Offset of the read.
    pub at: usize,
    /// Bytes needed.
    pub needed: u64,
    /// Bytes left.
    pub left: usize,
}

/// The bytes and the place of the next read.
#[derive(Debug, Clone)]
pub(crate) struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    pub(crate) fn new(all: &'a [u8]) -> Self {
        Self { all, at: 0 }
    }

    pub(crate) fn at(&self) -> usize {
        self.at
    }

    pub(crate) fn left(&self) -> usize {
        self.all.len() - self.at
    }

    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.all[self.at..]
    }

    /// The next `count` bytes; a count read from the file may be any number.
    pub(crate) fn take(&mut self, count: u64) -> Result<&'a [u8], Short> {
        let length = usize::try_from(count).ok();
        let Some(taken) = length.and_then(|length| self.rest().get(..length)) else {
            return Err(self.short_of(count));
        };
        self.at += taken.len();
        Ok(taken)
    }

    /// The error of a read of so many bytes here.
    pub(crate) fn short_of(&self, needed: u64) -> Short {
        Short {
            at: self.at,
            needed,
            left: self.left(),
        }
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N], Short> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N as u64)?);
        Ok(array)
    }

    pub(crate) fn u16(&mut self) -> Result<u16, Short> {
        self.array().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, Short> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, Short> {
        self.array().map(u64::from_le_bytes)
    }

    /// Bytes behind their number, 32 bits wide.
    pub(crate) fn block(&mut self) -> Result<&'a [u8], Short> {
        let length = self.u32()?;
        self.take(u64::from(length))
    }

    /// Bytes behind their number, 64 bits wide.
    pub(crate) fn long_block(&mut self) -> Result<&'a [u8], Short> {
        let length = self.u64()?;
        self.take(length)
    }

    /// A length-prefixed text; bytes that are not UTF-8 are replaced, never refused.
    pub(crate) fn text(&mut self) -> Result<String, Short> {
        Ok(String::from_utf8_lossy(self.block()?).into_owned())
    }
}
