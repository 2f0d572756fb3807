//! Slips of a run: rows that were lost without a trace, so that from there on everything comes too
//! early, or rows that are there twice, so that it comes too late.
//!
//! A fast signal that slips is unlike itself. A slow one hardly changes, but for one period the lag
//! after which it repeats best is another.

use std::ops::Range;

use crate::correlation::channel::Channel;
use crate::correlation::long_lags::{LocalLag, Pairs};

/// A lag is another if it differs by more than half a sample ...
const LEAST: f64 = 0.5;
/// ... and by so many standard deviations.
const DEVIATIONS: f64 = 8.0;
/// Lags disagree if half of them are further from the usual one than a quarter of a sample, or so
/// much of a short period, ...
const DISAGREE: f64 = 0.004;
/// ... and than so many standard deviations, of which half lie within 0.67.
const SCATTER: f64 = 2.5;
/// Runs of two periods may be so much of one shorter: their ends are rough before the period is found.
const SHORT: f64 = 1.0 / 32.0;
/// A run is looked at in windows of one period that are so far apart, in periods.
const STEP: f64 = 0.5;

/// The lag of most of the runs, and the runs of two periods and longer that are left when they are
/// cut where they slip.
pub(super) fn without_slips(
    channels: &[Channel],
    runs: &[Range<usize>],
    period: f64,
    stride: usize,
) -> (f64, Vec<Range<usize>>) {
    let lag = |start: usize| {
        let window = start..start + (2.0 * period) as usize;
        let pairs = Pairs {
            channels,
            runs: &[window],
            stride,
        };
        (start, pairs.local_lag(period.round() as usize))
    };
    let lags = |run: &Range<usize>| starts(run, period).map(lag).collect();
    let lags: Vec<Vec<(usize, LocalLag)>> = runs.iter().map(lags).collect();
    let usual = median(lags.iter().flatten().map(|(_, local)| local.lag)).unwrap_or(period);
    if !agree(&lags, usual) {
        return (usual, Vec::new());
    }
    let parts = runs.iter().zip(&lags).flat_map(|(run, lags)| {
        let slips = slips(lags, usual).into_iter();
        let places = slips
            .map(|slip| place(channels, run, usual, &slip))
            .collect();
        parts(run, places)
    });
    let is_long = |part: &Range<usize>| part.len() as f64 > (2.0 - SHORT) * period - 1.0;
    (usual, parts.filter(is_long).collect())
}

/// Whether most windows have the usual lag: cycles of a narrow band, or of a sweep, are alike from one
/// to the next, but each has a length of its own.
fn agree(lags: &[Vec<(usize, LocalLag)>], usual: f64) -> bool {
    let all = || lags.iter().flatten().map(|(_, local)| local);
    let off = median(all().map(|local| (local.lag - usual).abs())).unwrap_or(0.0);
    let chance = median(all().map(|local| local.deviation)).unwrap_or(0.0);
    off <= (DISAGREE * usual).min(LEAST / 2.0).max(SCATTER * chance)
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Where the windows of a run begin.
fn starts(run: &Range<usize>, period: f64) -> impl Iterator<Item = usize> + use<> {
    let last = (run.end + 1).saturating_sub((2.0 * period) as usize);
    (run.start..last.max(run.start)).step_by(((STEP * period) as usize).max(1))
}

/// Windows that follow each other, with another lag than usual.
struct Slip {
    starts: Range<usize>,
    /// Samples by which what follows comes too early.
    early: isize,
}

fn slips(lags: &[(usize, LocalLag)], usual: f64) -> Vec<Slip> {
    let early = |local: &LocalLag| usual - local.lag;
    let is_other = |local: &LocalLag| early(local).abs() > LEAST.max(DEVIATIONS * local.deviation);
    let same = |a: &(usize, LocalLag), b: &(usize, LocalLag)| is_other(&a.1) == is_other(&b.1);
    let groups = lags.chunk_by(same).filter(|group| is_other(&group[0].1));
    let slip = |group: &[(usize, LocalLag)]| {
        let most = group
            .iter()
            .max_by(|a, b| early(&a.1).abs().total_cmp(&early(&b.1).abs()))?;
        let early = early(&most.1).round() as isize;
        let starts = group.first()?.0..group.last()?.0;
        (early != 0).then_some(Slip { starts, early })
    };
    groups.filter_map(slip).collect()
}

/// The first sample after a slip: one period after the beginning of the period that fits best
/// with the other lag.
fn place(channels: &[Channel], run: &Range<usize>, usual: f64, slip: &Slip) -> usize {
    let lag = usual.round() as usize;
    let first = slip
        .starts
        .start
        .saturating_sub(lag)
        .max(run.start + slip.early.max(0) as usize);
    let last =
        (slip.starts.end + 2 * lag).min(run.end.saturating_sub(lag + slip.early.unsigned_abs()));
    let gain = |k: usize| {
        let gains = channels.iter().map(|channel| {
            let x = channel.values();
            let (now, usual) = (x[k], x[k + lag]);
            (usual - now).powi(2) - (x[(k + lag).wrapping_add_signed(-slip.early)] - now).powi(2)
        });
        gains.filter(|gain| !gain.is_nan()).sum::<f64>()
    };
    let gains: Vec<f64> = (first..last.max(first)).map(gain).collect();
    let (mut sum, mut most, mut best) = (0.0, f64::MIN, 0);
    for (end, gain) in gains.iter().enumerate() {
        sum += gain - if end < lag { 0.0 } else { gains[end - lag] };
        if sum > most {
            (most, best) = (sum, (end + 1).saturating_sub(lag));
        }
    }
    first + best + lag
}

/// The run, cut at `places`.
fn parts(run: &Range<usize>, places: Vec<usize>) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = run.start;
    for place in places.into_iter().chain([run.end]) {
        let end = place.clamp(start, run.end);
        parts.push(start..end);
        start = end;
    }
    parts
}
