//! Kind of a file that was given, for messages about one that is of no use here.

use std::fs::File;
use std::io;
use std::io::Read;
use std::path::Path;

use crate::file_kind::kind_of;
use crate::plan::PlanFile;
use crate::run::read::read_run_label;

/// As many bytes as tell a result from any other JSON.
const START: u64 = 4096;

/// What a file is, as far as its first bytes say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A folder.
    Folder,
    /// A pipe, a socket or a device: what was read of it cannot be read again.
    Stream,
    /// Nothing is in it.
    Empty,
    /// A plan of `frfid design`.
    Plan,
    /// A log of `frfid run`.
    Run,
    /// An MCAP that is neither, or damaged.
    Recording,
    /// A result of `frfid estimate`.
    Result,
    /// The summary of a shaping.
    Shaping,
    /// Any other JSON.
    Json,
    /// A robot as ROS describes it.
    Urdf,
    /// A page for the browser.
    Page,
    /// Any other text: TOML, CSV.
    Text,
    /// A file of others, with what it is.
    Foreign(&'static str),
    /// Anything else.
    Binary,
}

impl FileKind {
    /// Looks into a file.
    ///
    /// # Errors
    /// The operating system's, where it cannot be read.
    pub fn of(path: &Path) -> io::Result<Self> {
        let metadata = path.metadata()?;
        if metadata.is_dir() {
            return Ok(Self::Folder);
        }
        if !metadata.is_file() {
            return Ok(Self::Stream);
        }
        let mut start = Vec::new();
        File::open(path)?.take(START).read_to_end(&mut start)?;
        if start.starts_with(mcap::MAGIC) {
            return Ok(Self::of_mcap(path));
        }
        Ok(Self::of_start(&start))
    }

    fn of_mcap(path: &Path) -> Self {
        if PlanFile::open(path).is_ok() {
            Self::Plan
        } else if read_run_label(path).is_ok() {
            Self::Run
        } else {
            Self::Recording
        }
    }

    /// By the first bytes of anything but an MCAP.
    fn of_start(start: &[u8]) -> Self {
        match (start, kind_of(start), text(start)) {
            ([], ..) => Self::Empty,
            (_, Some((foreign, _)), _) => Self::Foreign(foreign),
            (.., Some(text)) => Self::of_text(text),
            (.., None) => Self::Binary,
        }
    }

    fn of_text(text: &str) -> Self {
        let has = |word: &str| text.contains(word);
        match text
            .trim_start_matches('\u{feff}')
            .trim_start()
            .chars()
            .next()
        {
            Some('{') if has("\"frfid-result\"") => Self::Result,
            Some('{') if has("\"frfid-shape\"") => Self::Shaping,
            Some('{') => Self::Json,
            Some('<') if has("<robot") => Self::Urdf,
            Some('<') => Self::Page,
            _ => Self::Text,
        }
    }

    /// What it is, in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Folder => "a folder",
            Self::Stream => "a pipe, a socket or a device",
            Self::Empty => "an empty file",
            Self::Plan => "a plan (MCAP)",
            Self::Run => "a log of frfid run (MCAP)",
            Self::Recording => "an MCAP that is no plan of frfid, or damaged",
            Self::Result => "a result (JSON)",
            Self::Shaping => "the summary of a shaping (JSON)",
            Self::Json => "a JSON file that is no result",
            Self::Urdf => "a robot in URDF (XML)",
            Self::Page => "a page (HTML or XML)",
            Self::Text => "a text file",
            Self::Foreign(name) => name,
            Self::Binary => "a binary file",
        }
    }
}

/// The bytes as text, if they are UTF-8; a character that is cut at the end is left out.
fn text(start: &[u8]) -> Option<&str> {
    let text = match std::str::from_utf8(start) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => {
            std::str::from_utf8(&start[..error.valid_up_to()]).ok()?
        }
        Err(_) => return None,
    };
    (!text.contains('\0')).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_their_first_bytes() {
        for (start, kind) in [
            (&b""[..], FileKind::Empty),
            (b" {\"format\":\"frfid-result\"", FileKind::Result),
            (b"{\"format\": \"frfid-shape\"", FileKind::Shaping),
            (b"{}", FileKind::Json),
            (b"<?xml?>\n<robot name=\"a\">", FileKind::Urdf),
            (b"<!DOCTYPE html>", FileKind::Page),
            (b"seed = 1\n", FileKind::Text),
            (b"cut \xc3", FileKind::Text),
            (b"\xff\xfe\x00", FileKind::Binary),
            (b"\x1f\x8b", FileKind::Foreign("a gzip-compressed file")),
        ] {
            assert_eq!(FileKind::of_start(start), kind);
        }
        assert_eq!(FileKind::of(Path::new(".")).ok(), Some(FileKind::Folder));
        assert!(FileKind::of(Path::new("nowhere")).is_err());
    }
}
