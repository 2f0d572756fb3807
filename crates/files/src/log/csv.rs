//! CSV recordings, plain or gzipped: a header row of column names, then one row of numbers per
//! sample.

use std::path::Path;

use crate::error::FileError;
use crate::log::lines::{COMMENTS, Lines, is_comment};
use crate::log::map::{LogMap, Signal, Signals};
use crate::log::recording::{Recording, TimedDamage};
use crate::log::sample_times::{SampleTimes, TimeColumn, nth_stamp_ns};
use crate::log::table::Table;

/// Reads the mapped columns. A row that breaks off, and everything behind it, is reported as
/// damage.
pub(crate) fn read(path: &Path, map: &LogMap, signals: &Signals) -> Result<Recording, FileError> {
    let mut lines = Lines::open(path)?;
    let mapped = mapped_names(map, signals);
    let header = header_line(&mut lines, &mapped)?;
    let header = Header::of(path, &header, &mapped);
    let mut rows = Rows::of(&header, map, signals)?;
    rows.take_all(&header, &mut lines)?;
    Ok(rows.recording(lines, signals))
}

/// The columns that the log map names.
fn mapped_names<'m>(map: &'m LogMap, signals: &[&'m Signal]) -> Vec<&'m str> {
    let mapped = signals.iter().copied().chain(&map.time);
    mapped.map(|signal| signal.source.as_str()).collect()
}

/// The header: the first line that is no comment or, where that is a row of numbers, the last comment
/// before it; or a comment that names all mapped columns.
fn header_line(lines: &mut Lines, mapped: &[&str]) -> Result<String, FileError> {
    let mut comment = None;
    while let Some(line) = lines.next_filled()? {
        if !is_comment(&line) {
            return Ok(header_of_table(lines, comment, line));
        }
        if names_all(&line, mapped) {
            return Ok(line);
        }
        comment = Some(line);
    }
    Ok(comment.unwrap_or_default())
}

/// The first line of a table or, where that is a row of numbers already, the comment above it.
fn header_of_table(lines: &mut Lines, comment: Option<String>, line: String) -> String {
    match comment {
        Some(comment) if line.split(separator(&line)).all(is_number) => {
            lines.take_back(line);
            comment
        }
        _ => line,
    }
}

fn is_number(field: &str) -> bool {
    let field = unquoted(field);
    field.is_empty() || field.parse::<f64>().is_ok()
}

fn names_all(comment: &str, mapped: &[&str]) -> bool {
    let names = names(comment, mapped);
    mapped.iter().all(|name| names.contains(name))
}

/// The names of the columns; the mark of a comment belongs to the first one only if the log map says
/// so.
fn names<'h>(header: &'h str, mapped: &[&str]) -> Vec<&'h str> {
    let as_written = unquoted_fields(header);
    if mapped.contains(&as_written[0]) {
        return as_written;
    }
    unquoted_fields(header.trim_start_matches(COMMENTS))
}

fn unquoted_fields(header: &str) -> Vec<&str> {
    header.split(separator(header)).map(unquoted).collect()
}

fn unquoted(field: &str) -> &str {
    field.trim().trim_matches('"').trim()
}

/// What separates the columns: the first of comma, semicolon and tab that the header has.
fn separator(header: &str) -> char {
    let separators = [',', ';', '\t'];
    let used = separators.into_iter().find(|&mark| header.contains(mark));
    used.unwrap_or(',')
}

/// What the header says of the rows.
struct Header<'h> {
    path: &'h Path,
    separator: char,
    names: Vec<&'h str>,
}

impl<'h> Header<'h> {
    fn of(path: &'h Path, line: &'h str, mapped: &[&str]) -> Self {
        Self {
            path,
            separator: separator(line),
            names: names(line, mapped),
        }
    }

    /// The places of the columns of signals.
    fn columns(&self, signals: &Signals) -> Result<Vec<usize>, FileError> {
        let column = |signal: &&Signal| self.column(&signal.source);
        signals.iter().map(column).collect()
    }

    /// The place of the one column of a name.
    fn column(&self, name: &str) -> Result<usize, FileError> {
        let found = match self.places(name)[..] {
            [place] => return Ok(place),
            [] => "no such column",
            _ => "two of that name",
        };
        Err(self.bad_column(name, found))
    }

    fn places(&self, name: &str) -> Vec<usize> {
        let is_it = |place: &usize| self.names[*place] == name;
        (0..self.names.len()).filter(is_it).collect()
    }

    fn bad_column(&self, name: &str, found: &str) -> FileError {
        let needed = format!("one of {}", self.names.join(", "));
        FileError::content(self.path, format!("column `{name}`"), found, needed)
    }
}

/// The rows while they come in.
struct Rows {
    clock: SampleTimes,
    columns: Vec<usize>,
    table: Table,
    untimed: Option<Untimed>,
    number: usize,
}

/// Rows without a time.
struct Untimed {
    count: usize,
    first_line: usize,
}

impl Rows {
    fn of(header: &Header, map: &LogMap, signals: &Signals) -> Result<Self, FileError> {
        Ok(Self {
            clock: SampleTimes::of(header.path, map, |name| header.column(name))?,
            columns: header.columns(signals)?,
            table: Table::of_signals("rows", signals.len()),
            untimed: None,
            number: 0,
        })
    }

    /// Takes in all rows up to one that breaks off.
    fn take_all(&mut self, header: &Header, lines: &mut Lines) -> Result<(), FileError> {
        while let Some(line) = lines.next_row()? {
            let row = Row::of(header, &line, lines.number);
            match row.is_complete() {
                true => self.take(&row)?,
                false if lines.broke_off => lines.break_off(),
                false => return Err(row.other_width()),
            }
        }
        Ok(())
    }

    fn take(&mut self, row: &Row) -> Result<(), FileError> {
        let stamp_ns = self.stamp_ns(row)?;
        self.number += 1;
        let values = row.numbers(&self.columns)?;
        match stamp_ns {
            Some(stamp_ns) => {
                self.table.push(stamp_ns, &values);
            }
            None => self.count_untimed(row.line),
        }
        Ok(())
    }

    /// The time of a row; none where its column holds none.
    fn stamp_ns(&self, row: &Row) -> Result<Option<i64>, FileError> {
        match &self.clock {
            SampleTimes::Counted(step_ns) => Ok(Some(nth_stamp_ns(self.number, *step_ns))),
            SampleTimes::Column(column) => row.stamp_ns(column),
        }
    }

    fn count_untimed(&mut self, line: usize) {
        let none = Untimed {
            count: 0,
            first_line: line,
        };
        self.untimed.get_or_insert(none).count += 1;
    }

    /// The recording, with what is wrong with the end of the file.
    fn recording(self, lines: Lines, signals: &Signals) -> Recording {
        let warnings = cut_warning(&lines).into_iter().collect();
        Recording {
            damages: self.damages(lines.failed),
            series: self.table.split(signals),
            warnings,
        }
    }

    fn damages(&self, failed: Option<String>) -> Vec<TimedDamage> {
        let reasons = self.untimed.iter().map(Untimed::told).chain(failed);
        reasons
            .map(|reason| (self.table.last_ns(), reason))
            .collect()
    }
}

impl Untimed {
    fn told(&self) -> String {
        let Self { count, first_line } = self;
        format!("{count} rows have no sample time, the first one in line {first_line}")
    }
}

/// That the last number may be incomplete, unless the end of the file is known to be.
fn cut_warning(lines: &Lines) -> Option<String> {
    let is_suspect = lines.broke_off && lines.failed.is_none();
    let warning = "the last line has no line end: if the file was cut, its last number may be too";
    is_suspect.then(|| warning.into())
}

/// One line of the file.
struct Row<'r> {
    fields: Vec<&'r str>,
    header: &'r Header<'r>,
    line: usize,
}

impl<'r> Row<'r> {
    fn of(header: &'r Header, text: &'r str, line: usize) -> Self {
        Self {
            fields: text.split(header.separator).collect(),
            header,
            line,
        }
    }

    fn is_complete(&self) -> bool {
        self.fields.len() == self.header.names.len()
    }

    fn other_width(&self) -> FileError {
        let found = format!("{} fields", self.fields.len());
        let needed = format!("{}, as in the header", self.header.names.len());
        self.bad(found, needed)
    }

    fn field(&self, column: usize) -> &str {
        unquoted(self.fields[column])
    }

    fn numbers(&self, columns: &[usize]) -> Result<Vec<Option<f64>>, FileError> {
        columns.iter().map(|column| self.number(*column)).collect()
    }

    /// The number in a column; none where the field is empty.
    fn number(&self, column: usize) -> Result<Option<f64>, FileError> {
        match self.field(column) {
            "" => Ok(None),
            field => field.parse().map(Some).map_err(|_| self.no_number(field)),
        }
    }

    /// The time in a column; none where that is no finite number.
    fn stamp_ns(&self, column: &TimeColumn) -> Result<Option<i64>, FileError> {
        self.number(column.place)?;
        Ok(column.stamp_of_text(self.field(column.place)))
    }

    fn no_number(&self, field: &str) -> FileError {
        self.bad(format!("`{field}`"), "a number")
    }

    fn bad(&self, found: String, needed: impl Into<String>) -> FileError {
        let what = format!("line {}", self.line);
        FileError::content(self.header.path, what, found, needed)
    }
}
