//! Listing of a table: its columns of numbers and moments, with their units.

use std::path::Path;

use crate::error::FileError;
use crate::log::csv::cells::{Line, lines_of, number};
use crate::log::csv::dialect::{CsvTable, Dialect};
use crate::log::csv::moment::Moment;
use crate::log::csv::text::Text;
use crate::log::csv::whole_lines;
use crate::log::listing::{ListedSignal, Listing, N_FIRST, SignalGroup};
use crate::log::unit_names::unit_in_name;

/// Lists the columns of a table by its first rows.
pub(crate) fn list(path: &Path) -> Result<Listing, FileError> {
    let text = Text::open(path, None)?;
    let head = whole_lines(&text);
    let dialect = Dialect::of(path, head, &CsvTable::default(), &[])?;
    let lines = lines_of(head, dialect.separator);
    let rows = lines
        .iter()
        .filter(|line| line.number >= dialect.first_line && !line.is_comment);
    let rows: Vec<&Line> = rows.take(N_FIRST).collect();
    let names = &dialect.header.names;
    let (mut signals, mut told) = (Vec::new(), Vec::from_iter(dialect.told(text.encoding)));
    for (place, name) in names.iter().enumerate() {
        let is_twice = names.iter().filter(|other| *other == name).count() > 1;
        match column(&dialect, &rows, place) {
            Some(_) if is_twice => told.push(format!(
                "two columns `{name}`: give them other names to use them"
            )),
            Some(signal) => signals.push(signal),
            None => told.push(format!(
                "column `{name}` holds no numbers in its first rows"
            )),
        }
    }
    let n_rows = text
        .is_whole
        .then_some(rows.len())
        .filter(|n_rows| *n_rows < N_FIRST);
    Ok(Listing {
        format: "CSV",
        told,
        groups: vec![SignalGroup {
            name: "rows".into(),
            type_name: None,
            n_rows,
            signals,
        }],
    })
}

/// A column, if any of its first cells is a number or a moment.
fn column(dialect: &Dialect, rows: &[&Line], place: usize) -> Option<ListedSignal> {
    let cells = || {
        rows.iter()
            .map(|row| row.cells.get(place).map_or("", String::as_str))
    };
    let first: Vec<f64> = cells()
        .map(|cell| number(cell, dialect.decimal).unwrap_or(f64::NAN))
        .collect();
    let has_numbers = first.iter().any(|value| value.is_finite());
    let is_moment = !has_numbers && cells().any(|cell| Moment::of(cell).is_some());
    let header = &dialect.header;
    let name = &header.names[place];
    let stated = header.units.as_ref().and_then(|units| units.get(place));
    let stated = stated.map(|unit| unit.trim_matches(['[', ']', '(', ')']).to_owned());
    let unit = stated
        .filter(|unit| !unit.is_empty())
        .or_else(|| unit_in_name(name));
    (has_numbers || is_moment).then(|| ListedSignal {
        is_moment,
        ..ListedSignal::of(name.clone(), unit, first)
    })
}
