//! Blanks that separate columns, squeezed into one.

use std::io::{self, BufRead, BufReader, Read};

use crate::log::csv::text::LINE_LIMIT;

/// A text with one blank in place of several, none at the ends of lines.
pub(super) fn squeezed(text: &str) -> String {
    let mut squeezed = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        squeezed += &words.join(" ");
        squeezed += if line.ends_with('\n') { "\n" } else { "" };
    }
    squeezed
}

/// A text with one blank in place of several.
pub(super) struct Squeezed<R> {
    text: BufReader<R>,
    line: Vec<u8>,
    taken: usize,
}

impl<R: Read> Squeezed<R> {
    pub(super) fn of(text: R) -> Self {
        Self {
            text: BufReader::new(text),
            line: Vec::new(),
            taken: 0,
        }
    }
}

impl<R: Read> Read for Squeezed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.taken == self.line.len() {
            let mut line = Vec::new();
            (&mut self.text)
                .take(LINE_LIMIT)
                .read_until(b'\n', &mut line)?;
            self.line = squeezed(&String::from_utf8_lossy(&line)).into_bytes();
            self.taken = 0;
        }
        let n = buffer.len().min(self.line.len() - self.taken);
        buffer[..n].copy_from_slice(&self.line[self.taken..self.taken + n]);
        self.taken += n;
        Ok(n)
    }
}
