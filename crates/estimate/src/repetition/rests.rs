//! Rests of a recording: stretches around the runs in which nothing is excited; and single periods
//! between rests.

use std::ops::Range;

use crate::correlation::channel::Channel;
use crate::correlation::local_power::LocalPower;
use crate::repetition::runs::{LIMIT, Runs, gaps};

/// Windows over which power is looked at, in periods.
const WINDOW: f64 = 0.25;
/// Power below this share of the strongest window is rest.
const REST: f64 = 0.01;

/// Stretches between the runs, of a quarter of a period and longer, with less than a tenth of the
/// power in the runs.
pub(super) fn find_rests(channels: &[Channel], runs: &Runs) -> Vec<Range<usize>> {
    let n_samples = Channel::n_samples(channels);
    let window = ((WINDOW * runs.period) as usize).max(2);
    let power = LocalPower::new(channels, window, 1);
    let in_gap = |gap: Range<usize>| quiet(&power, gap, window, LIMIT * runs.power);
    gaps(&runs.runs, n_samples)
        .into_iter()
        .flat_map(in_gap)
        .collect()
}

/// Parts of `range` made of windows with less than `limit` of power.
fn quiet(power: &LocalPower, range: Range<usize>, window: usize, limit: f64) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    let last = (range.end + 1).saturating_sub(window).max(range.start);
    for start in (range.start..last).filter(|&start| power.from(start) < limit) {
        match found.last_mut().filter(|before| before.end >= start) {
            Some(before) => before.end = start + window,
            None => found.push(start..start + window),
        }
    }
    found
}

/// Stretches between rests that are long enough for one period; a sixteenth of it may hide where the
/// signal begins and ends, and is taken from where there is most power.
pub(super) fn single_periods(channels: &[Channel], period: f64) -> Vec<Range<usize>> {
    let n_samples = Channel::n_samples(channels);
    let window = ((period / 16.0) as usize).max(2);
    let power = LocalPower::new(channels, window, 1);
    let strongest = (0..n_samples)
        .step_by(window)
        .map(|k| power.from(k))
        .fold(0.0, f64::max);
    let mut rests = quiet(&power, 0..n_samples, window, REST * strongest);
    rests.retain(|rest| rest.len() as f64 > WINDOW * period);
    let wanted = period.floor() as usize;
    let stretched = |stretch: Range<usize>| {
        let missing = wanted.saturating_sub(stretch.len());
        let starts = stretch.start.saturating_sub(missing)
            ..=stretch.start.min(n_samples.checked_sub(wanted)?);
        let moves = |start: usize| power.from(start) + power.from(start + wanted - window);
        let best = starts.max_by(|&a, &b| moves(a).total_cmp(&moves(b)))?;
        (missing <= window).then_some(if missing == 0 {
            stretch
        } else {
            best..best + wanted
        })
    };
    gaps(&rests, n_samples)
        .into_iter()
        .filter_map(stretched)
        .collect()
}
