//! Candidate for a period: the runs it explains, and how well it holds over many periods.

use std::ops::Range;

use crate::correlation::autocorrelation::SHORTEST;
use crate::correlation::channel::Channel;
use crate::correlation::long_lags::Pairs;
use crate::repetition::runs::{Runs, n_present};
use crate::repetition::slips::without_slips;

/// Places that are looked at while periods are compared; more tell no more.
const PLACES: usize = 200_000;
/// Places in a period, at least, that are looked at.
const PLACES_PER_PERIOD: usize = 64;
/// Over many periods a machine drifts: so much may fail to repeat there (6 dB below the signal).
const LONG_LIMIT: f64 = 0.25;
/// Ends of runs are not compared, in periods.
const EDGE: f64 = 0.125;
/// Power that may fail to repeat without a better period being looked for: rounding, and what is lost
/// between samples where the period has a fraction.
const ROUNDING: f64 = 1e-12;
const BETWEEN_SAMPLES: f64 = 1e-4;

/// A period and what it explains.
pub(super) struct Candidate {
    pub(super) runs: Runs,
    /// Share that does not repeat, the largest over 1, 2, 4, ... periods.
    pub(super) residual: f64,
    /// The longest of these, in samples.
    last_lag: f64,
}

impl Candidate {
    /// Unless the period explains too little.
    pub(super) fn new(channels: &[Channel], period: f64) -> Option<Self> {
        let longest = channels.first()?.values().len() as f64;
        if !(SHORTEST as f64..=longest).contains(&period) {
            return None;
        }
        let runs = Runs::find(channels, period, stride(channels, period));
        if runs.is_sound() {
            Self::refined(channels, runs)
        } else {
            None
        }
    }

    /// Unless the signal does not repeat over many periods.
    pub(super) fn refined(channels: &[Channel], runs: Runs) -> Option<Self> {
        let stride = stride(channels, runs.period);
        let rough = Pairs {
            channels,
            runs: &inner(&runs.runs, runs.period),
            stride,
        };
        let rough = rough.local_lag(runs.period.round() as usize).lag;
        let (period, parts) = without_slips(channels, &runs.runs, rough, stride);
        let inner = inner(&parts, period);
        let pairs = Pairs {
            channels,
            runs: &inner,
            stride,
        };
        let period = pairs.refine(period);
        let (residual, last_lag) = pairs.worst(period, f64::INFINITY);
        if residual > LONG_LIMIT || parts.is_empty() {
            return None;
        }
        let covered = n_present(channels, &parts, stride);
        let left_out = runs.left_out + runs.covered.saturating_sub(covered);
        let runs = Runs {
            period,
            runs: parts,
            covered,
            left_out,
            ..runs
        };
        let found = Self {
            runs,
            residual,
            last_lag,
        };
        Some(found).filter(|found| found.runs.is_sound())
    }

    /// Whether another period explains as much of the same runs.
    pub(super) fn is_matched(&self, channels: &[Channel], period: f64) -> bool {
        let pairs = Pairs {
            channels,
            runs: &inner(&self.runs.runs, self.runs.period),
            stride: stride(channels, period),
        };
        let inexact = match period == period.round() {
            true => ROUNDING,
            false => BETWEEN_SAMPLES,
        };
        pairs.worst(period, self.last_lag + 0.5).0 <= 2.0 * self.residual + inexact
    }
}

/// The runs without their ends, whose place noise may hide: an eighth of a period each.
fn inner(runs: &[Range<usize>], period: f64) -> Vec<Range<usize>> {
    let edge = (EDGE * period) as usize;
    let inner = |run: &Range<usize>| run.start + edge..run.end - edge;
    runs.iter().map(inner).collect()
}

/// Places are that far apart.
pub(super) fn stride(channels: &[Channel], period: f64) -> usize {
    let n_samples = channels.first().map_or(0, |channel| channel.values().len());
    (n_samples / PLACES)
        .min(period as usize / PLACES_PER_PERIOD)
        .max(1)
}
