//! Ends of a run: where it is as likely to have begun or ended as not, in whole periods if it is
//! close to that.

use std::ops::Range;

use crate::correlation::likeness::quieter_half;
use crate::repetition::runs::{EXACT, LIMIT};

/// Share of the samples in a rest, of which only one of the two moves.
const STRANGER: f64 = 0.5;
/// Ends are looked at that far, in periods.
const EDGE: f64 = 0.25;
/// A share at an end counts for at most so much: more than within, where one bad sample may pass.
const EDGE_CAP: f64 = 4.0;
/// A run is stretched to whole periods if at most this share of one is missing, and four samples:
/// so much noise hides at its ends.
const STRETCH: f64 = 1.0 / 64.0;
const SAMPLES: f64 = 4.0;
/// A run is cut to whole periods if it has at most this share of one too much: a slow signal that
/// begins near zero hides so much under noise.
const EXCESS: f64 = 1.0 / 8.0;

/// The stretch of shares with its ends where they belong; `length` is that of a period.
pub(super) fn settled_ends(shares: &[f64], stretch: &Range<usize>, length: f64) -> Range<usize> {
    let level = quieter_half(&shares[stretch.clone()], length).clamp(EXACT, LIMIT);
    let strange = (STRANGER / level).ln() / (1.0 / level - 1.0 / STRANGER);
    let cost = |share: &f64| match share.is_nan() {
        true => 0.0,
        false => (share / strange).min(EDGE_CAP) - 1.0,
    };
    let trimmed = trimmed(&shares[stretch.clone()], cost, (EDGE * length) as usize);
    let trimmed = stretch.start + trimmed.start..stretch.start + trimmed.end;
    whole_periods(shares, cost, trimmed, length)
}

/// Without what is likelier not to repeat, of at most `most` places at either end.
fn trimmed(shares: &[f64], cost: impl Fn(&f64) -> f64, most: usize) -> Range<usize> {
    let start = costly(shares.iter().take(most).map(&cost));
    let end = costly(shares.iter().rev().take(most).map(&cost));
    start..(shares.len() - end).max(start)
}

/// How many of the first costs make the largest sum.
fn costly(costs: impl Iterator<Item = f64>) -> usize {
    let (mut sum, mut most, mut count) = (0.0, 0.0, 0);
    for (index, cost) in costs.enumerate() {
        sum += cost;
        if sum > most {
            (most, count) = (sum, index + 1);
        }
    }
    count
}

/// The stretch, or the cheapest of whole periods that lies within it or around it, where little is
/// missing or too much.
fn whole_periods(
    shares: &[f64],
    cost: impl Fn(&f64) -> f64,
    stretch: Range<usize>,
    length: f64,
) -> Range<usize> {
    let wanted = ((stretch.len() as f64 / length).round() * length).floor() as usize;
    let missing = wanted.saturating_sub(stretch.len());
    let excess = stretch.len().saturating_sub(wanted);
    let is_close =
        missing as f64 <= (STRETCH * length).max(SAMPLES) && excess as f64 <= EXCESS * length;
    if wanted == 0 || !is_close || wanted > shares.len() {
        return stretch;
    }
    let last = (stretch.start + excess).min(shares.len() - wanted);
    let first = stretch.start.saturating_sub(missing).min(last);
    // from one place to the next, one share is left behind and one is added
    let (mut sum, mut least, mut best) = (0.0, 0.0, first);
    for start in first..last {
        sum += cost(&shares[start + wanted]) - cost(&shares[start]);
        if sum < least {
            (least, best) = (sum, start + 1);
        }
    }
    best..best + wanted
}
