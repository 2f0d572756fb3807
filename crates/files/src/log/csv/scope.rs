//! Header of a TwinCAT Scope export: a row for each property of the channels, each with its key before the channels
//! that share a time column.
//!
//! Beckhoff, TE13xx TwinCAT 3 Scope View, export as CSV.

use std::path::Path;

use crate::error::FileError;
use crate::log::csv::cells::{Line, number, unsqueezed_lines_of};
use crate::log::csv::dialect::{CsvTable, Dialect};
use crate::log::csv::header::Header;
use crate::log::map::{LogMap, Signal};

/// Key of the row of names, which names the time columns, too; its times are in ms.
pub(super) const NAMES: &str = "Name";
/// Key of a row that only these exports have.
const SAMPLE_TIMES: &str = "SampleTime[ms]";
const UNITS: &str = "Unit";
/// Properties that scale a channel, and what leaves it as it is.
const SCALES: [(&str, f64); 4] = [
    ("ScaleFactor", 1.0),
    ("Offset", 0.0),
    ("Unit ScaleFactor", 1.0),
    ("Unit Offset", 0.0),
];
/// Last line of some.
pub(super) const END: &str = "EOF";
/// Windows counts 100 ns since 1601; these are those before 1970.
const BEFORE_1970: i64 = 116_444_736_000_000_000;

/// The dialect of an export that begins like this; `None` of another table.
pub(super) fn dialect(
    path: &Path,
    head: &str,
    stated: &CsvTable,
) -> Result<Option<Dialect>, FileError> {
    let mut rows = head.lines();
    let marks = rows.find_map(|line| line.strip_prefix(SAMPLE_TIMES)?.chars().next());
    let (None, Some(separator)) = (stated.header_line, stated.separator.or(marks)) else {
        return Ok(None);
    };
    let lines = unsqueezed_lines_of(head, separator);
    let Some(place) = lines.iter().position(|line| line.cells[0] == SAMPLE_TIMES) else {
        return Ok(None);
    };
    let names = lines[..place].iter().rfind(|line| line.cells[0] == NAMES);
    let is_row = |line: &&Line| is_number(&line.cells[0]);
    let first = lines[place..].iter().position(|line| is_row(&line));
    let (Some(names), Some(first)) = (names, first) else {
        return Ok(None);
    };
    let data = &lines[place + first..];
    let units = lines.iter().find(|line| line.cells[0] == UNITS);
    check_width(path, names, &data[0])?;
    Ok(Some(Dialect {
        separator,
        decimal: stated.decimal.unwrap_or_else(|| decimal_of(data)),
        header: Header {
            names: names.cells.clone(),
            units: units.and_then(|line| units_of(line, names.cells.len())),
            line: names.number,
        },
        first_line: data[0].number,
        is_scope: true,
        scaled: scaled(&lines[place..place + first], names.cells.len()),
    }))
}

fn is_number(cell: &str) -> bool {
    number(cell, '.').or_else(|| number(cell, ',')).is_some()
}

/// Refuses names and rows that a separator within them makes unequally wide.
fn check_width(path: &Path, names: &Line, row: &Line) -> Result<(), FileError> {
    if names.cells.len() == row.cells.len() {
        return Ok(());
    }
    let found = format!(
        "{} cells, and {} in line {}",
        names.cells.len(),
        row.cells.len(),
        row.number
    );
    let needed = "as many, by a separator that is in no name and no number: export it with tabs";
    let what = format!("names in line {}", names.number);
    Err(FileError::content(path, what, found, needed))
}

/// The decimal mark of the rows, which is not always that of the header.
fn decimal_of(rows: &[Line]) -> char {
    let mut cells = rows.iter().flat_map(|line| &line.cells);
    if cells.any(|cell| cell.contains(',')) {
        ','
    } else {
        '.'
    }
}

/// The units of the columns, without their quantities: `dV (Voltage)`, `(None)`.
fn units_of(line: &Line, width: usize) -> Option<Vec<String>> {
    let unit = |cell: &String| {
        let unit = cell.split('(').next().unwrap_or_default().trim();
        if unit == UNITS { "" } else { unit }.to_owned()
    };
    (line.cells.len() == width).then(|| line.cells.iter().map(unit).collect())
}

/// The columns that Scope scales, which the values of an export may hold or not.
fn scaled(properties: &[Line], width: usize) -> Vec<usize> {
    let is_other = |column: usize, key: &str, neutral: f64| {
        let row = properties.iter().find(|line| line.cells[0] == key);
        let cell = row.and_then(|row| row.cells.get(column));
        let value = cell.and_then(|cell| number(cell, ','));
        value.is_some_and(|value| value != neutral)
    };
    let is_scaled = |column: &usize| {
        let mut scales = SCALES.iter();
        scales.any(|(key, neutral)| is_other(*column, key, *neutral))
    };
    (0..width).filter(is_scaled).collect()
}

/// The log map, with the time columns of an export where it names none.
pub(super) fn with_times(map: &LogMap) -> LogMap {
    let times = || Signal::of(NAMES, "ms");
    LogMap {
        time: Some(map.time.clone().unwrap_or_else(times)),
        ..map.clone()
    }
}

/// The stamp in ns of a time of Windows; `None` of a time from the beginning of the export.
pub(super) fn file_time_ns(cell: &str) -> Option<i64> {
    let ticks: i64 = cell.parse().ok()?;
    // in ms it would be three million years
    let since_1970 = ticks.checked_sub(BEFORE_1970).filter(|ticks| *ticks > 0)?;
    since_1970.checked_mul(100)
}
