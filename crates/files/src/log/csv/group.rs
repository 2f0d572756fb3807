//! Columns of a table that share a clock: all of them, those behind one of several time columns, or the rows of one
//! topic.

use std::collections::BTreeSet;
use std::path::Path;

use crate::error::FileError;
use crate::log::csv::dialect::Dialect;
use crate::log::csv::header::Header;
use crate::log::csv::row::Row;
use crate::log::map::{LogMap, Signal, Signals};
use crate::log::sample_times::{SampleTimes, nth_stamp_ns};
use crate::log::table::{Table, names};

/// Names of a long table, with a row for each value.
const TOPIC: &str = "topic";
const VALUE: &str = "value";
/// Its times: of the message, which may be empty, of the recorder, and since the beginning.
pub(super) const LONG_TIMES: [&str; 3] = ["header.stamp", "receive time", "elapsed time"];
/// Topics that are listed.
const LISTED: usize = 40;

/// Mapped columns and their clock, while their rows come in.
pub(super) struct Group {
    clock: SampleTimes,
    /// Their signals, by their places among all.
    signals: Vec<usize>,
    columns: Vec<usize>,
    pub(super) table: Table,
    /// Whether the table has several time columns.
    pub(super) is_behind_its_time: bool,
    topic: Option<Topic>,
    number: usize,
    /// The last line that held something of it.
    pub(super) last_line: usize,
}

/// A topic of a long table.
struct Topic {
    column: usize,
    name: String,
    /// Some of the others.
    others: BTreeSet<String>,
}

/// Whether a row was a group's.
pub(super) enum Taken {
    Yes,
    No,
    /// It has values and no time.
    Untimed,
}

/// Columns of a group before their rows come in.
struct Plan {
    time: Option<usize>,
    columns: Vec<(usize, usize)>,
    topic: Option<Topic>,
}

impl Group {
    /// The groups of a table, in the order of their first signals.
    pub(super) fn all(
        path: &Path,
        dialect: &Dialect,
        map: &LogMap,
        signals: &Signals,
    ) -> Result<Vec<Self>, FileError> {
        let header = &dialect.header;
        let plans = match long_columns(header) {
            Some((topic, value)) => by_topic(topic, value, signals),
            None => by_time(path, header, map, signals)?,
        };
        let n_plans = plans.len();
        let group = |plan: Plan| {
            let place = |name: &str| plan.time.map_or_else(|| header.column(path, name), Ok);
            let clock = SampleTimes::of(path, map, place)?;
            let (places, columns): (Vec<_>, Vec<_>) = plan.columns.into_iter().unzip();
            let topic = match n_plans {
                1 => "rows".to_owned(),
                _ => names(&places, signals),
            };
            let mut table = Table::of(&topic);
            places.iter().for_each(|place| table.add_signal(*place));
            Ok(Self {
                clock,
                signals: places,
                columns,
                table,
                is_behind_its_time: plan.time.is_some(),
                topic: plan.topic,
                number: 0,
                last_line: 0,
            })
        };
        plans.into_iter().map(group).collect()
    }

    /// Takes a row in, if it is one of the group's.
    pub(super) fn take(&mut self, row: &Row) -> Result<Taken, FileError> {
        if !self.topic.as_mut().is_none_or(|topic| topic.has(row)) {
            return Ok(Taken::No);
        }
        let stamp_ns = match &self.clock {
            SampleTimes::Counted(step_ns) => Some(nth_stamp_ns(self.number, *step_ns)),
            SampleTimes::Column(column) => row.stamp_ns(column, self.table.last_ns())?,
        };
        self.number += 1;
        let values = row.numbers(&self.columns)?;
        match stamp_ns {
            Some(stamp_ns) if self.table.push(stamp_ns, &values) => {
                self.last_line = row.line;
                Ok(Taken::Yes)
            }
            None if !self.is_behind_its_time || values.iter().any(Option::is_some) => {
                Ok(Taken::Untimed)
            }
            _ => Ok(Taken::No),
        }
    }

    /// Where units in the file are others than the map says, and where values may lack a scale.
    pub(super) fn doubts(&self, dialect: &Dialect, signals: &Signals) -> Vec<String> {
        let pairs = self.signals.iter().zip(&self.columns);
        let doubts = |(place, column): (&usize, &usize)| {
            let signal = signals[*place];
            let is_scaled = dialect.scaled.contains(column);
            let scaled = is_scaled.then(|| {
                format!(
                    "column `{}` is scaled in TwinCAT Scope, which exports values with or without: see the rows ScaleFactor and Offset, and state `scale` in the log map where they lack it",
                    signal.source
                )
            });
            [dialect.header.other_unit(signal, *column), scaled]
        };
        pairs.flat_map(doubts).flatten().collect()
    }

    /// That columns end before the table does, in words.
    pub(super) fn ended(&self, last_line: usize, signals: &Signals) -> Option<String> {
        let is_early = self.is_behind_its_time && self.last_line < last_line;
        is_early.then(|| {
            format!(
                "{}: the column ends in line {}, others in line {last_line}",
                names(&self.signals, signals),
                self.last_line
            )
        })
    }
}

impl Topic {
    /// Whether a row is the topic's.
    fn has(&mut self, row: &Row) -> bool {
        let cell = row.cell(self.column);
        let is_its = cell == self.name;
        if !is_its {
            self.see(cell);
        }
        is_its
    }

    /// Remembers another topic, to name it where this one is not there.
    fn see(&mut self, other: &str) {
        if self.others.len() < LISTED && !self.others.contains(other) {
            self.others.insert(other.to_owned());
        }
    }
}

/// Refuses topics of a long table without a row.
pub(super) fn check_topics(
    path: &Path,
    groups: &[Group],
    signals: &Signals,
) -> Result<(), FileError> {
    let is_missing = |group: &&Group| group.topic.is_some() && group.table.n_rows() == 0;
    let Some(group) = groups.iter().find(is_missing) else {
        return Ok(());
    };
    let others = group.topic.iter().flat_map(|topic| &topic.others);
    let others: Vec<&str> = others.map(String::as_str).collect();
    let what = format!("topic `{}`", names(&group.signals, signals));
    let needed = format!("one of {}", others.join(", "));
    Err(FileError::content(
        path,
        what,
        "no row with a time and a value",
        needed,
    ))
}

/// The columns of topics and values of a long table.
pub(super) fn long_columns(header: &Header) -> Option<(usize, usize)> {
    let place = |name: &str| header.names.iter().position(|own| own == name);
    LONG_TIMES.iter().find_map(|time| place(time))?;
    Some((place(TOPIC)?, place(VALUE)?))
}

fn by_topic(topic: usize, value: usize, signals: &Signals) -> Vec<Plan> {
    let plan = |(place, signal): (usize, &&Signal)| Plan {
        time: None,
        columns: vec![(place, value)],
        topic: Some(Topic {
            column: topic,
            name: signal.source.clone(),
            others: BTreeSet::new(),
        }),
    };
    signals.iter().enumerate().map(plan).collect()
}

/// Signals by the time column that rules them: of several of one name the last one before them.
fn by_time(
    path: &Path,
    header: &Header,
    map: &LogMap,
    signals: &Signals,
) -> Result<Vec<Plan>, FileError> {
    let columns = header.columns(path, signals)?;
    let times = map.time.as_ref().map(|time| header.places(&time.source));
    let times = times.filter(|places| places.len() > 1).unwrap_or_default();
    let mut plans: Vec<Plan> = Vec::new();
    for (place, column) in columns.into_iter().enumerate() {
        let time = times.iter().copied().rfind(|time| *time < column);
        if time.is_none() && !times.is_empty() {
            return Err(no_time_before(path, signals[place]));
        }
        match plans.iter_mut().find(|plan| plan.time == time) {
            Some(plan) => plan.columns.push((place, column)),
            None => plans.push(Plan {
                time,
                columns: vec![(place, column)],
                topic: None,
            }),
        }
    }
    Ok(plans)
}

fn no_time_before(path: &Path, signal: &Signal) -> FileError {
    let what = format!("column `{}`", signal.source);
    let found = "no time column before it, of several";
    FileError::content(path, what, found, "a column behind its times")
}
