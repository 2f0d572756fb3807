//! Table of rows of which each holds some of the signals, split into series by which rows they have:
//! two topics in one CSV, two arms on one topic, a command at a quarter of the rate.

use crate::log::map::Signals;
use crate::log::recording::{Cells, Series, picked};

/// Two signals are of two series if each has at least this share of the rows to itself,
const APART: f64 = 0.01;
/// or if they share less than this part of the rows that either has. Above, cells are just lost.
const SHARED: f64 = 0.8;
/// Fewer rows than this that one of them lacks say nothing.
const FEWEST: usize = 8;
/// Ways to lack signals that are told apart; in a row that lacks still others, all are taken to be
/// there, as numbers that are lost.
const MOST_PATTERNS: usize = 255;

/// Rows as they come in.
#[derive(Debug, Default)]
pub(crate) struct Table {
    series: Series,
    /// The ways met.
    patterns: Vec<Pattern>,
    /// The way of each row.
    pattern_of: Vec<u8>,
}

/// A way to lack signals.
#[derive(Debug)]
struct Pattern {
    /// Which signals are there.
    there: Vec<bool>,
    n_rows: usize,
}

impl Pattern {
    /// The pattern of a row, or that of rows that have all.
    fn of(row: &Cells, has_all: bool) -> Self {
        let there = |value: &Option<f64>| has_all || value.is_some();
        Self {
            there: row.iter().map(there).collect(),
            n_rows: 0,
        }
    }

    fn is_of(&self, row: &Cells) -> bool {
        let mut pairs = self.there.iter().zip(row);
        pairs.all(|(there, value)| *there == value.is_some())
    }

    fn has_any(&self, columns: &[usize]) -> bool {
        columns.iter().any(|column| self.there[*column])
    }
}

impl Table {
    /// Table of a topic without rows yet.
    pub(crate) fn of(topic: &str) -> Self {
        Self {
            series: Series {
                topic: topic.into(),
                ..Default::default()
            },
            ..Default::default()
        }
    }

    pub(crate) fn topic(&self) -> &str {
        &self.series.topic
    }

    pub(crate) fn n_rows(&self) -> usize {
        self.series.stamps_ns.len()
    }

    /// Bytes of its rows, at most: lists grow by twice.
    pub(crate) fn n_bytes(&self) -> u64 {
        let width = size_of::<u64>() * (2 + self.series.columns.len()) + 1;
        2 * (self.n_rows() * width) as u64
    }

    /// The last stamp.
    pub(crate) fn last_ns(&self) -> Option<i64> {
        self.series.stamps_ns.last().copied()
    }

    /// Adds a signal; before the first row.
    pub(crate) fn add_signal(&mut self, signal: usize) {
        self.series.signals.push(signal);
        self.series.columns.push(Vec::new());
    }

    /// Takes in a row; one that holds none of the signals is no sample of them. Returns whether it
    /// was taken.
    pub(crate) fn push(&mut self, stamp_ns: i64, row: &Cells) -> bool {
        if row.iter().all(Option::is_none) {
            return false;
        }
        self.series.push(stamp_ns, row);
        let pattern = self.pattern(row);
        self.pattern_of.push(pattern);
        true
    }

    /// The number of a row's pattern, a new one if it was never met.
    fn pattern(&mut self, row: &Cells) -> u8 {
        let known = self.patterns.iter().position(|known| known.is_of(row));
        let number = known.unwrap_or_else(|| self.add_pattern(row));
        self.patterns[number].n_rows += 1;
        number as u8
    }

    /// The number of a pattern that was never met; where there are too many, that of the last one,
    /// which has all signals.
    fn add_pattern(&mut self, row: &Cells) -> usize {
        let number = self.patterns.len().min(MOST_PATTERNS);
        if number == self.patterns.len() {
            let is_last = number == MOST_PATTERNS;
            self.patterns.push(Pattern::of(row, is_last));
        }
        number
    }

    /// Takes other stamps, one for each row: those of the recorder.
    pub(crate) fn restamp(&mut self, stamps_ns: Vec<i64>) {
        self.series.stamps_ns = stamps_ns;
        self.series.is_recorders = true;
    }

    /// The series of the table; several are named by their signals.
    pub(crate) fn split(self, signals: &Signals) -> Vec<Series> {
        let groups = self.groups();
        if groups.len() == 1 {
            return vec![self.series];
        }
        groups
            .iter()
            .map(|group| self.part(group, signals))
            .collect()
    }

    /// Columns that are of one series, group by group.
    fn groups(&self) -> Vec<Vec<usize>> {
        let are_apart = |a, b| self.overlap(a, b).is_apart();
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for column in 0..self.series.columns.len() {
            let is_its = |group: &&mut Vec<usize>| !are_apart(group[0], column);
            match groups.iter_mut().find(is_its) {
                Some(group) => group.push(column),
                None => groups.push(vec![column]),
            }
        }
        groups
    }

    /// The rows of two columns.
    fn overlap(&self, a: usize, b: usize) -> Overlap {
        let mut overlap = Overlap::default();
        for Pattern { there, n_rows } in &self.patterns {
            overlap.add(there[a], there[b], *n_rows);
        }
        overlap
    }

    /// The rows that hold any of these columns.
    fn part(&self, group: &[usize], signals: &Signals) -> Series {
        let rows = self.rows_of(group);
        let places = picked(&self.series.signals, group);
        let column = |column: &usize| picked(&self.series.columns[*column], &rows);
        Series {
            topic: names(&places, signals),
            is_recorders: self.series.is_recorders,
            stamps_ns: picked(&self.series.stamps_ns, &rows),
            columns: group.iter().map(column).collect(),
            signals: places,
        }
    }

    fn rows_of(&self, group: &[usize]) -> Vec<usize> {
        let is_there = |row: &usize| self.pattern_at(*row).has_any(group);
        (0..self.n_rows()).filter(is_there).collect()
    }

    fn pattern_at(&self, row: usize) -> &Pattern {
        &self.patterns[usize::from(self.pattern_of[row])]
    }
}

/// The sources of signals, by their places among all.
pub(crate) fn names(places: &[usize], signals: &Signals) -> String {
    let names = places.iter().map(|place| signals[*place].source.as_str());
    names.collect::<Vec<_>>().join(", ")
}

/// How many rows hold only one of two signals, only the other, or both.
#[derive(Debug, Default)]
struct Overlap {
    only_a: usize,
    only_b: usize,
    both: usize,
}

impl Overlap {
    fn add(&mut self, has_a: bool, has_b: bool, n_rows: usize) {
        match (has_a, has_b) {
            (true, false) => self.only_a += n_rows,
            (false, true) => self.only_b += n_rows,
            (true, true) => self.both += n_rows,
            _ => {}
        }
    }

    /// Whether the signals have rows of their own.
    fn is_apart(&self) -> bool {
        let alone = self.only_a.min(self.only_b) as f64;
        let any = (self.only_a + self.only_b + self.both) as f64;
        self.says_enough() && (alone > APART * any || (self.both as f64) < SHARED * any)
    }

    fn says_enough(&self) -> bool {
        let Self {
            only_a,
            only_b,
            both,
        } = self;
        only_a + only_b >= FEWEST && only_a + both > 0 && only_b + both > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(has: impl Fn(usize, usize) -> bool) -> Vec<String> {
        let signal = |source: &str| crate::log::map::Signal::of(source, "1");
        let signals = [signal("a"), signal("b"), signal("c")];
        let mut table = Table::of("rows");
        (0..3).for_each(|k| table.add_signal(k));
        for row in 0..1000 {
            let values = [0, 1, 2].map(|k| has(row, k).then_some(row as f64));
            table.push(row as i64, &values);
        }
        let series = table.split(&signals.each_ref());
        series.into_iter().map(|series| series.topic).collect()
    }

    #[test]
    fn signals_are_apart_by_their_rows_and_not_by_lost_cells() {
        assert_eq!(names(|_, _| true), ["rows"]);
        assert_eq!(names(|row, k| row % 10 != 3 * k), ["a", "b", "c"]);
        assert_eq!(names(|row, k| k != 1 || row % 10 != 3), ["rows"]);
        assert_eq!(names(|row, k| k == 1 || row % 4 == 0), ["a, c", "b"]);
        assert_eq!(names(|row, k| (row % 2 == 0) == (k == 0)), ["a", "b, c"]);
        assert_eq!(names(|row, k| row % 2 == 0 && k < 2), ["rows"]);
    }

    #[test]
    fn rows_that_lack_signals_at_random_are_no_series_of_their_own() {
        let mut table = Table::of("rows");
        (0..12).for_each(|k| table.add_signal(k));
        for row in 0..4096_u32 {
            let there = |k: u32| row.wrapping_mul(2_654_435_761).rotate_left(k) % 64 != 0;
            let values: Vec<_> = (0..12).map(|k| there(k).then_some(1.0)).collect();
            table.push(i64::from(row), &values);
        }
        assert!(table.patterns.len() <= 256 && table.n_rows() >= 4090);
    }
}
