//! Listing of a table: its columns of numbers and moments, with their units, by the clocks that they share.

use std::collections::HashSet;
use std::path::Path;

use crate::error::FileError;
use crate::log::csv::cells::{Line, lines_of, number, unsqueezed_lines_of};
use crate::log::csv::dialect::{CsvTable, Dialect};
use crate::log::csv::group::{LONG_TIMES, long_columns};
use crate::log::csv::moment::Moment;
use crate::log::csv::scope;
use crate::log::csv::text::Text;
use crate::log::csv::whole_lines;
use crate::log::listing::{ListedSignal, Listing, N_FIRST, SignalGroup};
use crate::log::units::names::unit_in_name;

/// Lists the columns of a table by its first rows.
pub(crate) fn list(path: &Path) -> Result<Listing, FileError> {
    let text = Text::open(path, None)?;
    let head = whole_lines(&text);
    let dialect = Dialect::of(path, head, &CsvTable::default(), &[])?;
    let lines = match dialect.is_scope {
        true => unsqueezed_lines_of(head, dialect.separator),
        false => lines_of(head, dialect.separator),
    };
    let rows = lines
        .iter()
        .filter(|line| line.number >= dialect.first_line && !line.is_comment);
    let mut seen = HashSet::new();
    let names = dialect.header.names.iter();
    let twice = names.filter(|name| !seen.insert(*name)).cloned().collect();
    let mut table = Head {
        twice,
        told: Vec::from_iter(dialect.told(text.encoding)),
        rows: rows.collect(),
        dialect,
    };
    let groups = match long_columns(&table.dialect.header) {
        Some((topic, value)) => table.topics(topic, value),
        None => table.clocks(text.is_whole),
    };
    Ok(Listing {
        format: "CSV",
        told: table.told,
        groups,
    })
}

/// The beginning of a table.
struct Head<'l> {
    dialect: Dialect,
    rows: Vec<&'l Line>,
    /// Names that several columns have.
    twice: HashSet<String>,
    told: Vec<String>,
}

impl Head<'_> {
    /// Columns, those behind one of several time columns together.
    fn clocks(&mut self, is_whole: bool) -> Vec<SignalGroup> {
        let n_rows = self.rows.len();
        self.rows.truncate(N_FIRST);
        let mut groups = vec![SignalGroup::default()];
        for place in 0..self.dialect.header.names.len() {
            let is_time = self.is_one_of_times(place);
            let Some(signal) = self.signal(place, is_time) else {
                continue;
            };
            if is_time {
                groups.push(SignalGroup::default());
            }
            let last = groups.len() - 1;
            groups[last].signals.push(signal);
        }
        let mut together = together(groups);
        if let [only] = &mut together[..] {
            only.name = "rows".into();
            only.n_rows = (is_whole && n_rows < N_FIRST).then_some(n_rows);
        }
        together
    }

    /// Whether a column is one of several of times, each of which rules those behind it.
    fn is_one_of_times(&self, place: usize) -> bool {
        let name = &self.dialect.header.names[place];
        match self.dialect.is_scope {
            true => name == scope::NAMES,
            false => name.eq_ignore_ascii_case("time") && self.twice.contains(name),
        }
    }

    /// A column as a signal; what is none is told.
    fn signal(&mut self, place: usize, is_time: bool) -> Option<ListedSignal> {
        let name = self.dialect.header.names[place].clone();
        if !is_time && self.twice.contains(&name) {
            self.told.push(format!(
                "two columns `{name}`: give them other names to use them"
            ));
            return None;
        }
        let unit = self.unit(place);
        let unit = unit.or_else(|| (is_time && self.dialect.is_scope).then(|| "ms".into()));
        let signal = column(&self.dialect, &self.rows, place, &name, unit);
        if signal.is_none() {
            self.told.push(format!(
                "column `{name}` holds no numbers in its first rows"
            ));
        }
        signal
    }

    fn unit(&self, place: usize) -> Option<String> {
        let header = &self.dialect.header;
        let stated = header.unit(place).map(str::to_owned);
        stated.or_else(|| unit_in_name(&header.names[place]))
    }

    /// The topics of a long table, each with the times that its rows have.
    fn topics(&self, topic: usize, value: usize) -> Vec<SignalGroup> {
        let mut topics: Vec<(&str, Vec<&Line>)> = Vec::new();
        for row in &self.rows {
            let name = row.cells.get(topic).map_or("", String::as_str);
            match topics.iter_mut().find(|(known, _)| *known == name) {
                Some((_, rows)) if rows.len() == N_FIRST => {}
                Some((_, rows)) => rows.push(row),
                None => topics.push((name, vec![row])),
            }
        }
        let header = &self.dialect.header;
        let signals = |name: &str, rows: &[&Line]| {
            let times = LONG_TIMES.iter().filter_map(|time| {
                let place = header.places(time).first().copied()?;
                column(&self.dialect, rows, place, time, Some("s".into()))
            });
            let unit = unit_in_name(name);
            let values = column(&self.dialect, rows, value, name, unit);
            times.chain(values).collect()
        };
        let group = |(name, rows): (&str, Vec<&Line>)| SignalGroup {
            name: name.into(),
            signals: signals(name, &rows),
            ..SignalGroup::default()
        };
        topics.into_iter().map(group).collect()
    }
}

/// Adds a group to those of other times, or its signals to the one of the same.
fn join(groups: &mut Vec<SignalGroup>, group: SignalGroup) {
    let is_same = |known: &&mut SignalGroup| {
        let (a, b) = (&known.signals[0], &group.signals[0]);
        a.source == b.source && a.first == b.first
    };
    match groups.iter_mut().find(is_same) {
        Some(known) => known.signals.extend(group.signals.into_iter().skip(1)),
        None => groups.push(group),
    }
}

/// A column, if any of its first cells is a number or a moment.
fn column(
    dialect: &Dialect,
    rows: &[&Line],
    place: usize,
    name: &str,
    unit: Option<String>,
) -> Option<ListedSignal> {
    let cells = || {
        rows.iter()
            .map(|row| row.cells.get(place).map_or("", String::as_str))
    };
    let first: Vec<f64> = cells()
        .map(|cell| number(cell, dialect.decimal).unwrap_or(f64::NAN))
        .collect();
    let has_numbers = first.iter().any(|value| value.is_finite());
    let is_moment = !has_numbers && cells().any(|cell| Moment::of(cell).is_some());
    (has_numbers || is_moment).then(|| ListedSignal {
        is_moment,
        ..ListedSignal::of(name.to_owned(), unit, first)
    })
}

/// Groups of equal times as one, each named by its first signal.
fn together(groups: Vec<SignalGroup>) -> Vec<SignalGroup> {
    let mut together: Vec<SignalGroup> = Vec::new();
    for group in groups.into_iter().filter(|group| !group.signals.is_empty()) {
        join(&mut together, group);
    }
    for group in &mut together {
        let first = group.signals.get(1).or(group.signals.first());
        group.name = first.map_or_else(String::new, |first| format!("rows of {}", first.source));
    }
    together
}
