//! Lines of a text file, plain or gzipped, that may end badly.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use crate::error::FileError;

/// A line may be this long: 16 MiB.
const LINE_LIMIT: u64 = 16 << 20;
/// First bytes of a gzipped file.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// How lines begin that are no rows: `#` of most tools, `%` of MATLAB and of `rostopic echo -p`.
pub(crate) const COMMENTS: [char; 2] = ['#', '%'];

/// The lines of a file that may end badly.
pub(crate) struct Lines {
    reader: Box<dyn BufRead>,
    path: PathBuf,
    /// A row that was taken back.
    returned: Option<String>,
    /// Number of the last line.
    pub(crate) number: usize,
    /// The last line did not end.
    pub(crate) broke_off: bool,
    /// Reading failed behind the last line.
    pub(crate) failed: Option<String>,
}

impl Lines {
    pub(crate) fn open(path: &Path) -> Result<Self, FileError> {
        Ok(Self {
            reader: unpacked(path).map_err(FileError::cannot("open", path))?,
            path: path.into(),
            returned: None,
            number: 0,
            broke_off: false,
            failed: None,
        })
    }

    /// The next line of numbers; empty ones and comments are left out.
    pub(crate) fn next_row(&mut self) -> Result<Option<String>, FileError> {
        loop {
            let line = self.next_filled()?;
            if line.as_deref().is_none_or(|line| !is_comment(line)) {
                return Ok(line);
            }
        }
    }

    /// Takes the last line back: it will be the next row.
    pub(crate) fn take_back(&mut self, row: String) {
        self.returned = Some(row);
    }

    /// Ends here, in the midst of a line.
    pub(crate) fn break_off(&mut self) {
        self.failed = Some(format!("the file breaks off in line {}", self.number));
    }

    /// The next line that is not empty.
    pub(crate) fn next_filled(&mut self) -> Result<Option<String>, FileError> {
        loop {
            let line = self.next_line()?;
            if line.as_deref() != Some("") {
                return Ok(line);
            }
        }
    }

    /// The next line without its end; `None` at the end of what can be read.
    fn next_line(&mut self) -> Result<Option<String>, FileError> {
        if self.returned.is_some() || self.failed.is_some() {
            return Ok(self.returned.take());
        }
        let line = self.read_line();
        self.count(&line);
        if line.len() as u64 == LINE_LIMIT {
            return Err(self.too_long());
        }
        // a line that broke off because reading failed may have lost digits
        let is_whole = !line.is_empty() && self.failed.is_none();
        Ok(is_whole.then(|| text_of(&line)))
    }

    /// The bytes of the next line with its end, as far as they can be read.
    fn read_line(&mut self) -> Vec<u8> {
        let mut line = Vec::new();
        if let Err(error) = (&mut self.reader)
            .take(LINE_LIMIT)
            .read_until(b'\n', &mut line)
        {
            self.fail(&error);
        }
        line
    }

    fn fail(&mut self, error: &io::Error) {
        let last = self.number;
        self.failed = Some(format!("cannot read on behind line {last}: {error}"));
    }

    fn count(&mut self, line: &[u8]) {
        self.number += 1;
        if !line.is_empty() {
            self.broke_off = !line.ends_with(b"\n");
        }
    }

    fn too_long(&self) -> FileError {
        let found = format!("a line of more than {LINE_LIMIT} bytes");
        let needed = "a CSV with a header and one row per sample";
        FileError::format(&self.path, found, needed, "export it as text")
    }
}

pub(crate) fn is_comment(line: &str) -> bool {
    line.starts_with(COMMENTS)
}

/// Reader of a file that may be gzipped.
fn unpacked(path: &Path) -> io::Result<Box<dyn BufRead>> {
    let mut file = BufReader::with_capacity(1 << 16, File::open(path)?);
    if !file.fill_buf()?.starts_with(&GZIP) {
        return Ok(Box::new(file));
    }
    Ok(Box::new(BufReader::new(MultiGzDecoder::new(file))))
}

/// A line without its end and the mark of a byte order.
fn text_of(line: &[u8]) -> String {
    let text = String::from_utf8_lossy(line);
    text.trim().trim_start_matches('\u{feff}').into()
}
