//! Rows of a table while they come in: a time and the mapped columns of each.

use std::io::Read;
use std::path::Path;

use csv::StringRecord;

use crate::error::FileError;
use crate::log::csv::cells::{number, reader_of};
use crate::log::csv::dialect::{COMMENTS, Dialect};
use crate::log::csv::moment::Moment;
use crate::log::csv::squeezed::Squeezed;
use crate::log::csv::text::{SharedEnd, Text};
use crate::log::map::{LogMap, Signals};
use crate::log::recording::{Recording, TimedDamage};
use crate::log::sample_times::{SampleTimes, TimeColumn, nth_stamp_ns};
use crate::log::table::Table;

/// The rows while they come in.
pub(super) struct Rows<'d> {
    path: &'d Path,
    dialect: &'d Dialect,
    clock: SampleTimes,
    columns: Vec<usize>,
    table: Table,
    untimed: Option<Untimed>,
    number: usize,
    /// The last line.
    line: usize,
    is_last: bool,
    end: SharedEnd,
    /// How the file breaks off.
    broken_off: Option<String>,
    warnings: Vec<String>,
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
        let header = &dialect.header;
        let columns = header.columns(path, signals)?;
        let pairs = signals.iter().zip(&columns);
        let other = pairs.filter_map(|(signal, column)| header.other_unit(signal, *column));
        Ok(Self {
            clock: SampleTimes::of(path, map, |name| header.column(path, name))?,
            warnings: other.collect(),
            path,
            dialect,
            columns,
            table: Table::of_signals("rows", signals.len()),
            untimed: None,
            number: 0,
            line: 0,
            is_last: false,
            end: SharedEnd::default(),
            broken_off: None,
        })
    }

    /// Takes in all rows up to one that breaks off.
    pub(super) fn take_all(&mut self, text: Text) -> Result<(), FileError> {
        self.end = text.end.clone();
        let reader: Box<dyn Read> = match self.dialect.separator {
            ' ' => Box::new(Squeezed::of(text.reader())),
            _ => Box::new(text.reader()),
        };
        let mut reader = reader_of(self.dialect.separator).from_reader(reader);
        let (mut record, mut next) = (StringRecord::new(), StringRecord::new());
        let mut is_there = self.next(&mut reader, &mut record)?;
        while is_there && self.broken_off.is_none() {
            is_there = self.next(&mut reader, &mut next)?;
            self.line = record.position().map_or(0, |place| place.line() as usize);
            self.is_last = !is_there;
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
        if !row.is_complete() {
            return self.break_off(&row);
        }
        let stamp_ns = self.stamp_ns(&row)?;
        self.number += 1;
        let values = row.numbers(&self.columns)?;
        match stamp_ns {
            Some(stamp_ns) => {
                self.table.push(stamp_ns, &values);
            }
            None => self.count_untimed(),
        }
        Ok(())
    }

    /// The end of a file that breaks off, or an error for a row of another width.
    fn break_off(&mut self, row: &Row) -> Result<(), FileError> {
        if !(self.is_last && self.end.borrow().is_broken_off()) {
            return Err(row.other_width());
        }
        self.broken_off = Some(format!("the file breaks off in line {}", row.line));
        Ok(())
    }

    /// The time of a row; none where its column holds none.
    fn stamp_ns(&self, row: &Row) -> Result<Option<i64>, FileError> {
        match &self.clock {
            SampleTimes::Counted(step_ns) => Ok(Some(nth_stamp_ns(self.number, *step_ns))),
            SampleTimes::Column(column) => row.stamp_ns(column, self.table.last_ns()),
        }
    }

    fn count_untimed(&mut self) {
        let none = Untimed {
            count: 0,
            first_line: self.line,
        };
        self.untimed.get_or_insert(none).count += 1;
    }

    /// The recording, with what is wrong with the end of the file.
    pub(super) fn recording(mut self, signals: &Signals) -> Recording {
        self.warnings.extend(self.cut_warning());
        Recording {
            damages: self.damages(),
            series: self.table.split(signals),
            warnings: self.warnings,
        }
    }

    fn damages(&self) -> Vec<TimedDamage> {
        let reasons = self.untimed.iter().map(Untimed::told);
        let reasons = reasons.chain(self.broken_off.clone());
        reasons
            .map(|reason| (self.table.last_ns(), reason))
            .collect()
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

impl Untimed {
    fn told(&self) -> String {
        let Self { count, first_line } = self;
        format!("{count} rows have no sample time, the first one in line {first_line}")
    }
}

/// One line of the file.
struct Row<'r> {
    record: &'r StringRecord,
    dialect: &'r Dialect,
    path: &'r Path,
    line: usize,
}

impl Row<'_> {
    /// Whether it has a cell for each name, and beyond them empty ones only.
    fn is_complete(&self) -> bool {
        let width = self.dialect.header.names.len();
        let mut beyond = self.record.iter().skip(width);
        self.record.len() >= width && beyond.all(str::is_empty)
    }

    fn other_width(&self) -> FileError {
        let found = format!("{} fields", self.record.len());
        let needed = format!("{}, as in the header", self.dialect.header.names.len());
        self.bad(found, needed)
    }

    fn cell(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    fn numbers(&self, columns: &[usize]) -> Result<Vec<Option<f64>>, FileError> {
        columns.iter().map(|column| self.number(*column)).collect()
    }

    /// The number in a column; none where the cell is empty.
    fn number(&self, column: usize) -> Result<Option<f64>, FileError> {
        match self.cell(column) {
            "" => Ok(None),
            cell => match number(cell, self.dialect.decimal) {
                Some(number) => Ok(Some(number)),
                None => Err(self.no_number(cell, "a number")),
            },
        }
    }

    /// The time in a column, a number or a moment after `last_ns`; none where that is no finite number.
    fn stamp_ns(
        &self,
        column: &TimeColumn,
        last_ns: Option<i64>,
    ) -> Result<Option<i64>, FileError> {
        let cell = self.cell(column.place);
        if cell.is_empty() {
            return Ok(None);
        }
        let decimal = self.dialect.decimal;
        if number(cell, decimal).is_some() {
            let stamp = |text: &str| column.stamp_of_text(text);
            return Ok(if decimal == ',' {
                stamp(&cell.replacen(',', ".", 1))
            } else {
                stamp(cell)
            });
        }
        let moment = Moment::of(&cell.replacen(',', ".", usize::from(decimal == ',')));
        let needed = "a time: a number, a time of day, a date with a time";
        let moment = moment.ok_or_else(|| self.no_number(cell, needed))?;
        Ok(Some(moment.stamp_ns(last_ns)))
    }

    fn no_number(&self, cell: &str, needed: &str) -> FileError {
        self.bad(format!("`{cell}`"), needed)
    }

    fn bad(&self, found: String, needed: impl Into<String>) -> FileError {
        let what = format!("line {}", self.line);
        FileError::content(self.path, what, found, needed)
    }
}
