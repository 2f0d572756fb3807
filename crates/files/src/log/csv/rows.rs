//! Rows of a table while they come in: a time and the mapped columns of each.

use std::io::Read;
use std::path::Path;

use csv::StringRecord;

use crate::budget::Budget;
use crate::error::FileError;
use crate::log::csv::cells::reader_of;
use crate::log::csv::dialect::{COMMENTS, Dialect};
use crate::log::csv::group::{Group, Taken, check_topics};
use crate::log::csv::row::Row;
use crate::log::csv::scope;
use crate::log::csv::squeezed::Squeezed;
use crate::log::csv::text::{SharedEnd, Text};
use crate::log::map::{LogMap, Signals};
use crate::log::recording::{Recording, TimedDamage};
use crate::run::header::MOST_VALUES;

/// The rows while they come in.
pub(super) struct Rows<'d> {
    path: &'d Path,
    dialect: &'d Dialect,
    groups: Vec<Group>,
    /// Cells of the last row; fewer from row to row where columns end one after the other.
    width: usize,
    is_jagged: bool,
    most_rows: usize,
    untimed: Option<Untimed>,
    number: usize,
    /// The last line.
    line: usize,
    is_last: bool,
    end: SharedEnd,
    /// How the file breaks off.
    broken_off: Option<String>,
    warnings: Vec<String>,
    /// For the rows, and the bytes of each.
    rows: Budget,
    row_bytes: u64,
}

/// Rows without a time.
struct Untimed {
    count: usize,
    first_line: usize,
}

impl<'d> Rows<'d> {
    pub(super) fn of(
        path: &'d Path,
        dialect: &'d Dialect,
        map: &LogMap,
        signals: &Signals,
    ) -> Result<Self, FileError> {
        let groups = Group::all(path, dialect, map, signals)?;
        Ok(Self {
            warnings: groups
                .iter()
                .flat_map(|group| group.doubts(dialect, signals))
                .collect(),
            is_jagged: dialect.is_scope || groups.iter().any(|group| group.is_behind_its_time),
            groups,
            path,
            dialect,
            width: dialect.header.names.len(),
            most_rows: MOST_VALUES / (1 + signals.len()),
            untimed: None,
            number: 0,
            line: 0,
            is_last: false,
            end: SharedEnd::default(),
            broken_off: None,
            rows: Budget::allowed(path),
            row_bytes: 2 * 8 * (2 + signals.len() as u64),
        })
    }

    /// Takes in all rows up to one that breaks off.
    pub(super) fn take_all(&mut self, text: Text) -> Result<(), FileError> {
        self.end = text.end.clone();
        let reader: Box<dyn Read> = match self.dialect.separator {
            ' ' if !self.dialect.is_scope => Box::new(Squeezed::of(text.reader())),
            _ => Box::new(text.reader()),
        };
        let mut reader = reader_of(self.dialect.separator).from_reader(reader);
        let (mut record, mut next) = (StringRecord::new(), StringRecord::new());
        let mut is_there = self.next(&mut reader, &mut record)?;
        while is_there && self.broken_off.is_none() {
            is_there = self.next(&mut reader, &mut next)?;
            self.line = record.position().map_or(0, |place| place.line() as usize);
            self.is_last = !is_there;
            if self.is_end(&record) {
                break;
            }
            if self.is_row(&record) && !(self.is_last && self.is_cut()) {
                self.take(&record)?;
            }
            std::mem::swap(&mut record, &mut next);
        }
        Ok(())
    }

    fn is_row(&self, record: &StringRecord) -> bool {
        self.line >= self.dialect.first_line && !record[0].starts_with(COMMENTS)
    }

    /// Whether a line says that the table ends.
    fn is_end(&self, record: &StringRecord) -> bool {
        let is_there = self.line >= self.dialect.first_line && &record[0] == scope::END;
        is_there && record.iter().skip(1).all(str::is_empty)
    }

    /// Whether the last line was cut where the file could not be read on: digits may be lost.
    fn is_cut(&mut self) -> bool {
        let end = self.end.borrow();
        let Some(error) = &end.failed else {
            return false;
        };
        let is_cut = end.is_broken_off();
        let last = self.line - usize::from(is_cut);
        self.broken_off = Some(format!("cannot read on behind line {last}: {error}"));
        is_cut
    }

    /// The next record; one that is no text is an error.
    fn next(
        &self,
        reader: &mut csv::Reader<Box<dyn Read>>,
        record: &mut StringRecord,
    ) -> Result<bool, FileError> {
        reader.read_record(record).map_err(|error| {
            let what = format!("line {}", self.line + 1);
            FileError::content(self.path, what, error.to_string(), "a row of text")
        })
    }

    /// Takes a row, unless the file breaks off in it.
    fn take(&mut self, record: &StringRecord) -> Result<(), FileError> {
        let row = Row {
            record,
            dialect: self.dialect,
            path: self.path,
            line: self.line,
        };
        if !row.has_width(self.width) && !self.ends_columns(&row) {
            return self.break_off(&row);
        }
        self.width = self.width.min(record.len());
        self.number += 1;
        self.check_count()?;
        for group in &mut self.groups {
            match group.take(&row)? {
                Taken::Untimed => untimed(&mut self.untimed, self.line),
                Taken::Yes | Taken::No => {}
            }
        }
        Ok(())
    }

    /// Refuses more rows than a recording may have.
    fn check_count(&self) -> Result<(), FileError> {
        self.rows
            .check("its rows", self.number as u64 * self.row_bytes)?;
        if self.number <= self.most_rows {
            return Ok(());
        }
        let found = format!("more than {} rows", self.most_rows);
        let needed = format!("at most {MOST_VALUES} times and values");
        Err(FileError::content(self.path, "table", found, needed))
    }

    /// Whether a shorter row is one behind the end of its last columns.
    fn ends_columns(&self, row: &Row) -> bool {
        let is_broken_off = self.is_last && self.end.borrow().is_broken_off();
        self.is_jagged && row.record.len() < self.width && !is_broken_off
    }

    /// The end of a file that breaks off, or an error for a row of another width.
    fn break_off(&mut self, row: &Row) -> Result<(), FileError> {
        if !(self.is_last && self.end.borrow().is_broken_off()) {
            return Err(row.other_width(self.width));
        }
        self.broken_off = Some(format!("the file breaks off in line {}", row.line));
        Ok(())
    }

    /// The recording, with what is wrong with the end of the file.
    pub(super) fn recording(mut self, signals: &Signals) -> Result<Recording, FileError> {
        check_topics(self.path, &self.groups, signals)?;
        self.warnings.extend(self.cut_warning());
        let last = self.groups.iter().map(|group| group.last_line).max();
        let ended = self
            .groups
            .iter()
            .filter_map(|group| group.ended(last?, signals));
        self.warnings.extend(ended);
        let damages = self.damages();
        let tables = self.groups.into_iter().map(|group| group.table);
        Ok(Recording {
            damages,
            series: tables.flat_map(|table| table.split(signals)).collect(),
            warnings: self.warnings,
        })
    }

    fn damages(&self) -> Vec<TimedDamage> {
        let last_ns = self
            .groups
            .iter()
            .filter_map(|group| group.table.last_ns())
            .max();
        let reasons = self.untimed.iter().map(Untimed::told);
        let reasons = reasons.chain(self.broken_off.clone());
        reasons.map(|reason| (last_ns, reason)).collect()
    }

    /// That the last number may be incomplete, unless the end of the file is known to be.
    fn cut_warning(&self) -> Option<String> {
        let is_broken_off = self.end.borrow().is_broken_off();
        let is_suspect = is_broken_off && self.broken_off.is_none() && self.number > 0;
        let warning =
            "the last line has no line end: if the file was cut, its last number may be too";
        is_suspect.then(|| warning.into())
    }
}

/// Counts a row without a time.
fn untimed(untimed: &mut Option<Untimed>, line: usize) {
    let none = Untimed {
        count: 0,
        first_line: line,
    };
    untimed.get_or_insert(none).count += 1;
}

impl Untimed {
    fn told(&self) -> String {
        let Self { count, first_line } = self;
        format!("{count} rows have no sample time, the first one in line {first_line}")
    }
}
