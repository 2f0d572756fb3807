//! Header of a table: the names of its columns, and their units where a row has them.

use std::collections::HashSet;
use std::path::Path;

use crate::error::FileError;
use crate::log::csv::cells::Line;
use crate::log::csv::dialect::COMMENTS;
use crate::log::map::Signal;
use crate::log::units::names::are_alike;
use crate::log::units::to_si;

/// Names and units of columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    pub(super) names: Vec<String>,
    pub(super) units: Option<Vec<String>>,
    /// Its line, from 1; 0 where there is none.
    pub(super) line: usize,
}

/// The header among the lines above the first row: the last one that names all mapped columns, else the last one that
/// is as wide as the rows, above a row of units.
pub(super) fn header_above(above: &[Line], width: usize, mapped: &[&str]) -> Header {
    let names_all = |line: &&Line| {
        let header = Header::of(line, mapped);
        mapped
            .iter()
            .all(|name| header.names.iter().any(|own| own == name))
    };
    let is_wide = |line: &&Line| line.cells.len() == width;
    let units = above
        .last()
        .filter(|line| is_wide(line) && are_units(&line.cells));
    let names = &above[..above.len() - usize::from(units.is_some())];
    let named = names
        .iter()
        .rposition(|line| names_all(&line) && !is_labelled(line));
    let wide = || {
        names
            .iter()
            .rposition(|line| is_wide(&line) && !is_labelled(line))
    };
    match named.or_else(wide) {
        Some(place) => Header {
            units: units
                .map(|line| line.cells.clone())
                .or_else(|| labelled_units(&above[place + 1..], width)),
            ..Header::of(&names[place], mapped)
        },
        // a single line of what may be units are names all the same
        None => units.map_or_else(|| Header::numbered(width), |line| Header::of(line, mapped)),
    }
}

/// Whether every cell has a label, as those below the names that the Simulation Data Inspector writes.
fn is_labelled(line: &Line) -> bool {
    let mut filled = line.cells.iter().filter(|cell| !cell.is_empty());
    filled.all(|cell| cell.contains(": "))
}

/// Units below the names, each with its label, as the Simulation Data Inspector writes them: `Unit: rad/s`.
fn labelled_units(below: &[Line], width: usize) -> Option<Vec<String>> {
    let unit = |column: usize| {
        let mut cells = below.iter().filter_map(|line| line.cells.get(column));
        let labelled = cells.find_map(|cell| cell.strip_prefix("Unit:"));
        labelled.unwrap_or_default().trim().to_owned()
    };
    let units: Vec<String> = (0..width).map(unit).collect();
    units.iter().any(|unit| !unit.is_empty()).then_some(units)
}

/// Whether cells are units: known ones, or in brackets; some may be empty.
fn are_units(cells: &[String]) -> bool {
    let is_bracketed = |cell: &str| {
        [('[', ']'), ('(', ')')]
            .iter()
            .any(|(open, close)| cell.starts_with(*open) && cell.ends_with(*close))
    };
    let is_unit = |cell: &String| to_si(cell).is_ok() || is_bracketed(cell) || cell == "%";
    let mut filled = cells.iter().filter(|cell| !cell.is_empty());
    filled.clone().count() > 0 && filled.all(is_unit)
}

impl Header {
    /// The names of a line; the mark of a comment belongs to the first one only if the log map says so.
    pub(super) fn of(line: &Line, mapped: &[&str]) -> Self {
        let mut names = line.cells.clone();
        if let Some(first) = names
            .first_mut()
            .filter(|first| !mapped.contains(&first.as_str()))
        {
            *first = first.trim_start_matches(COMMENTS).trim().to_owned();
        }
        // a mark alone before the first name: `# t u y`
        if line.is_comment && names.first().is_some_and(String::is_empty) && !mapped.contains(&"") {
            names.remove(0);
        }
        Self {
            names,
            units: None,
            line: line.number,
        }
    }

    /// Columns without names: their numbers from 1.
    pub(super) fn numbered(width: usize) -> Self {
        Self {
            names: (1..=width).map(|number| number.to_string()).collect(),
            units: None,
            line: 0,
        }
    }

    /// The places of the columns of signals.
    pub(super) fn columns(
        &self,
        path: &Path,
        signals: &[&Signal],
    ) -> Result<Vec<usize>, FileError> {
        let column = |signal: &&Signal| self.column(path, &signal.source);
        signals.iter().map(column).collect()
    }

    /// The places of all columns of a name.
    pub(super) fn places(&self, name: &str) -> Vec<usize> {
        let is_it = |place: &usize| self.names[*place] == name;
        (0..self.names.len()).filter(is_it).collect()
    }

    /// The unit of a column, if the file says one.
    pub(super) fn unit(&self, column: usize) -> Option<&str> {
        let written = self.units.as_ref()?.get(column)?;
        let written = written.trim_matches(['[', ']', '(', ')']);
        (!written.is_empty()).then_some(written)
    }

    /// The place of the one column of a name.
    pub(super) fn column(&self, path: &Path, name: &str) -> Result<usize, FileError> {
        let places = self.places(name);
        let found = match (&places[..], self.line) {
            ([place], _) => return Ok(*place),
            ([], 0) => "no such column, and no header with names",
            ([], _) => "no such column",
            _ => "two of that name",
        };
        let mut listed = HashSet::new();
        let names = self.names.iter().filter(|name| listed.insert(*name));
        let names: Vec<&str> = names.map(String::as_str).collect();
        let needed = format!("one of {}", names.join(", "));
        Err(FileError::content(
            path,
            format!("column `{name}`"),
            found,
            needed,
        ))
    }

    /// Where a unit in the file is another one than the log map says: `None` where they agree, or the file says
    /// nothing.
    pub(super) fn other_unit(&self, signal: &Signal, column: usize) -> Option<String> {
        let written = self.unit(column)?;
        let is_same = signal.unit == "1" || are_alike(written, &signal.unit);
        (!is_same).then(|| {
            format!(
                "column `{}` is in `{written}` by the file and in `{}` by the map",
                signal.source, signal.unit
            )
        })
    }
}
