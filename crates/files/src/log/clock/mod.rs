//! Sample clock of a recording, from its stamps. A recording is never resampled: a clock that does
//! not fit is refused.

pub(crate) mod contested;
pub(crate) mod evenness;
pub(crate) mod line;
pub(crate) mod order;
pub(crate) mod phase;
pub(crate) mod rounded;
pub(crate) mod sample_time;
pub(crate) mod slots;
#[cfg(test)]
mod tests;

use crate::log::clock::contested::Contested;
use crate::log::clock::line::{Line, Points};
use crate::log::clock::order::Order;
use crate::log::clock::sample_time::{Guess, resolution_ns};
use crate::log::recording::Series;
use crate::log::text::duration;

/// What the stamps of one topic say.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Clock {
    /// Sample time in s: that of the straight line through the stamps, or the one that was stated.
    pub(crate) sample_time_s: f64,
    /// Slot of every stamp: its sample number, the first one being 0; strictly rising.
    pub(crate) slots: Vec<u32>,
    /// Slots that two different rows claim by one stamp: neither is believed.
    pub(crate) contested: Vec<u32>,
    /// Deviation of the stamps from an even grid, rms in parts of the sample time, without those
    /// that are out of their slot.
    pub(crate) jitter: f64,
    /// The same, largest of all stamps.
    pub(crate) largest_jitter: f64,
    /// Stamps that are out of their slot.
    pub(crate) n_out: usize,
    /// What the stamps are rounded to, in s, where this explains their deviations.
    pub(crate) resolution_s: Option<f64>,
    /// The even grid.
    pub(crate) line: Line,
}

/// What is wrong with the stamps: found, needed.
pub(crate) type Flaw = (String, String);

pub(crate) fn flaw<T>(found: impl Into<String>, needed: impl Into<String>) -> Result<T, Flaw> {
    Err((found.into(), needed.into()))
}

/// Above this share of the sample time, jitter is worth a warning.
pub(crate) const NOTABLE_JITTER: f64 = 0.01;
/// A stamp that is off by more than this share of the sample time is out of its slot.
pub(crate) const OUT_OF_SLOT: f64 = 0.5;
/// Rounded stamps are centred on their line to this, in samples.
pub(crate) const ROUNDING: f64 = 0.02;
/// The sample time that is stated may differ from that of the stamps by this share: quartzes differ
/// by 1e-4, a slewed clock by 5e-4.
pub(crate) const STATED_TOLERANCE: f64 = 1e-3;

impl Clock {
    /// Fits an even grid to the stamps of a series, or says what is wrong. Rows are sorted, and taken
    /// out where they are there twice. `stated_s` is the sample time in s that the user gave.
    pub(crate) fn of(
        series: &mut Series,
        stated_s: Option<f64>,
        warnings: &mut Vec<String>,
    ) -> Result<Self, Flaw> {
        let stated_ns = stated_s.map(|stated_s| stated_s * 1e9);
        let is_finer = |stamps: &[i64]| stated_ns.is_none_or(|ns| resolution_ns(stamps) <= ns);
        let order = Order::of(series, is_finer);
        check_count(series.stamps_ns.len())?;
        order.check_few()?;
        let unit_ns = resolution_ns(&series.stamps_ns);
        let guess = Guess::of(&series.stamps_ns, unit_ns, stated_ns);
        evenness::check_amount(&series.stamps_ns, guess.step_ns)?;
        let fitted = Self::fit(series, guess, unit_ns, stated_ns);
        let clock = order.checked(&series.stamps_ns, fitted)?;
        warnings.extend(order.warnings(&series.topic));
        Ok(clock)
    }

    /// Fits an even grid to rising stamps from a guess.
    fn fit(
        series: &mut Series,
        guess: Guess,
        unit_ns: f64,
        stated_ns: Option<f64>,
    ) -> Result<Self, Flaw> {
        evenness::check_twins(&series.stamps_ns, stated_ns.is_some())?;
        let mut contested = Contested::default();
        let slots = contested.cleared(series, guess)?;
        let stamps_ns = &series.stamps_ns;
        evenness::check_stretches(stamps_ns, &slots)?;
        let points = slots.points(stamps_ns);
        let reach = OUT_OF_SLOT.max(0.5 * unit_ns / guess.step_ns + ROUNDING);
        let line = line_of(points, reach, stated_ns)?;
        evenness::check_even(points, line, unit_ns)?;
        let clock = Self {
            contested: contested.slots(stamps_ns, line),
            ..Self::along(line, points, reach, unit_ns)
        };
        evenness::check_sure(&clock)?;
        Ok(clock)
    }

    /// The clock of a line, without contested slots.
    fn along(line: Line, points: Points, reach: f64, unit_ns: f64) -> Self {
        let jitter = line.jitter(points, reach);
        let is_rounded = jitter > NOTABLE_JITTER && evenness::is_rounded(points, line, unit_ns);
        Self {
            sample_time_s: line.step_ns / 1e9,
            slots: points.slots.to_vec(),
            contested: Vec::new(),
            jitter,
            largest_jitter: line.largest_deviation(points),
            n_out: points.slots.len() - line.n_within(points, reach),
            resolution_s: is_rounded.then_some(unit_ns / 1e9),
            line,
        }
    }

    /// The stamps that it was fitted to, with their slots.
    pub(crate) fn points<'p>(&'p self, stamps_ns: &'p [i64]) -> Points<'p> {
        Points {
            stamps_ns,
            slots: &self.slots,
        }
    }

    /// Number of samples of the grid, missing ones included.
    pub(crate) fn n_slots(&self) -> usize {
        self.slots.last().map_or(0, |last| *last as usize + 1)
    }
}

fn check_count(n_samples: usize) -> Result<(), Flaw> {
    if n_samples < 2 {
        return flaw(format!("{n_samples} samples"), "at least 2");
    }
    Ok(())
}

/// The line through the stamps, or that of the stated sample time if they agree.
fn line_of(points: Points, reach: f64, stated_ns: Option<f64>) -> Result<Line, Flaw> {
    let line = Line::through(points, reach);
    match stated_ns {
        Some(stated_ns) => stated_line(points, stated_ns, line.step_ns),
        None => Ok(line),
    }
}

fn stated_line(points: Points, stated_ns: f64, step_ns: f64) -> Result<Line, Flaw> {
    check_stated(stated_ns, step_ns)?;
    Ok(Line::of_step(points, stated_ns))
}

/// Whether a sample time is the stated one.
pub(crate) fn agrees(step_ns: f64, stated_ns: f64) -> bool {
    (step_ns / stated_ns - 1.0).abs() <= STATED_TOLERANCE
}

fn check_stated(stated_ns: f64, step_ns: f64) -> Result<(), Flaw> {
    if agrees(step_ns, stated_ns) {
        return Ok(());
    }
    flaw(
        format!("stamps every {}", duration(step_ns)),
        format!("every {}, as sample_time_s states", duration(stated_ns)),
    )
}
