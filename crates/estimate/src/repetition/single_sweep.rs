//! Sweep that is there once: its frequency rises, or falls, from part to part of the signal.

use crate::error::aperiodic::Sweep;

/// Parts that are compared.
const PARTS: usize = 8;
/// The part at the fast end must cross zero so many times more often than the one at the slow end.
const RISE: f64 = 2.0;
/// A crossing counts when the signal goes as far beyond its mean, in rms: noise crosses more often.
const BEYOND: f64 = 0.5;

/// The way of a signal that crosses its mean more and more often, or less and less, from each eighth
/// of it to the next.
pub(super) fn single_sweep(values: &[f64]) -> Option<Sweep> {
    let active = active(values);
    let part = active.len().div_ceil(PARTS).max(1);
    let counts: Vec<usize> = active.chunks(part).map(crossings).collect();
    let backward: Vec<usize> = counts.iter().rev().copied().collect();
    match (rises(&counts), rises(&backward)) {
        (true, _) => Some(Sweep::Up),
        (_, true) => Some(Sweep::Down),
        _ => None,
    }
}

fn rises(counts: &[usize]) -> bool {
    let ends = counts.first().zip(counts.last());
    let rise = ends.is_some_and(|(&first, &last)| last as f64 >= RISE * first as f64);
    counts.len() == PARTS && rise && counts.windows(2).all(|pair| pair[0] < pair[1])
}

/// What lies between the first and the last sample beyond half the rms.
fn active(values: &[f64]) -> &[f64] {
    let is_beyond = |value: &f64| value.abs() > BEYOND;
    let first = values.iter().position(is_beyond).unwrap_or(0);
    let last = values.iter().rposition(is_beyond).unwrap_or(0);
    values.get(first..=last).unwrap_or_default()
}

/// Changes between clearly above and clearly below the mean.
fn crossings(part: &[f64]) -> usize {
    let present = || part.iter().filter(|value| !value.is_nan());
    let count = present().count().max(1) as f64;
    let mean = present().sum::<f64>() / count;
    let rms = (present().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    let clear = present()
        .map(|value| value - mean)
        .filter(|value| value.abs() > BEYOND * rms);
    let signs: Vec<bool> = clear.map(|value| value > 0.0).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}
