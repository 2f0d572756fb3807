//! Contested samples: two different rows with one stamp, and no free slot that one of them could be
//! of, as a recorder writes them that reads while another thread writes.

use std::ops::Range;

use crate::log::clock::evenness::stretches;
use crate::log::clock::line::Line;
use crate::log::clock::sample_time::Guess;
use crate::log::clock::slots::Slots;
use crate::log::clock::{Flaw, flaw};
use crate::log::recording::{Series, picked, repeats_stamp};
use crate::log::text::seconds_after;

/// Share of the rows that may be contested; more are two recordings, or two publishers.
const MOST_CONTESTED: f64 = 0.005;

/// The stamps of the rows that were taken out.
#[derive(Debug, Default)]
pub(crate) struct Contested {
    stamps_ns: Vec<i64>,
}

impl Contested {
    /// The slots of a series from a guess, once its contested rows are taken out.
    pub(crate) fn cleared(&mut self, series: &mut Series, guess: Guess) -> Result<Slots, Flaw> {
        loop {
            let slots = Slots::of(&series.stamps_ns, guess);
            if self.take_out(series, &slots)? == 0 {
                return Ok(slots);
            }
        }
    }

    /// Takes rows out of the series that have no slot, with the rows whose stamp they share; returns
    /// how many there were.
    fn take_out(&mut self, series: &mut Series, slots: &Slots) -> Result<usize, Flaw> {
        let rows = rows_without_slot(&series.stamps_ns, slots);
        self.stamps_ns.extend(picked(&series.stamps_ns, &rows));
        self.check_few(&series.stamps_ns)?;
        if !rows.is_empty() {
            self.take_from(series);
        }
        Ok(rows.len())
    }

    /// Refuses more than a few contested stamps.
    fn check_few(&self, stamps_ns: &[i64]) -> Result<(), Flaw> {
        let most = (MOST_CONTESTED * stamps_ns.len() as f64).max(1.0);
        if self.stamps_ns.len() as f64 > most {
            return mixed(stamps_ns);
        }
        Ok(())
    }

    fn take_from(&mut self, series: &mut Series) {
        self.stamps_ns.sort_unstable();
        let kept = self.uncontested(&series.stamps_ns);
        series.rearrange(&kept);
    }

    /// The rows with other stamps.
    fn uncontested(&self, stamps_ns: &[i64]) -> Vec<usize> {
        let is_kept = |row: &usize| self.stamps_ns.binary_search(&stamps_ns[*row]).is_err();
        (0..stamps_ns.len()).filter(is_kept).collect()
    }

    /// The slots of their stamps, along a line from the first of the stamps that are left.
    pub(crate) fn slots(&self, stamps_ns: &[i64], line: Line) -> Vec<u32> {
        let slot = |stamp: &i64| line.slot(stamp.saturating_sub(stamps_ns[0]) as f64);
        self.stamps_ns.iter().filter_map(slot).collect()
    }
}

/// Rows that repeat a stamp and push a stretch of others out of their slots: those before them, late
/// to make room, or those after.
fn rows_without_slot(stamps_ns: &[i64], slots: &Slots) -> Vec<usize> {
    let stretches = stretches(&slots.behind).into_iter();
    let pushing = stretches.filter_map(|stretch| pushing(stretch, &slots.behind));
    let mut rows: Vec<usize> = pushing
        .filter(|row| repeats_stamp(stamps_ns, *row))
        .collect();
    rows.dedup();
    rows
}

/// The row beside a stretch that pushes it out: behind late ones, before early ones.
fn pushing(stretch: Range<usize>, behind: &[i32]) -> Option<usize> {
    match behind[stretch.start] > 0 {
        true => Some(stretch.end),
        false => stretch.start.checked_sub(1),
    }
}

/// What is wrong where many rows share a stamp.
fn mixed<T>(stamps_ns: &[i64]) -> Result<T, Flaw> {
    let repeating = |row: &usize| repeats_stamp(stamps_ns, *row);
    let rows: Vec<usize> = (0..stamps_ns.len()).filter(repeating).collect();
    let count = rows.len();
    let after = seconds_after(stamps_ns, rows.first().copied().unwrap_or(0));
    flaw(
        format!("{count} stamps that are there twice with different values, the first {after}"),
        "one stamp for each sample: several recordings or publishers are mixed",
    )
}
