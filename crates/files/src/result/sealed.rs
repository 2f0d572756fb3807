//! Seal of a JSON object: its last key is the checksum of all that stands before it.
//!
//! `{..., "sha256": "..."}`, without spaces: the fingerprint of every byte before the comma. Files of before have none.

use std::io::{self, Write};

use sha2::{Digest, Sha256};

use crate::sha256::{hex, sha256_hex};

/// The seal before its fingerprint.
const KEY: &str = ",\"sha256\":\"";
/// Behind it.
const END: &str = "\"}";
/// Length of a seal.
const LENGTH: usize = KEY.len() + 64 + END.len();

/// A writer of one JSON object, which is sealed when it is done.
pub(crate) struct Sealed<W> {
    file: W,
    sum: Sha256,
    /// The last byte so far: the seal stands before the brace that closes.
    last: Option<u8>,
}

impl<W: Write> Sealed<W> {
    pub(crate) fn new(file: W) -> Self {
        let (sum, last) = (Sha256::new(), None);
        Self { file, sum, last }
    }

    /// Seals what was written.
    pub(crate) fn seal(mut self) -> io::Result<()> {
        debug_assert_eq!(self.last, Some(b'}'), "a JSON object was written");
        let seal = format!("{KEY}{}{END}", hex(&self.sum.finalize()));
        self.file.write_all(seal.as_bytes())
    }

    fn pass(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.update(bytes);
        self.file.write_all(bytes)
    }
}

impl<W: Write> Write for Sealed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some((last, before)) = bytes.split_last() {
            if let Some(held) = self.last.replace(*last) {
                self.pass(&[held])?;
            }
            self.pass(before)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Whether the bytes of a file end with a seal, and if so, whether it is theirs.
pub(crate) fn seal(bytes: &[u8]) -> Option<bool> {
    let (content, seal) = bytes.split_at_checked(bytes.len().checked_sub(LENGTH)?)?;
    let sum = seal
        .strip_prefix(KEY.as_bytes())?
        .strip_suffix(END.as_bytes())?;
    Some(sum == sha256_hex(content).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seal_is_that_of_its_content_however_it_was_written() {
        let mut bytes = Vec::new();
        let mut sealed = Sealed::new(&mut bytes);
        for piece in ["{", "", "\"a\":1", "}"] {
            sealed.write_all(piece.as_bytes()).expect("in memory");
        }
        sealed.seal().expect("in memory");
        let sum = sha256_hex(b"{\"a\":1");
        let text = format!("{{\"a\":1,\"sha256\":\"{sum}\"}}");
        assert_eq!(bytes, text.as_bytes());
        assert_eq!(seal(&bytes), Some(true));
        bytes[5] = b'2';
        assert_eq!(seal(&bytes), Some(false));
        assert_eq!(seal(b"{\"a\":1}"), None);
    }
}
