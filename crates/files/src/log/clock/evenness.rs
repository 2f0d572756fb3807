//! Evenness of a clock: what stamps are refused for, in the words of the one who recorded them.

use std::ops::Range;

use crate::log::clock::line::{Line, Points};
use crate::log::clock::slots::Slots;
use crate::log::clock::{Clock, Flaw, NOTABLE_JITTER, ROUNDING, flaw};
use crate::log::text::{duration, seconds_after};

/// This share of the stamps must lie within plus and minus `MOST_JITTER` of the sample time; the
/// others may be late by any time.
const TYPICAL: f64 = 0.6;
/// Delays spread exponentially by 0.44 samples are within this, and are the most that the phase of a
/// window can be told in; so are normal ones by 0.24, and even ones by plus and minus a third.
pub(crate) const MOST_JITTER: f64 = 0.2;
/// A gap may be as long as all rows together and this many samples; the grid as long as `MOST_LOST`
/// times the rows and four times that: memory goes by what was read.
const FREE_GAP: f64 = 1024.0;
/// Most samples of the grid for each row.
const MOST_LOST: f64 = 8.0;
/// From this share of rows on that repeat the stamp before, the stamps are coarser than the clock.
const MANY_TWINS: usize = 4;
/// Share of the stamps that lie within one unit where they are rounded; the rest may be late.
const MOST_ROUNDED: f64 = 0.95;
/// Rows that follow each other out of their slots by the same number of samples are no chance if
/// that many would be met once in so many recordings.
const CHANCE: f64 = 1e3;
/// Fewer rows than this make no stretch.
const SHORTEST_STRETCH: usize = 4;
/// Share of rows that are out of their slots at random, at most: more are in stretches themselves.
const MOST_OUT: f64 = 0.3;
/// Share of late stamps times share of lost samples: about that many rows, up to twice as many, are
/// next to a lost sample and taken for it.
const MOST_UNSURE: f64 = 0.01;
/// Share of the rows that may stand in such stretches.
const MOST_IN_STRETCHES: f64 = 0.01;

/// Refuses stamps that are all equal, and gaps longer than all data, before memory is taken for
/// what is missing.
pub(crate) fn check_amount(stamps_ns: &[i64], step_ns: f64) -> Result<(), Flaw> {
    let needed = "rising stamps";
    let (Some(first), Some(last)) = (stamps_ns.first(), stamps_ns.last()) else {
        return flaw("no samples", needed);
    };
    if first == last || step_ns <= 0.0 {
        let count = stamps_ns.len();
        return flaw(format!("{count} samples, all of one stamp"), needed);
    }
    let n_rows = stamps_ns.len() as f64;
    check_gaps(stamps_ns, (n_rows + FREE_GAP) * step_ns, n_rows * step_ns)?;
    let n_slots = last.abs_diff(*first) as f64 / step_ns;
    if n_slots <= MOST_LOST * n_rows + 4.0 * FREE_GAP {
        return Ok(());
    }
    let step = duration(step_ns);
    flaw(
        format!("{n_rows} samples in the time of {n_slots:.0} of them, {step} each"),
        "a recording with more samples than gaps; if its sample time is another one, state it: sample_time_s",
    )
}

fn check_gaps(stamps_ns: &[i64], most_ns: f64, rows_ns: f64) -> Result<(), Flaw> {
    let is_long = |row: &usize| stamps_ns[*row].abs_diff(stamps_ns[row - 1]) as f64 > most_ns;
    let Some(row) = (1..stamps_ns.len()).find(is_long) else {
        return Ok(());
    };
    let gap = duration(stamps_ns[row].abs_diff(stamps_ns[row - 1]) as f64);
    let (count, after) = (stamps_ns.len(), seconds_after(stamps_ns, row - 1));
    flaw(
        format!(
            "a gap of {gap} after sample {row}, {after}: longer than all {count} samples together, {}",
            duration(rows_ns)
        ),
        "one recording; cut it there, or take out the samples whose stamps are wrong",
    )
}

/// Refuses stamps of which many repeat the one before them, unless the sample time is stated.
pub(crate) fn check_twins(stamps_ns: &[i64], is_stated: bool) -> Result<(), Flaw> {
    let twins = stamps_ns
        .windows(2)
        .filter(|pair| pair[0] == pair[1])
        .count();
    if is_stated || twins * MANY_TWINS < stamps_ns.len() {
        return Ok(());
    }
    let count = stamps_ns.len();
    flaw(
        format!("{twins} of {count} samples with the stamp of the one before and other values"),
        "a stamp for each sample, of one recording; if the stamps are rounded, state the sample time: sample_time_s",
    )
}

/// Whether the deviations are those of stamps rounded to a unit.
pub(crate) fn is_rounded(points: Points, line: Line, unit_ns: f64) -> bool {
    let unit = unit_ns / line.step_ns;
    let count = points.slots.len();
    let is_within = |k: &usize| line.deviation(points, *k).abs() <= 0.5 * unit + ROUNDING;
    let within = (0..count).filter(is_within).count();
    unit > NOTABLE_JITTER && within as f64 >= MOST_ROUNDED * count as f64
}

/// Whether the stamps are not spread too far about the line; rounding explains a part of its unit.
pub(crate) fn is_even(points: Points, line: Line, unit_ns: f64) -> bool {
    let rounding = match is_rounded(points, line, unit_ns) {
        true => 0.5 * TYPICAL * unit_ns / line.step_ns,
        false => 0.0,
    };
    half_spread(points, line) <= MOST_JITTER + rounding
}

/// Refuses stamps that are not even.
pub(crate) fn check_even(points: Points, line: Line, unit_ns: f64) -> Result<(), Flaw> {
    if is_even(points, line, unit_ns) {
        return Ok(());
    }
    let deviations = (0..points.slots.len()).map(|k| line.deviation(points, k).abs());
    let largest = deviations.fold(0.0, f64::max);
    let spread = half_spread(points, line);
    let step = duration(line.step_ns);
    flaw(
        format!(
            "stamps of which {:.0} % need a span of {:.0} % of a sample about an even clock of {step}, the farthest {largest:.1} samples off",
            100.0 * TYPICAL,
            200.0 * spread
        ),
        format!(
            "a span of {:.0} %: frfid does not resample; record at a fixed rate or, if the sample time is another one, state it: sample_time_s",
            200.0 * MOST_JITTER
        ),
    )
}

/// Half of the shortest span that holds the typical stamps.
pub(crate) fn half_spread(points: Points, line: Line) -> f64 {
    let deviations = (0..points.slots.len()).map(|k| line.deviation(points, k));
    let mut deviations: Vec<f64> = deviations.collect();
    deviations.sort_unstable_by(f64::total_cmp);
    let count = (TYPICAL * deviations.len() as f64).ceil().max(2.0) as usize;
    let spans = deviations.windows(count.min(deviations.len()));
    let spans = spans.filter_map(|span| Some(span.last()? - span.first()?));
    0.5 * spans.min_by(f64::total_cmp).unwrap_or(0.0)
}

/// Refuses so many late stamps among so many losses that it is not known which samples are lost.
pub(crate) fn check_sure(clock: &Clock) -> Result<(), Flaw> {
    let (n_rows, n_slots) = (clock.slots.len(), clock.n_slots());
    let n_lost = n_slots.saturating_sub(n_rows);
    let unsure = clock.n_out as f64 / n_rows as f64 * n_lost as f64 / n_slots as f64;
    if unsure <= MOST_UNSURE {
        return Ok(());
    }
    flaw(
        format!(
            "{} of {n_rows} stamps off by more than half a sample while {n_lost} of {n_slots} samples are lost: which ones cannot be told",
            clock.n_out
        ),
        "stamps that are late or samples that are lost, but not both so often: record the robot's own stamps, and all samples",
    )
}

/// Refuses many rows in a row that are out of their slots by the same number of samples: two
/// recordings in one, or a clock that was set.
pub(crate) fn check_stretches(stamps_ns: &[i64], slots: &Slots) -> Result<(), Flaw> {
    let stretches = stretches(&slots.behind);
    let n_rows: usize = stretches.iter().map(ExactSizeIterator::len).sum();
    let most = MOST_IN_STRETCHES * slots.slots.len() as f64;
    let Some(first) = stretches.first() else {
        return Ok(());
    };
    if n_rows as f64 <= most {
        return Ok(());
    }
    let (behind, after) = (
        slots.behind[first.start],
        seconds_after(stamps_ns, first.start),
    );
    flaw(
        format!(
            "{n_rows} stamps that no even clock explains; the first {} run {behind} samples behind their order, {after}",
            first.len()
        ),
        "rising stamps of one clock: several recordings, publishers or clocks are mixed, or the clock was set; cut the recording there",
    )
}

/// Stretches of rows that are out of their slots by one number of samples, too long for chance.
pub(crate) fn stretches(behind: &[i32]) -> Vec<Range<usize>> {
    let n_out = behind.iter().filter(|behind| **behind != 0).count();
    let shortest = shortest_stretch(behind.len(), n_out);
    let mut found = Vec::new();
    let mut start = 0;
    for run in behind.chunk_by(|a, b| a == b) {
        if run[0] != 0 && run.len() >= shortest {
            found.push(start..start + run.len());
        }
        start += run.len();
    }
    found
}

/// Length that rows out of their slots at random reach once in `CHANCE` recordings.
fn shortest_stretch(n_rows: usize, n_out: usize) -> usize {
    if n_out == 0 {
        return SHORTEST_STRETCH;
    }
    let share = (n_out as f64 / n_rows as f64).min(MOST_OUT);
    let length = (CHANCE * n_rows as f64).ln() / -share.ln();
    (length.ceil().min(n_rows as f64) as usize).max(SHORTEST_STRETCH)
}
