//! Order of the rows of a recording: sorted by their stamps where messages came out of order, copies
//! taken out.

use crate::log::clock::{Clock, Flaw, flaw};
use crate::log::recording::{Series, picked};
use crate::log::text::{duration, seconds_after};

/// Share of rows that may come after one with a later stamp; more are two recordings in one file.
const MOST_OUT_OF_ORDER: f64 = 0.1;
/// A row out of order is believed where its stamp is this close to a slot, in samples.
const SURE: f64 = 0.25;

/// What was found out of order.
#[derive(Debug, Default)]
pub(crate) struct Order {
    /// For each row whether it came after one with a later stamp; empty if none did.
    late: Vec<bool>,
    /// Least number of rows without which the others are in order, at most.
    n_out: usize,
    /// In words, the first stamp before its predecessor.
    first: Option<String>,
    /// Rows that were there twice.
    n_copies: usize,
}

impl Order {
    /// Sorts the rows by their stamps; takes out copies, rows that repeat stamp and values of the one
    /// before. Where stamps are coarser than the samples, equal rows are not copies.
    pub(crate) fn of(series: &mut Series, are_copies: impl Fn(&[i64]) -> bool) -> Self {
        let mut order = Self::found(&series.stamps_ns);
        if order.first.is_some() {
            order.sort(series);
        }
        if are_copies(&series.stamps_ns) {
            order.drop_copies(series);
        }
        order
    }

    fn found(stamps_ns: &[i64]) -> Self {
        let mut order = Self {
            late: late(stamps_ns),
            n_out: n_ahead(stamps_ns),
            first: first_backwards(stamps_ns),
            n_copies: 0,
        };
        order.n_out = order.n_out.min(order.n_late());
        order
    }

    fn sort(&mut self, series: &mut Series) {
        let mut places: Vec<usize> = (0..series.stamps_ns.len()).collect();
        places.sort_by_key(|place| series.stamps_ns[*place]);
        self.rearrange(series, &places);
    }

    fn drop_copies(&mut self, series: &mut Series) {
        let count = series.stamps_ns.len();
        let is_new = |row: &usize| !series.is_copy(*row);
        let kept: Vec<usize> = (0..count).filter(is_new).collect();
        self.n_copies = count - kept.len();
        if self.n_copies > 0 {
            self.rearrange(series, &kept);
        }
    }

    fn rearrange(&mut self, series: &mut Series, places: &[usize]) {
        series.rearrange(places);
        if !self.late.is_empty() {
            self.late = picked(&self.late, places);
        }
    }

    fn n_late(&self) -> usize {
        self.late.iter().filter(|late| **late).count()
    }

    /// What is wrong if the rows cannot be put in order.
    fn flaw<T>(&self, first: &str) -> Result<T, Flaw> {
        flaw(
            format!("{} stamps before their predecessor, {first}", self.n_late()),
            "rising stamps: several recordings or clocks are mixed, or the clock was set back; cut the recording there",
        )
    }

    /// Refuses more than a few rows out of order.
    pub(crate) fn check_few(&self) -> Result<(), Flaw> {
        match &self.first {
            Some(first) if self.n_out as f64 > MOST_OUT_OF_ORDER * self.late.len() as f64 => {
                self.flaw(first)
            }
            _ => Ok(()),
        }
    }

    /// Refuses rows out of order that do not fill a gap of the clock: then it was set back. A flaw of
    /// the clock itself comes from there, too.
    pub(crate) fn checked(
        &self,
        stamps_ns: &[i64],
        fitted: Result<Clock, Flaw>,
    ) -> Result<Clock, Flaw> {
        match (&self.first, fitted) {
            (None, fitted) => fitted,
            (_, Ok(clock)) if self.fills_gaps(stamps_ns, &clock) => Ok(clock),
            (Some(first), _) => self.flaw(first),
        }
    }

    /// Whether all rows out of order are where the clock has a slot.
    fn fills_gaps(&self, stamps_ns: &[i64], clock: &Clock) -> bool {
        let points = clock.points(stamps_ns);
        let is_sure = |row: usize| clock.line.deviation(points, row).abs() <= SURE;
        let mut late = (0..self.late.len()).filter(|row| self.late[*row]);
        stamps_ns.len() == self.late.len() && late.all(is_sure)
    }

    /// What was done, of a topic.
    pub(crate) fn warnings(&self, topic: &str) -> Vec<String> {
        let (n_copies, n_late) = (self.n_copies, self.n_late());
        let copies = (n_copies > 0).then(|| {
            format!("{topic}: {n_copies} messages are there twice; one of each was dropped")
        });
        let sorted = self.first.as_ref().map(|first| {
            format!(
                "{topic}: {n_late} messages out of order were put where their stamps say, {first}"
            )
        });
        copies.into_iter().chain(sorted).collect()
    }
}

/// Whether each row comes after one with a later stamp.
fn late(stamps_ns: &[i64]) -> Vec<bool> {
    if stamps_ns.is_sorted() {
        return Vec::new();
    }
    let mut latest = i64::MIN;
    let is_late = |stamp: &i64| {
        latest = latest.max(*stamp);
        *stamp < latest
    };
    stamps_ns.iter().map(is_late).collect()
}

/// How many rows come before one with an earlier stamp.
fn n_ahead(stamps_ns: &[i64]) -> usize {
    let mut earliest = i64::MAX;
    let is_ahead = |stamp: &&i64| {
        earliest = earliest.min(**stamp);
        **stamp > earliest
    };
    stamps_ns.iter().rev().filter(is_ahead).count()
}

/// The first stamp that lies before its predecessor, in words.
fn first_backwards(stamps_ns: &[i64]) -> Option<String> {
    let falls = |pair: &[i64]| pair[1] < pair[0];
    let before = stamps_ns.windows(2).position(falls)?;
    let (row, next) = (before + 1, before + 2);
    let back = duration(stamps_ns[before].abs_diff(stamps_ns[row]) as f64);
    let after = seconds_after(stamps_ns, before);
    Some(format!(
        "the first is that of sample {next}, {back} before that of sample {row}, {after}"
    ))
}
