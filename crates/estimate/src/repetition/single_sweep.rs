//! Sweep that is there once: its frequency rises, or falls, from part to part of the signal.

use crate::correlation::channel::present;

/// Parts that are compared.
const PARTS: usize = 8;
/// The part at the fast end must cross zero so many times more often than the one at the slow end.
const RISE: f64 = 2.0;
/// A crossing counts when the signal goes as far beyond its mean, in rms: noise crosses more often.
const BEYOND: f64 = 0.5;

/// Whether a signal crosses its mean more and more often, or less and less, from each eighth of it to the
/// next.
pub(super) fn is_single_sweep(values: &[f64]) -> bool {
    let mut counts = crossings_of_parts(values);
    let is_up = rises(&counts);
    counts.reverse();
    is_up || rises(&counts)
}

fn crossings_of_parts(values: &[f64]) -> Vec<usize> {
    let active = active(values);
    let part = active.len().div_ceil(PARTS).max(1);
    active.chunks(part).map(crossings).collect()
}

fn rises(counts: &[usize]) -> bool {
    let (Some(&first), Some(&last)) = (counts.first(), counts.last()) else {
        return false;
    };
    let is_rising = counts.len() == PARTS && counts.is_sorted_by(|a, b| a < b);
    is_rising && last as f64 >= RISE * first as f64
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
    let centred = centred(part);
    let least = BEYOND * rms(&centred);
    let clear = centred.into_iter().filter(|value| value.abs() > least);
    let signs: Vec<bool> = clear.map(|value| value > 0.0).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// The values that are there, without their mean.
fn centred(part: &[f64]) -> Vec<f64> {
    let mean = present(part).sum::<f64>() / present(part).count() as f64;
    present(part).map(|value| value - mean).collect()
}

fn rms(values: &[f64]) -> f64 {
    let squares: f64 = values.iter().map(|value| value.powi(2)).sum();
    (squares / values.len().max(1) as f64).sqrt()
}
