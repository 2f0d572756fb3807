//! Row of a table: its cells as numbers and times.

use std::path::Path;

use csv::StringRecord;

use crate::error::FileError;
use crate::log::csv::cells::number;
use crate::log::csv::dialect::Dialect;
use crate::log::csv::moment::Moment;
use crate::log::csv::scope;
use crate::log::sample_times::TimeColumn;

/// One line of the file.
pub(super) struct Row<'r> {
    pub(super) record: &'r StringRecord,
    pub(super) dialect: &'r Dialect,
    pub(super) path: &'r Path,
    pub(super) line: usize,
}

impl Row<'_> {
    /// Whether it has so many cells, and beyond them empty ones only.
    pub(super) fn has_width(&self, width: usize) -> bool {
        let mut beyond = self.record.iter().skip(width);
        self.record.len() >= width && beyond.all(str::is_empty)
    }

    /// That it is as wide as none before it.
    pub(super) fn other_width(&self, width: usize) -> FileError {
        let found = format!("{} fields", self.record.len());
        let as_where = if width == self.dialect.header.names.len() {
            "as in the header"
        } else {
            "as in the row before: columns that end stay at their end"
        };
        let needed = format!("{width}, {as_where}");
        self.bad(found, needed)
    }

    /// The text in a column; empty where the row has ended.
    pub(super) fn cell(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    /// The numbers in columns; none where a cell is empty.
    pub(super) fn numbers(&self, columns: &[usize]) -> Result<Vec<Option<f64>>, FileError> {
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
    pub(super) fn stamp_ns(
        &self,
        column: &TimeColumn,
        last_ns: Option<i64>,
    ) -> Result<Option<i64>, FileError> {
        let cell = self.cell(column.place);
        if cell.is_empty() {
            return Ok(None);
        }
        if let Some(stamp_ns) = self.file_time_ns(cell) {
            return Ok(Some(stamp_ns));
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

    fn file_time_ns(&self, cell: &str) -> Option<i64> {
        let is_scope = self.dialect.is_scope;
        is_scope.then(|| scope::file_time_ns(cell)).flatten()
    }

    fn no_number(&self, cell: &str, needed: &str) -> FileError {
        self.bad(format!("`{cell}`"), needed)
    }

    fn bad(&self, found: String, needed: impl Into<String>) -> FileError {
        let what = format!("line {}", self.line);
        FileError::content(self.path, what, found, needed)
    }
}
