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
    check_rising(stamps_ns, step_ns)?;
    check_gaps(stamps_ns, step_ns)?;
    check_losses(stamps_ns, step_ns)
}

fn check_rising(stamps_ns: &[i64], step_ns: f64) -> Result<(), Flaw> {
    if length_ns(stamps_ns) == 0.0 || step_ns <= 0.0 {
        let count = stamps_ns.len();
        let found = format!("{count} samples, all of one stamp");
        return flaw(found, "rising stamps");
    }
    Ok(())
}

fn check_gaps(stamps_ns: &[i64], step_ns: f64) -> Result<(), Flaw> {
    let most_ns = (stamps_ns.len() as f64 + FREE_GAP) * step_ns;
    let is_long = |pair: &[i64]| length_ns(pair) > most_ns;
    match stamps_ns.windows(2).position(is_long) {
        Some(before) => long_gap(stamps_ns, before, step_ns),
        None => Ok(()),
    }
}

/// What is wrong with a gap behind a row.
fn long_gap(stamps_ns: &[i64], before: usize, step_ns: f64) -> Result<(), Flaw> {
    let (count, row) = (stamps_ns.len(), before + 1);
    let gap = duration(length_ns(&stamps_ns[before..=row]));
    let after = seconds_after(stamps_ns, before);
    let all = duration(count as f64 * step_ns);
    flaw(
        format!(
            "a gap of {gap} after sample {row}, {after}: longer than all {count} samples together, {all}"
        ),
        "one recording; cut it there, or take out the samples whose stamps are wrong",
    )
}

/// Refuses a recording that is mostly gaps.
fn check_losses(stamps_ns: &[i64], step_ns: f64) -> Result<(), Flaw> {
    let n_rows = stamps_ns.len() as f64;
    let n_slots = length_ns(stamps_ns) / step_ns;
    if n_slots <= MOST_LOST * n_rows + 4.0 * FREE_GAP {
        return Ok(());
    }
    let step = duration(step_ns);
    flaw(
        format!("{n_rows} samples in the time of {n_slots:.0} of them, {step} each"),
        "a recording with more samples than gaps; if its sample time is another one, state it: sample_time_s",
    )
}

/// Time from the first stamp to the last.
fn length_ns(stamps_ns: &[i64]) -> f64 {
    let ends = stamps_ns.first().zip(stamps_ns.last());
    ends.map_or(0.0, |(first, last)| last.abs_diff(*first) as f64)
}

/// Refuses stamps of which many repeat the one before them, unless the sample time is stated.
pub(crate) fn check_twins(stamps_ns: &[i64], is_stated: bool) -> Result<(), Flaw> {
    let count = stamps_ns.len();
    let twins = n_twins(stamps_ns);
    if is_stated || twins * MANY_TWINS < count {
        return Ok(());
    }
    flaw(
        format!("{twins} of {count} samples with the stamp of the one before and other values"),
        "a stamp for each sample, of one recording; if the stamps are rounded, state the sample time: sample_time_s",
    )
}

fn n_twins(stamps_ns: &[i64]) -> usize {
    let pairs = stamps_ns.windows(2);
    pairs.filter(|pair| pair[0] == pair[1]).count()
}

/// Whether the deviations are those of stamps rounded to a unit.
pub(crate) fn is_rounded(points: Points, line: Line, unit_ns: f64) -> bool {
    let unit = unit_ns / line.step_ns;
    let within = line.n_within(points, 0.5 * unit + ROUNDING) as f64;
    unit > NOTABLE_JITTER && within >= MOST_ROUNDED * points.slots.len() as f64
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
    flaw(
        spread_told(points, line),
        format!(
            "a span of {:.0} %: frfid does not resample; record at a fixed rate or, if the sample time is another one, state it: sample_time_s",
            200.0 * MOST_JITTER
        ),
    )
}

fn spread_told(points: Points, line: Line) -> String {
    format!(
        "stamps of which {:.0} % need a span of {:.0} % of a sample about an even clock of {}, the farthest {:.1} samples off",
        100.0 * TYPICAL,
        200.0 * half_spread(points, line),
        duration(line.step_ns),
        line.largest_deviation(points)
    )
}

/// Half of the shortest span that holds the typical stamps.
pub(crate) fn half_spread(points: Points, line: Line) -> f64 {
    let mut deviations: Vec<f64> = line.deviations(points).collect();
    deviations.sort_unstable_by(f64::total_cmp);
    0.5 * shortest_span(&deviations, n_typical(deviations.len()))
}

/// How many of so many stamps are the typical ones.
fn n_typical(count: usize) -> usize {
    let typical = (TYPICAL * count as f64).ceil().max(2.0);
    (typical as usize).min(count)
}

/// The shortest span that holds so many of sorted values.
fn shortest_span(sorted: &[f64], count: usize) -> f64 {
    let spans = sorted.windows(count);
    let spans = spans.filter_map(|span| Some(span.last()? - span.first()?));
    spans.min_by(f64::total_cmp).unwrap_or(0.0)
}

/// Refuses so many late stamps among so many losses that it is not known which samples are lost.
pub(crate) fn check_sure(clock: &Clock) -> Result<(), Flaw> {
    let (n_rows, n_slots, n_out) = (clock.slots.len(), clock.n_slots(), clock.n_out);
    let n_lost = n_slots.saturating_sub(n_rows);
    if n_out as f64 / n_rows as f64 * n_lost as f64 / n_slots as f64 <= MOST_UNSURE {
        return Ok(());
    }
    flaw(
        format!(
            "{n_out} of {n_rows} stamps off by more than half a sample while {n_lost} of {n_slots} samples are lost: which ones cannot be told"
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
    match stretches.first() {
        Some(first) if n_rows as f64 > most => {
            let after = seconds_after(stamps_ns, first.start);
            no_even_clock(n_rows, first.len(), slots.behind[first.start], &after)
        }
        _ => Ok(()),
    }
}

/// What is wrong with stretches of so many rows, of which the first has so many that are behind.
fn no_even_clock(n_rows: usize, n_first: usize, behind: i32, after: &str) -> Result<(), Flaw> {
    flaw(
        format!(
            "{n_rows} stamps that no even clock explains; the first {n_first} run {behind} samples behind their order, {after}"
        ),
        "rising stamps of one clock: several recordings, publishers or clocks are mixed, or the clock was set; cut the recording there",
    )
}

/// Stretches of rows that are out of their slots by one number of samples, too long for chance.
pub(crate) fn stretches(behind: &[i32]) -> Vec<Range<usize>> {
    let n_out = behind.iter().filter(|behind| **behind != 0).count();
    let shortest = shortest_stretch(behind.len(), n_out);
    let is_stretch = |run: &Range<usize>| behind[run.start] != 0 && run.len() >= shortest;
    runs(behind).filter(is_stretch).collect()
}

/// Where values stay the same, run by run.
fn runs(values: &[i32]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    values.chunk_by(|a, b| a == b).map(move |run| {
        end += run.len();
        end - run.len()..end
    })
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
