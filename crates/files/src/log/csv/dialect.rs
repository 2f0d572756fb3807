//! Dialect of a table: separator, decimal mark, header, units, found in its first rows or stated.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::FileError;
use crate::log::csv::cells::{Line, is_value, lines_of};
use crate::log::csv::header::{Header, header_above};
use crate::log::csv::scope;

/// How lines begin that are no rows: `#` of most tools, `%` of MATLAB and of `rostopic echo -p`.
pub(super) const COMMENTS: [char; 2] = ['#', '%'];
/// What separates columns, in the order in which it is tried; a blank stands for any number of them.
const SEPARATORS: [char; 5] = [',', ';', '\t', '|', ' '];
const DECIMALS: [char; 2] = ['.', ','];
/// Rows that are looked at, the last ones of the head.
const ROWS: usize = 40;
/// Share of the cells that must be values, and of the rows that must be equally wide.
const MOST: f64 = 0.5;

/// How a CSV is written, where it is not to be guessed.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CsvTable {
    /// What separates columns: `","`, `";"`, `"\t"`, `"|"` or `" "`.
    #[serde(default)]
    pub separator: Option<char>,
    /// The decimal mark, `"."` or `","`.
    #[serde(default)]
    pub decimal: Option<char>,
    /// The line with the names of the columns, from 1; 0 where there is none.
    #[serde(default)]
    pub header_line: Option<usize>,
    /// The encoding: `"utf-8"`, `"utf-16le"`, `"windows-1252"`, ...
    #[serde(default)]
    pub encoding: Option<String>,
}

/// How a table is written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dialect {
    pub(super) separator: char,
    pub(super) decimal: char,
    pub(super) header: Header,
    /// The first line with values.
    pub(super) first_line: usize,
    /// Whether the header is that of a TwinCAT Scope export.
    pub(super) is_scope: bool,
    /// Columns that TwinCAT Scope scales.
    pub(super) scaled: Vec<usize>,
}

/// What a separator and a decimal mark make of a text.
struct Trial {
    separator: char,
    decimal: char,
    lines: Vec<Line>,
    width: usize,
    /// Share of the cells that are values, times that of the rows that are equally wide.
    score: f64,
}

impl Dialect {
    /// The dialect of a text of which `head` is the beginning, `mapped` the names that the log map has.
    ///
    /// # Errors
    /// [`FileError::Content`] for a header line that is not there.
    pub(super) fn of(
        path: &Path,
        head: &str,
        stated: &CsvTable,
        mapped: &[&str],
    ) -> Result<Self, FileError> {
        if let Some(scope) = scope::dialect(path, head, stated)? {
            return Ok(scope);
        }
        let trial = best(head, stated);
        let first = trial.first_row();
        let first_line = first.map_or(usize::MAX, |place| trial.lines[place].number);
        let above = &trial.lines[..first.unwrap_or(trial.lines.len())];
        let header = match stated.header_line {
            Some(0) => Header::numbered(trial.width),
            Some(line) => trial.header_in(line).ok_or_else(|| no_line(path, line))?,
            None => header_above(above, trial.width, mapped),
        };
        Ok(Self {
            separator: trial.separator,
            decimal: trial.decimal,
            first_line: first_line.max(header.line + 1),
            header,
            is_scope: false,
            scaled: Vec::new(),
        })
    }

    /// What is not as in a plain CSV, in words; `None` for one with commas, points and its names first.
    pub(super) fn told(&self, encoding: Option<&str>) -> Option<String> {
        let separator = match self.separator {
            '\t' => "tab",
            ' ' => "blanks",
            ';' => "semicolon",
            ':' => "colon",
            _ => "|",
        };
        let header = &self.header;
        let header_words = match header.line {
            0 => "no header: columns by number, 1 to ".to_owned() + &header.names.len().to_string(),
            line => format!("header in line {line}"),
        };
        let units = header.units.iter().flatten().map(String::as_str);
        let units: Vec<&str> = units.filter(|unit| !unit.is_empty()).collect();
        let units_words = (!units.is_empty()).then(|| format!("units: {}", units.join(", ")));
        let parts = [
            encoding.map(str::to_owned),
            self.is_scope.then(|| "the header of TwinCAT Scope".into()),
            (self.separator != ',').then(|| format!("separator {separator}")),
            (self.decimal != '.').then(|| "decimal comma".into()),
            (header.line != 1).then_some(header_words),
            units_words,
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("read as a table with {}", parts.join("; ")))
    }
}

/// The separator and decimal mark that make most of the text values, in as many columns as can be.
fn best(head: &str, stated: &CsvTable) -> Trial {
    let named = head
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("sep="));
    let stated_separator = stated
        .separator
        .or(named.and_then(|mark| mark.chars().next()));
    let separators = stated_separator.map_or(SEPARATORS.to_vec(), |mark| vec![mark]);
    let decimals = stated.decimal.map_or(DECIMALS.to_vec(), |mark| vec![mark]);
    let pairs = separators
        .iter()
        .flat_map(|s| decimals.iter().map(move |d| (*s, *d)));
    let trials = pairs.map(|(separator, decimal)| Trial::of(head, separator, decimal));
    let better = |a: Trial, b: Trial| if b.is_better_than(&a) { b } else { a };
    let best = trials.reduce(better);
    best.unwrap_or_else(|| Trial::of(head, ',', '.'))
}

impl Trial {
    fn of(head: &str, separator: char, decimal: char) -> Self {
        let lines = lines_of(head, separator);
        let rows = &lines[lines.len().saturating_sub(ROWS)..];
        let rows: Vec<&Line> = rows.iter().filter(|line| !line.is_comment).collect();
        let width = most_frequent(rows.iter().map(|line| line.cells.len()));
        let wide: Vec<&&Line> = rows
            .iter()
            .filter(|line| line.cells.len() == width)
            .collect();
        let cells = || wide.iter().flat_map(|line| &line.cells);
        let filled = || cells().filter(|cell| !cell.is_empty());
        let values = filled().filter(|cell| is_value(cell, decimal)).count() as f64;
        let alike = wide.len() as f64 / rows.len().max(1) as f64;
        Self {
            score: alike * values / (filled().count() as f64).max(1.0),
            separator,
            decimal,
            width,
            lines,
        }
    }

    /// Whether it makes more sense: more columns of values, or more values in as many.
    fn is_better_than(&self, other: &Self) -> bool {
        let sense = |trial: &Self| {
            if trial.score >= MOST {
                trial.width as f64 * trial.score
            } else {
                trial.score
            }
        };
        sense(self) > sense(other) + 1e-9
    }

    /// The first row of values: as wide as the others, and with values where these have them.
    fn first_row(&self) -> Option<usize> {
        let is_row = |line: &Line| {
            let filled = line.cells.iter().filter(|cell| !cell.is_empty());
            let n_filled = filled.clone().count();
            !line.is_comment
                && line.cells.len() == self.width
                && n_filled > 0
                && 2 * filled.filter(|cell| is_value(cell, self.decimal)).count() > n_filled
        };
        self.lines.iter().position(is_row)
    }

    /// The names in a line.
    fn header_in(&self, number: usize) -> Option<Header> {
        let line = self.lines.iter().find(|line| line.number == number)?;
        Some(Header::of(line, &[]))
    }
}

/// The number that comes most often; the larger one of two.
fn most_frequent(numbers: impl Iterator<Item = usize> + Clone) -> usize {
    let count = |number: usize| numbers.clone().filter(|other| *other == number).count();
    numbers
        .clone()
        .max_by_key(|&number| (count(number), number))
        .unwrap_or(0)
}

fn no_line(path: &Path, line: usize) -> FileError {
    let what = "header_line of the log map";
    FileError::content(
        path,
        what,
        line.to_string(),
        "a line with names, before the rows",
    )
}
