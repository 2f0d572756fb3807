//! Cells of the first lines of a table, and which of them are values.

use csv::{ReaderBuilder, Terminator, Trim};

use crate::log::csv::dialect::COMMENTS;
use crate::log::csv::moment::Moment;
use crate::log::csv::squeezed::squeezed;

/// A line of a table in cells.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// Its number, from 1.
    pub(super) number: usize,
    pub(super) cells: Vec<String>,
    /// Whether it begins as a comment does.
    pub(super) is_comment: bool,
}

/// Settings of a reader of rows.
pub(super) fn reader_of(separator: char) -> ReaderBuilder {
    let mut builder = ReaderBuilder::new();
    builder
        .delimiter(separator as u8)
        .has_headers(false)
        .flexible(true)
        // a carriage return before it is trimmed: with it the numbers of lines would be off
        .terminator(Terminator::Any(b'\n'))
        .trim(Trim::All);
    builder
}

/// The lines of a text that are not empty; its last one only where it ends.
pub(super) fn lines_of(head: &str, separator: char) -> Vec<Line> {
    let squeezed = (separator == ' ').then(|| squeezed(head));
    unsqueezed_lines_of(squeezed.as_deref().unwrap_or(head), separator)
}

/// The same with a cell between any two separators.
pub(super) fn unsqueezed_lines_of(text: &str, separator: char) -> Vec<Line> {
    let mut reader = reader_of(separator).from_reader(text.as_bytes());
    let mut lines = Vec::new();
    for record in reader.records().map_while(Result::ok) {
        let number = record.position().map_or(0, |place| place.line() as usize);
        let cells: Vec<String> = record.iter().map(str::to_owned).collect();
        lines.push(Line {
            number,
            is_comment: cells[0].starts_with(COMMENTS),
            cells,
        });
    }
    lines
}

/// Whether a cell is a number, a moment, or a word for no number.
pub(super) fn is_value(cell: &str, decimal: char) -> bool {
    number(cell, decimal).is_some() || Moment::of(cell).is_some()
}

/// The number in a cell.
pub(super) fn number(cell: &str, decimal: char) -> Option<f64> {
    match decimal {
        ',' if cell.contains('.') => None,
        ',' if cell.contains(',') => cell.replacen(',', ".", 1).parse().ok(),
        _ => cell.parse().ok(),
    }
}
