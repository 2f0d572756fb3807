//! Table of rows of which each holds some of the signals, split into series by which rows they have:
//! two topics in one CSV, two arms on one topic, a command at a quarter of the rate.

use crate::log::map::Signal;
use crate::log::recording::{Series, picked};

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
    /// Which signals are there, for each way met.
    patterns: Vec<Vec<bool>>,
    /// The way of each row.
    pattern_of: Vec<u8>,
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
    pub(crate) fn push(&mut self, stamp_ns: i64, row: &[Option<f64>]) -> bool {
        if row.iter().all(Option::is_none) {
            return false;
        }
        self.series.stamps_ns.push(stamp_ns);
        for (column, value) in self.series.columns.iter_mut().zip(row) {
            column.push(value.unwrap_or(f64::NAN));
        }
        let pattern = self.pattern(row);
        self.pattern_of.push(pattern);
        true
    }

    /// The number of a row's pattern, a new one if it was never met.
    fn pattern(&mut self, row: &[Option<f64>]) -> u8 {
        let is_same = |pattern: &Vec<bool>| {
            let mut pairs = pattern.iter().zip(row);
            pairs.all(|(there, value)| *there == value.is_some())
        };
        let known = self.patterns.iter().position(is_same);
        let number = known.unwrap_or_else(|| {
            if self.patterns.len() <= MOST_PATTERNS {
                let is_last = self.patterns.len() == MOST_PATTERNS;
                let there = |value: &Option<f64>| is_last || value.is_some();
                self.patterns.push(row.iter().map(there).collect());
            }
            self.patterns.len() - 1
        });
        number as u8
    }

    /// Takes other stamps, one for each row: those of the recorder.
    pub(crate) fn restamp(&mut self, stamps_ns: Vec<i64>) {
        self.series.stamps_ns = stamps_ns;
        self.series.is_recorders = true;
    }

    /// The series of the table; several are named by their signals.
    pub(crate) fn split(self, signals: &[&Signal]) -> Vec<Series> {
        let groups = self.groups();
        if groups.len() == 1 {
            return vec![self.series];
        }
        let part = |group: &Vec<usize>| self.part(group, signals);
        groups.iter().map(part).collect()
    }

    /// Columns that are of one series, group by group.
    fn groups(&self) -> Vec<Vec<usize>> {
        let mut n_rows = vec![0_usize; self.patterns.len()];
        for pattern in &self.pattern_of {
            n_rows[usize::from(*pattern)] += 1;
        }
        let count = |has: &dyn Fn(&[bool]) -> bool| -> usize {
            let patterns = self.patterns.iter().zip(&n_rows);
            patterns
                .filter(|(pattern, _)| has(pattern))
                .map(|(_, rows)| rows)
                .sum()
        };
        let are_apart = |a: usize, b: usize| {
            are_apart(
                count(&|there| there[a] && !there[b]),
                count(&|there| there[b] && !there[a]),
                count(&|there| there[a] && there[b]),
            )
        };
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for column in 0..self.series.columns.len() {
            match groups.iter_mut().find(|group| !are_apart(group[0], column)) {
                Some(group) => group.push(column),
                None => groups.push(vec![column]),
            }
        }
        groups
    }

    /// The rows that hold any of these columns.
    fn part(&self, group: &[usize], signals: &[&Signal]) -> Series {
        let is_there = |row: &usize| {
            let pattern = &self.patterns[usize::from(self.pattern_of[*row])];
            group.iter().any(|column| pattern[*column])
        };
        let rows: Vec<usize> = (0..self.n_rows()).filter(is_there).collect();
        let places: Vec<usize> = group
            .iter()
            .map(|column| self.series.signals[*column])
            .collect();
        let names = places.iter().map(|place| signals[*place].source.as_str());
        let column = |column: &usize| picked(&self.series.columns[*column], &rows);
        Series {
            topic: names.collect::<Vec<_>>().join(", "),
            is_recorders: self.series.is_recorders,
            stamps_ns: picked(&self.series.stamps_ns, &rows),
            columns: group.iter().map(column).collect(),
            signals: places,
        }
    }
}

/// Whether two signals have rows of their own: `only` one, the other, or both there.
fn are_apart(only_a: usize, only_b: usize, both: usize) -> bool {
    if only_a + only_b < FEWEST || only_a + both == 0 || only_b + both == 0 {
        return false;
    }
    let any = (only_a + only_b + both) as f64;
    let least = APART * any;
    (only_a as f64 > least && only_b as f64 > least) || (both as f64) < SHARED * any
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(has: impl Fn(usize, usize) -> bool) -> Vec<String> {
        let signal = |source: &str| Signal {
            source: source.into(),
            unit: "1".into(),
            scale: 1.0,
        };
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
