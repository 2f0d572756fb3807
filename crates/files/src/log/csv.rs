//! CSV recordings, plain or gzipped: a header row of column names, then one row of numbers per
//! sample.

use std::path::Path;

use crate::error::FileError;
use crate::log::lines::{COMMENTS, Lines};
use crate::log::map::{LogMap, Signal};
use crate::log::recording::Recording;
use crate::log::sample_times::SampleTimes;
use crate::log::table::Table;

/// Reads the mapped columns. A row that breaks off, and everything behind it, is reported as
/// damage.
pub(crate) fn read(path: &Path, map: &LogMap, signals: &[&Signal]) -> Result<Recording, FileError> {
    let mut lines = Lines::open(path)?;
    let mapped = signals.iter().copied().chain(&map.time);
    let mapped: Vec<&str> = mapped.map(|signal| signal.source.as_str()).collect();
    let (header, mut first_row) = header(&mut lines, &mapped)?;
    let separator = separator(&header);
    let names = names(&header, &mapped);
    let clock = SampleTimes::of(path, map, |name| column(path, &names, name))?;
    let mut rows = Rows {
        clock,
        columns: columns(path, &names, signals)?,
        table: Table::of("rows"),
        untimed: None,
        number: 0,
    };
    (0..signals.len()).for_each(|signal| rows.table.add_signal(signal));
    while let Some(line) = first_row
        .take()
        .map_or_else(|| lines.next_row(), |row| Ok(Some(row)))?
    {
        let fields: Vec<_> = line.split(separator).collect();
        if fields.len() != names.len() && lines.broke_off {
            lines.failed = Some(format!("the file breaks off in line {}", lines.number));
            break;
        }
        rows.take(&Row {
            fields,
            needed: names.len(),
            path,
            line: lines.number,
        })?;
    }
    Ok(rows.recording(lines, signals))
}

/// The header, and the first row if that was read to find it: the first line that is no comment or,
/// where that is a row of numbers, the last comment before it; or a comment that names all mapped
/// columns.
fn header(lines: &mut Lines, mapped: &[&str]) -> Result<(String, Option<String>), FileError> {
    let mut comment = None;
    while let Some(line) = lines.next_line()? {
        if line.is_empty() {
            continue;
        }
        if !line.starts_with(COMMENTS) {
            let is_row = line.split(separator(&line)).all(is_number);
            return Ok(match comment {
                Some(comment) if is_row => (comment, Some(line)),
                _ => (line, None),
            });
        }
        let names = names(&line, mapped);
        if mapped.iter().all(|name| names.contains(name)) {
            return Ok((line, None));
        }
        comment = Some(line);
    }
    Ok((comment.unwrap_or_default(), None))
}

fn is_number(field: &str) -> bool {
    let field = unquoted(field);
    field.is_empty() || field.parse::<f64>().is_ok()
}

/// The names of the columns; the mark of a comment belongs to the first one only if the log map says
/// so.
fn names<'h>(header: &'h str, mapped: &[&str]) -> Vec<&'h str> {
    let separator = separator(header);
    let named = |header: &'h str| header.split(separator).map(unquoted).collect::<Vec<_>>();
    let as_written = named(header);
    if mapped.contains(&as_written[0]) {
        return as_written;
    }
    named(header.trim_start_matches(COMMENTS))
}

fn columns(path: &Path, names: &[&str], signals: &[&Signal]) -> Result<Vec<usize>, FileError> {
    let column = |signal: &&Signal| column(path, names, &signal.source);
    signals.iter().map(column).collect()
}

/// What separates the columns: the first of comma, semicolon and tab that the header has.
fn separator(header: &str) -> char {
    let separators = [',', ';', '\t'];
    let used = separators.into_iter().find(|&mark| header.contains(mark));
    used.unwrap_or(',')
}

/// The rows while they come in.
struct Rows {
    clock: SampleTimes,
    columns: Vec<usize>,
    table: Table,
    /// Rows without a time, and the line of the first.
    untimed: Option<(usize, usize)>,
    number: usize,
}

impl Rows {
    fn take(&mut self, row: &Row) -> Result<(), FileError> {
        row.check_width()?;
        let stamp_ns = match &self.clock {
            SampleTimes::Counted(step_ns) => Some((self.number as f64 * step_ns).round() as i64),
            SampleTimes::Column(column) => {
                let text = row.field(column.place);
                row.number(column.place)?;
                column.stamp_of_text(text)
            }
        };
        self.number += 1;
        let values = self.columns.iter().map(|&column| row.number(column));
        let values = values.collect::<Result<Vec<_>, _>>()?;
        match stamp_ns {
            Some(stamp_ns) => {
                self.table.push(stamp_ns, &values);
            }
            None => self.untimed.get_or_insert((0, row.line)).0 += 1,
        }
        Ok(())
    }

    /// The recording, with what is wrong with the end of the file.
    fn recording(self, lines: Lines, signals: &[&Signal]) -> Recording {
        let last_ns = self.table.last_ns();
        let untimed = self.untimed.map(|(count, line)| {
            format!("{count} rows have no sample time, the first one in line {line}")
        });
        let mut warnings = Vec::new();
        if lines.broke_off && lines.failed.is_none() {
            let warning =
                "the last line has no line end: if the file was cut, its last number may be too";
            warnings.push(warning.into());
        }
        let reasons = untimed.into_iter().chain(lines.failed);
        Recording {
            series: self.table.split(signals),
            damages: reasons.map(|reason| (last_ns, reason)).collect(),
            warnings,
        }
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

    fn field(&self, column: usize) -> &str {
        unquoted(self.fields[column])
    }

    /// The number in a column; none where the field is empty.
    fn number(&self, column: usize) -> Result<Option<f64>, FileError> {
        let field = self.field(column);
        if field.is_empty() {
            return Ok(None);
        }
        let number = field.parse().map(Some);
        number.map_err(|_| self.bad(format!("`{field}`"), "a number"))
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
