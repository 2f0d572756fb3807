//! Text of a file, plain or gzipped, in any usual encoding, as UTF-8 that may end badly.

use std::cell::RefCell;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Chain, Cursor, Read};
use std::path::Path;
use std::rc::Rc;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
use encoding_rs_io::{DecodeReaderBytes, DecodeReaderBytesBuilder};
use flate2::read::MultiGzDecoder;

use crate::budget::Budget;
use crate::error::FileError;

/// First bytes of a gzipped file.
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// Bytes that are read at once.
const BUFFER: usize = 1 << 16;
/// How much of a text is looked at before it is read: some hundred rows, or the header of some hundred channels.
const HEAD: u64 = 256 << 10;

/// A line may be this long: 16 MiB.
pub(super) const LINE_LIMIT: u64 = 16 << 20;

/// The text of a file, from its beginning.
pub(super) struct Text {
    /// What is looked at before the rest is read.
    pub(super) head: String,
    /// Whether the head is the whole text.
    pub(super) is_whole: bool,
    /// The encoding, if it is not UTF-8.
    pub(super) encoding: Option<&'static str>,
    /// How the text ends.
    pub(super) end: SharedEnd,
    rest: Decoded,
}

type Decoded = DecodeReaderBytes<Watched, Vec<u8>>;

/// How a text ended, as far as it was read.
#[derive(Debug, Default)]
pub(super) struct End {
    /// The last byte.
    last: u8,
    /// Why it could not be read on.
    pub(super) failed: Option<String>,
}

pub(super) type SharedEnd = Rc<RefCell<End>>;

impl Text {
    /// Opens a file; `stated` is the encoding that the log map names.
    pub(super) fn open(path: &Path, stated: Option<&str>) -> Result<Self, FileError> {
        let cannot = FileError::cannot("open", path);
        let mut file = unpacked(path).map_err(cannot)?;
        let start = file.fill_buf().unwrap_or_default(); // what fails will fail again, and be told
        let encoding = match stated {
            Some(name) => by_name(path, name)?,
            None => guessed(start),
        };
        let end = SharedEnd::default();
        let watched = Watched {
            file,
            end: end.clone(),
            line: 0,
        };
        let mut builder = DecodeReaderBytesBuilder::new();
        let mut rest = builder.encoding(Some(encoding)).build(watched);
        let mut head = Vec::new();
        (&mut rest)
            .take(HEAD)
            .read_to_end(&mut head)
            .map_err(FileError::cannot("read", path))?;
        Ok(Self {
            is_whole: (head.len() as u64) < HEAD,
            head: String::from_utf8_lossy(&head).into_owned(),
            encoding: (encoding != UTF_8).then(|| encoding.name()),
            end,
            rest,
        })
    }

    /// The text from its beginning.
    pub(super) fn reader(self) -> Chain<Cursor<Vec<u8>>, impl Read> {
        Cursor::new(self.head.into_bytes()).chain(self.rest)
    }
}

impl End {
    /// Whether the last line has no end.
    pub(super) fn is_broken_off(&self) -> bool {
        !matches!(self.last, b'\n' | b'\r' | 0)
    }
}

/// A reader that tells how it ended, and ends where it cannot read on.
struct Watched {
    file: Box<dyn BufRead>,
    end: SharedEnd,
    /// Bytes of the last line so far.
    line: u64,
}

impl Watched {
    /// Whether the last line, with these bytes, is longer than any of a table.
    fn is_too_long(&mut self, bytes: &[u8]) -> bool {
        self.line = match bytes.iter().rposition(|byte| *byte == b'\n') {
            Some(end) => (bytes.len() - end) as u64,
            None => self.line + bytes.len() as u64,
        };
        self.line > LINE_LIMIT
    }
}

impl Read for Watched {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer);
        let is_too_long = matches!(read, Ok(n) if self.is_too_long(&buffer[..n]));
        let mut end = self.end.borrow_mut();
        match read {
            Ok(_) if is_too_long => {
                end.failed = Some(format!("a line is longer than {LINE_LIMIT} bytes"));
                Ok(0)
            }
            Ok(n) => {
                let last = buffer[..n].iter().rev().find(|byte| **byte != 0);
                end.last = last.copied().unwrap_or(end.last);
                Ok(n)
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Err(error),
            Err(error) => {
                end.failed = Some(error.to_string());
                Ok(0)
            }
        }
    }
}

/// Refuses a gzipped text by the length that it unpacks to, before a row of it is read.
///
/// # Errors
/// As [`Budget::check`]; what cannot be unpacked is told where it is read.
pub(super) fn check_length(path: &Path) -> Result<(), FileError> {
    let budget = Budget::of_file(path)?;
    let file = buffered(path).map_err(FileError::cannot("open", path))?;
    let Ok(mut text) = gzipped(file) else {
        return Ok(()); // as long as it is
    };
    let mut n_bytes = 0;
    while let Ok(block) = text.fill_buf()
        && !block.is_empty()
    {
        let length = block.len();
        text.consume(length);
        n_bytes += length as u64;
        budget.check("its text", n_bytes)?;
    }
    Ok(())
}

/// Reader of a file that may be gzipped.
fn unpacked(path: &Path) -> io::Result<Box<dyn BufRead>> {
    Ok(match gzipped(buffered(path)?) {
        Ok(text) => Box::new(text),
        Err(plain) => Box::new(plain),
    })
}

/// The beginning of a file, looked at once so that what cannot be read is told.
fn buffered(path: &Path) -> io::Result<BufReader<File>> {
    let mut file = BufReader::with_capacity(BUFFER, File::open(path)?);
    file.fill_buf()?;
    Ok(file)
}

/// The text of a gzipped file; another comes back as it is.
fn gzipped(
    file: BufReader<File>,
) -> Result<BufReader<MultiGzDecoder<BufReader<File>>>, BufReader<File>> {
    if file.buffer().starts_with(&GZIP) {
        return Ok(BufReader::with_capacity(BUFFER, MultiGzDecoder::new(file)));
    }
    Err(file)
}

fn by_name(path: &Path, name: &str) -> Result<&'static Encoding, FileError> {
    Encoding::for_label(name.as_bytes()).ok_or_else(|| {
        let needed = "utf-8, utf-16le, windows-1252 or another name of the WHATWG encodings";
        FileError::content(path, "encoding of the log map", format!("`{name}`"), needed)
    })
}

/// The encoding that first bytes show; a byte order mark counts more and is looked for later.
fn guessed(start: &[u8]) -> &'static Encoding {
    let is_zero = |offset: usize| {
        let bytes = start.iter().skip(offset).step_by(2);
        2 * bytes.clone().filter(|byte| **byte == 0).count() > bytes.count().max(1)
    };
    match std::str::from_utf8(start) {
        _ if is_zero(1) => UTF_16LE,
        _ if is_zero(0) => UTF_16BE,
        // a character that the end cuts apart is no error
        Err(error) if error.error_len().is_some() => WINDOWS_1252,
        _ => UTF_8,
    }
}
