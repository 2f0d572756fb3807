//! Lines of a text file, plain or gzipped, that may end badly.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use crate::error::FileError;

/// A line may be this long: 16 MiB.
const LINE_LIMIT: u64 = 16 << 20;

/// How lines begin that are no rows: `#` of most tools, `%` of MATLAB and of `rostopic echo -p`.
pub(crate) const COMMENTS: [char; 2] = ['#', '%'];

/// The lines of a file that may end badly.
pub(crate) struct Lines {
    reader: Box<dyn BufRead>,
    path: PathBuf,
    /// Number of the last line.
    pub(crate) number: usize,
    /// The last line did not end.
    pub(crate) broke_off: bool,
    /// Reading failed behind the last line.
    pub(crate) failed: Option<String>,
}

impl Lines {
    pub(crate) fn open(path: &Path) -> Result<Self, FileError> {
        let failed = FileError::cannot("open", path);
        let mut file = BufReader::with_capacity(1 << 16, File::open(path).map_err(failed)?);
        let is_gzipped = file.fill_buf().map_err(failed)?.starts_with(&[0x1f, 0x8b]);
        let reader: Box<dyn BufRead> = if is_gzipped {
            Box::new(BufReader::new(MultiGzDecoder::new(file)))
        } else {
            Box::new(file)
        };
        Ok(Self {
            reader,
            path: path.into(),
            number: 0,
            broke_off: false,
            failed: None,
        })
    }

    /// The next line of numbers; empty ones and comments are left out.
    pub(crate) fn next_row(&mut self) -> Result<Option<String>, FileError> {
        loop {
            let line = self.next_line()?;
            let is_row = |line: &String| !line.is_empty() && !line.starts_with(COMMENTS);
            if line.as_ref().is_none_or(is_row) {
                return Ok(line);
            }
        }
    }

    /// The next line without its end; `None` at the end of what can be read.
    pub(crate) fn next_line(&mut self) -> Result<Option<String>, FileError> {
        if self.failed.is_some() {
            return Ok(None);
        }
        let mut line = Vec::new();
        self.number += 1;
        let mut limited = (&mut self.reader).take(LINE_LIMIT);
        if let Err(error) = limited.read_until(b'\n', &mut line) {
            let last = self.number - 1;
            self.failed = Some(format!("cannot read on behind line {last}: {error}"));
        }
        if !line.is_empty() {
            self.broke_off = !line.ends_with(b"\n");
        }
        if line.len() as u64 == LINE_LIMIT {
            let found = format!("a line of more than {LINE_LIMIT} bytes");
            let needed = "a CSV with a header and one row per sample";
            return Err(FileError::format(
                &self.path,
                found,
                needed,
                "export it as text",
            ));
        }
        // a line that broke off because reading failed may have lost digits
        if line.is_empty() || self.failed.is_some() {
            return Ok(None);
        }
        Ok(Some(
            String::from_utf8_lossy(&line)
                .trim()
                .trim_start_matches('\u{feff}')
                .into(),
        ))
    }
}
