//! Writer of CDR messages (see `cdr_read`), little endian.

/// Writes one message, little endian.
#[derive(Debug, Clone)]
pub(crate) struct CdrWriter {
    bytes: Vec<u8>,
}

const HEADER: [u8; 4] = [0, 1, 0, 0];

impl Default for CdrWriter {
    fn default() -> Self {
        Self {
            bytes: HEADER.to_vec(),
        }
    }
}

impl CdrWriter {
    /// The message, header included.
    #[must_use]
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Forgets the message but keeps its memory for the next one.
    pub(crate) fn clear(&mut self) {
        self.bytes.truncate(HEADER.len());
    }

    fn align(&mut self, size: usize) {
        let padding = (self.bytes.len() - HEADER.len()).wrapping_neg() & (size - 1);
        self.bytes.extend(std::iter::repeat_n(0, padding));
    }

    /// A signed 32-bit integer.
    pub(crate) fn i32(&mut self, value: i32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// An unsigned 32-bit integer, also every count.
    pub(crate) fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    /// A text: its length with the closing NUL, its bytes, the NUL. A message holds at most 4 GiB.
    pub(crate) fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
    }

    /// A sequence of texts.
    pub(crate) fn texts(&mut self, texts: &[String]) {
        self.u32(texts.len() as u32);
        for text in texts {
            self.text(text);
        }
    }

    /// A sequence of 64-bit numbers; no padding follows an empty one.
    pub(crate) fn f64s(&mut self, values: &[f64]) {
        self.u32(values.len() as u32);
        if !values.is_empty() {
            self.align(8);
        }
        for value in values {
            self.bytes.extend(value.to_le_bytes());
        }
    }
}
