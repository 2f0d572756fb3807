//! CSV recordings, plain or gzipped: a header row of column names, then one row of numbers per
//! sample.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::error::FileError;
use crate::log::map::{LogMap, Signal};
use crate::log::recording::{Recording, Series};
use crate::log::sample_times::SampleTimes;

/// A line may be this long: 16 MiB.
const LINE_LIMIT: u64 = 16 << 20;

/// Reads the mapped columns. A row that breaks off, and everything behind it, is reported as
/// damage.
pub(crate) fn read(path: &Path, map: &LogMap, signals: &[&Signal]) -> Result<Recording, FileError> {
    let mut lines = Lines::open(path)?;
    let header = lines.next_line()?.unwrap_or_default();
    let separator = separator(&header);
    let names: Vec<_> = header.split(separator).map(unquoted).collect();
    let clock = SampleTimes::of(path, map, |name| column(path, &names, name))?;
    let columns = signals
        .iter()
        .map(|signal| column(path, &names, &signal.source))
        .collect::<Result<Vec<_>, _>>()?;
    let mut series = Series::of("rows", (0..signals.len()).collect());
    while let Some(line) = lines.next_row()? {
        let fields: Vec<_> = line.split(separator).collect();
        if fields.len() != names.len() && lines.broke_off {
            lines.failed = Some(format!("the file breaks off in line {}", lines.number));
            break;
        }
        let row = Row {
            fields,
            needed: names.len(),
            path,
            line: lines.number,
        };
        row.check_width()?;
        let stamp_ns = clock.stamp_ns(series.rows.len(), |column| row.number(column))?;
        series.push(stamp_ns, row.numbers(&columns)?);
    }
    Ok(recording(series, lines, clock.sample_time_s(map)))
}

/// What separates the columns: the first of comma, semicolon and tab that the header has.
fn separator(header: &str) -> char {
    let separators = [',', ';', '\t'];
    let used = separators.into_iter().find(|&mark| header.contains(mark));
    used.unwrap_or(',')
}

/// The series, with what is wrong with the end of the file.
fn recording(series: Series, lines: Lines, sample_time_s: Option<f64>) -> Recording {
    let (mut damages, mut warnings) = (Vec::new(), Vec::new());
    if let Some(reason) = lines.failed {
        damages.push((series.stamps_ns.last().copied(), reason));
    } else if lines.broke_off {
        let warning =
            "the last line has no line end: if the file was cut, its last number may be too";
        warnings.push(warning.into());
    }
    Recording {
        series: vec![series],
        damages,
        warnings,
        sample_time_s,
    }
}

/// One line of the file.
struct Row<'r> {
    fields: Vec<&'r str>,
    needed: usize,
    path: &'r Path,
    line: usize,
}

impl Row<'_> {
    fn check_width(&self) -> Result<(), FileError> {
        let (found, needed) = (self.fields.len(), self.needed);
        if found == needed {
            return Ok(());
        }
        Err(self.bad(
            format!("{found} fields"),
            format!("{needed}, as in the header"),
        ))
    }

    fn numbers(&self, columns: &[usize]) -> Result<Vec<f64>, FileError> {
        columns.iter().map(|&column| self.number(column)).collect()
    }

    /// The number in a column; an empty field is a missing value.
    fn number(&self, column: usize) -> Result<f64, FileError> {
        let field = unquoted(self.fields[column]);
        if field.is_empty() {
            return Ok(f64::NAN);
        }
        field
            .parse()
            .map_err(|_| self.bad(format!("`{field}`"), "a number"))
    }

    fn bad(&self, found: String, needed: impl Into<String>) -> FileError {
        FileError::content(self.path, format!("line {}", self.line), found, needed)
    }
}

fn unquoted(field: &str) -> &str {
    field.trim().trim_matches('"').trim()
}

fn column(path: &Path, names: &[&str], name: &str) -> Result<usize, FileError> {
    let mut places = (0..names.len()).filter(|&k| names[k] == name);
    match (places.next(), places.next()) {
        (Some(place), None) => Ok(place),
        (first, _) => {
            let found = first.map_or("no such column", |_| "two of that name");
            let needed = format!("one of {}", names.join(", "));
            Err(FileError::content(
                path,
                format!("column `{name}`"),
                found,
                needed,
            ))
        }
    }
}

/// The lines of a file that may end badly.
struct Lines {
    reader: Box<dyn BufRead>,
    path: std::path::PathBuf,
    number: usize,
    /// The last line did not end.
    broke_off: bool,
    /// Reading failed behind the last line.
    failed: Option<String>,
}

impl Lines {
    fn open(path: &Path) -> Result<Self, FileError> {
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
    fn next_row(&mut self) -> Result<Option<String>, FileError> {
        loop {
            let line = self.next_line()?;
            let is_row = |line: &String| !line.is_empty() && !line.starts_with('#');
            if line.as_ref().is_none_or(is_row) {
                return Ok(line);
            }
        }
    }

    /// The next line without its end; `None` at the end of what can be read.
    fn next_line(&mut self) -> Result<Option<String>, FileError> {
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
