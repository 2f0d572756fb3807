//! Runs of a recording: stretches in which it repeats back to back with one period.

use std::ops::Range;

use crate::correlation::channel::Channel;
use crate::correlation::likeness::{Likeness, quieter_half};
use crate::repetition::holes::without_breaks;
use crate::repetition::run_ends::settled_ends;
use crate::repetition::two_states::cheapest_stretches;

/// Largest share of the power that may be noise: 10 dB below the signal.
pub(super) const LIMIT: f64 = 0.1;
/// Share that is as likely for a signal under noise of 10 dB less as for two strangers.
const STRANGE: f64 = 0.24;
/// A share counts for at most so many times the strange one: one bad sample ends no run.
const CAP: f64 = 4.0;
/// A run begins or ends where it pays for an eighth of a period: slow signals are alike for so
/// long by chance.
const CHANGE: f64 = 0.125;
/// Power below this share of that of the strongest run is rest, whatever repeats in it (30 dB).
const REST: f64 = 1e-3;
/// The share that ends a run, over that in its quieter half (14 dB): noise may grow as much.
const GROWTH: f64 = 25.0;
/// Smallest share that ends a run: rounding to six digits.
pub(super) const EXACT: f64 = 1e-6;

/// Runs with one period, as compared at every `stride`-th sample.
#[derive(Clone)]
pub(super) struct Runs {
    pub(super) period: f64,
    pub(super) runs: Vec<Range<usize>>,
    /// Share of the power that does not repeat.
    pub(super) residual: f64,
    /// Mean power in the runs, and how much of the recording has a tenth of it or more without
    /// being in one.
    pub(super) power: f64,
    pub(super) left_out: usize,
    /// Samples in the runs that are not lost.
    pub(super) covered: usize,
}

impl Runs {
    /// The runs of two periods and longer, or none.
    pub(super) fn find(channels: &[Channel], period: f64, stride: usize) -> Self {
        let like = Likeness::new(channels, period, stride);
        let length = period / stride as f64;
        let costs = costs(&like.shares);
        let change = CHANGE * length * share_present(&like.shares);
        let mut stretches = cheapest_stretches(&costs, change);
        let finer = |stretch: &Range<usize>| finer_stretches(&like.shares, stretch, change, length);
        stretches = stretches.iter().flat_map(finer).collect();
        for stretch in &mut stretches {
            *stretch = settled_ends(&like.shares, stretch, length);
        }
        stretches.retain(|stretch| stretch.len() as f64 > length - 1.0);
        drop_rests(&mut stretches, &like);
        let residual = if stretches.is_empty() {
            1.0
        } else {
            like.residual(&stretches)
        };
        let runs = in_samples(&stretches, period, stride, channels);
        let runs = without_breaks(channels, &runs, period, stride);
        let power = mean_power(&runs, &like);
        let covered = n_present(channels, &runs, stride);
        let left_out = left_out(&runs, &like, period, channels, power);
        Self {
            period,
            runs,
            residual,
            power,
            left_out,
            covered,
        }
    }

    /// Whether it repeats well enough, and more of what moves is in runs than out of them.
    pub(super) fn is_sound(&self) -> bool {
        self.residual <= LIMIT && self.covered > self.left_out
    }
}

/// What a share costs in a run, where it is below the strange one: less than nothing.
fn costs(shares: &[f64]) -> Vec<f64> {
    let cost = |share: &f64| match share.is_nan() {
        true => 0.0,
        false => (share / STRANGE).min(CAP) - 1.0,
    };
    shares.iter().map(cost).collect()
}

fn share_present(shares: &[f64]) -> f64 {
    let present = shares.iter().filter(|share| !share.is_nan()).count();
    present as f64 / shares.len().max(1) as f64
}

/// Parts of a stretch that stay close to the level of its quieter half: where rows are lost, a slow
/// signal goes on little changed, but far more than noise changes it.
fn finer_stretches(
    shares: &[f64],
    stretch: &Range<usize>,
    change: f64,
    length: f64,
) -> Vec<Range<usize>> {
    let quiet = quieter_half(&shares[stretch.clone()], length);
    let most = LIMIT.max(quiet * STRANGE / LIMIT);
    let level = (GROWTH * quiet).clamp(EXACT, most);
    let scaled: Vec<f64> = shares[stretch.clone()]
        .iter()
        .map(|share| share * STRANGE / level)
        .collect();
    let parts = cheapest_stretches(&costs(&scaled), change);
    let shifted = parts
        .into_iter()
        .map(|part| part.start + stretch.start..part.end + stretch.start);
    shifted.collect()
}

/// A constant repeats, and so does a hum: neither is a run.
fn drop_rests(stretches: &mut Vec<Range<usize>>, like: &Likeness) {
    if let Some(power) = strongest_power(stretches, like) {
        stretches.retain(|stretch| like.mean_power(stretch) >= REST * power);
    }
}

/// Mean power of the stretch of most energy.
fn strongest_power(stretches: &[Range<usize>], like: &Likeness) -> Option<f64> {
    let energy = |stretch: &Range<usize>| like.mean_power(stretch) * stretch.len() as f64;
    let loudest = stretches
        .iter()
        .max_by(|a, b| energy(a).total_cmp(&energy(b)))?;
    Some(like.mean_power(loudest))
}

/// From places that repeat one period later to the samples between the first and the last.
fn in_samples(
    stretches: &[Range<usize>],
    period: f64,
    stride: usize,
    channels: &[Channel],
) -> Vec<Range<usize>> {
    let n_samples = Channel::n_samples(channels);
    let mut runs: Vec<Range<usize>> = Vec::new();
    for stretch in stretches {
        let end = ((stretch.end * stride) as f64 + period).round() as usize;
        let (mut start, end) = (stretch.start * stride, end.min(n_samples));
        if let Some(before) = runs.last_mut().filter(|before| before.end > start) {
            start = boundary(before, start..end, period);
            before.end = before.end.min(start);
        }
        runs.push(start..end);
    }
    runs
}

/// Where one run ends and the next begins if both claim the samples between: in the middle unless
/// that costs a whole period.
fn boundary(before: &Range<usize>, after: Range<usize>, period: f64) -> usize {
    let periods = |at: usize| {
        let whole = |length: usize| (length as f64 / period + 1e-9).floor();
        whole(at - before.start) + whole(after.end - at)
    };
    let candidates = [after.start, before.end, after.start.midpoint(before.end)];
    let valid = candidates
        .into_iter()
        .filter(|&at| at >= before.start && at <= after.end);
    valid
        .max_by(|&a, &b| periods(a).total_cmp(&periods(b)))
        .unwrap_or(after.start)
}

/// How many samples of the runs are not lost in all channels.
pub(super) fn n_present(channels: &[Channel], runs: &[Range<usize>], stride: usize) -> usize {
    let places = runs.iter().flat_map(|run| run.clone().step_by(stride));
    stride * places.filter(|&k| !Channel::are_lost(channels, k)).count()
}

fn mean_power(runs: &[Range<usize>], like: &Likeness) -> f64 {
    let energy: f64 = runs
        .iter()
        .map(|run| like.power.mean(run) * run.len() as f64)
        .sum();
    energy / runs.iter().map(Range::len).sum::<usize>().max(1) as f64
}

/// Samples between the runs whose surroundings have a tenth of `power`.
fn left_out(
    runs: &[Range<usize>],
    like: &Likeness,
    period: f64,
    channels: &[Channel],
    power: f64,
) -> usize {
    let n_samples = Channel::n_samples(channels);
    let step = (period / 4.0).ceil() as usize;
    let count = |gap: &Range<usize>| {
        let window = (period as usize).min(gap.len());
        let starts = (gap.start..gap.end - window + 1).step_by(step);
        let loud = starts
            .filter(|&k| like.power.from(k) > LIMIT * power)
            .count();
        (loud * step).min(gap.len())
    };
    gaps(runs, n_samples).iter().map(count).sum()
}

/// What is left of `n_samples` between the runs.
pub(super) fn gaps(runs: &[Range<usize>], n_samples: usize) -> Vec<Range<usize>> {
    let starts = std::iter::once(0).chain(runs.iter().map(|run| run.end));
    let ends = runs.iter().map(|run| run.start).chain([n_samples]);
    starts
        .zip(ends)
        .filter(|(start, end)| start < end)
        .map(|(start, end)| start..end)
        .collect()
}
