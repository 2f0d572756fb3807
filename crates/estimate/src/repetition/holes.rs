//! Holes in a run: samples that are lost for so long that one period later tells nothing about
//! whether both sides belong together. Several periods later may.

use std::ops::Range;

use crate::correlation::channel::Channel;
use crate::correlation::long_lags::Pairs;
use crate::repetition::runs::LIMIT;

/// Holes from so much of a period on are looked at.
const SHORTEST: f64 = 0.75;

/// The runs, cut at holes whose sides do not repeat each other after whole periods; pieces of less
/// than two periods are left out.
pub(super) fn without_breaks(
    channels: &[Channel],
    runs: &[Range<usize>],
    period: f64,
    stride: usize,
) -> Vec<Range<usize>> {
    let whole = |run: &Range<usize>| {
        let mut pieces: Vec<Range<usize>> = Vec::new();
        let mut start = run.start;
        for hole in holes(channels, run, period, stride) {
            if !is_bridged(channels, run, &hole, period, stride) {
                pieces.push(start..hole.start);
                start = hole.end;
            }
        }
        pieces.push(start..run.end);
        pieces.retain(|piece| piece.len() as f64 > 2.0 * period - 1.0 || piece == run);
        pieces
    };
    runs.iter().flat_map(whole).collect()
}

/// Long stretches within a run in which every channel is lost.
fn holes(
    channels: &[Channel],
    run: &Range<usize>,
    period: f64,
    stride: usize,
) -> Vec<Range<usize>> {
    let mut holes: Vec<Range<usize>> = Vec::new();
    for k in run
        .clone()
        .step_by(stride)
        .filter(|&k| Channel::are_lost(channels, k))
    {
        match holes.last_mut().filter(|hole| hole.end == k) {
            Some(hole) => hole.end += stride,
            None => holes.push(k..k + stride),
        }
    }
    holes.retain(|hole| hole.len() as f64 >= SHORTEST * period);
    holes
}

/// Whether the period before the hole comes again after it.
fn is_bridged(
    channels: &[Channel],
    run: &Range<usize>,
    hole: &Range<usize>,
    period: f64,
    stride: usize,
) -> bool {
    let count = (hole.len() as f64 / period).floor() + 1.0;
    let reach = period.ceil() as usize;
    let around = hole.start.saturating_sub(reach).max(run.start)..(hole.end + reach).min(run.end);
    let pairs = Pairs {
        channels,
        runs: &[around],
        stride,
    };
    pairs.residual(count * period) <= LIMIT
}
