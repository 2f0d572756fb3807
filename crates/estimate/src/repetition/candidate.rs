//! Candidate for a period: the runs it explains, and how well it holds over many periods.

use std::ops::Range;

use crate::correlation::autocorrelation::SHORTEST;
use crate::correlation::channel::Channel;
use crate::correlation::long_lags::Pairs;
use crate::repetition::n_periods;
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
        let longest = Channel::n_samples(channels) as f64;
        if !(SHORTEST as f64..=longest).contains(&period) {
            return None;
        }
        let runs = Runs::find(channels, period, stride(channels, period));
        let runs = Some(runs).filter(Runs::is_sound)?;
        Self::refined(channels, runs)
    }

    /// Unless the signal does not repeat over many periods, or is not long enough for two.
    pub(super) fn refined(channels: &[Channel], runs: Runs) -> Option<Self> {
        let stride = stride(channels, runs.period);
        let runs = runs_without_slips(channels, runs, stride);
        let found = Self::rated(channels, runs, stride);
        let is_long = n_periods(Channel::n_samples(channels), found.runs.period) > 1;
        let is_lost = found.residual > LONG_LIMIT || found.runs.runs.is_empty() || !is_long;
        Some(found).filter(|found| !is_lost && found.runs.is_sound())
    }

    /// With the period to a fraction of a sample, and what does not repeat over many.
    fn rated(channels: &[Channel], runs: Runs, stride: usize) -> Self {
        let inner = inner(&runs.runs, runs.period);
        let pairs = Pairs {
            channels,
            runs: &inner,
            stride,
        };
        let period = pairs.refine(runs.period);
        let (residual, last_lag) = pairs.worst(period, f64::INFINITY);
        let runs = Runs { period, ..runs };
        Self {
            runs,
            residual,
            last_lag,
        }
    }

    /// The same runs with another period.
    pub(super) fn with_period(&self, period: f64) -> Self {
        Self {
            runs: Runs {
                period,
                ..self.runs.clone()
            },
            ..*self
        }
    }

    /// Whether another period explains as much of the same runs.
    pub(super) fn is_matched(&self, channels: &[Channel], period: f64) -> bool {
        let pairs = Pairs {
            channels,
            runs: &inner(&self.runs.runs, self.runs.period),
            stride: stride(channels, period),
        };
        let (residual, _) = pairs.worst(period, self.last_lag + 0.5);
        residual <= 2.0 * self.residual + inexact(period)
    }
}

/// The runs without their ends, whose place noise may hide: an eighth of a period each.
fn inner(runs: &[Range<usize>], period: f64) -> Vec<Range<usize>> {
    let edge = (EDGE * period) as usize;
    let inner = runs.iter().map(|run| run.start + edge..run.end - edge);
    inner.collect()
}

/// Power that is lost although the period is right.
fn inexact(period: f64) -> f64 {
    if period == period.round() {
        ROUNDING
    } else {
        BETWEEN_SAMPLES
    }
}

/// The runs cut where they slip, with the lag of most of them as the period.
fn runs_without_slips(channels: &[Channel], runs: Runs, stride: usize) -> Runs {
    let rough = rough_lag(channels, &runs, stride);
    let (period, parts) = without_slips(channels, &runs.runs, rough, stride);
    let covered = n_present(channels, &parts, stride);
    Runs {
        period,
        runs: parts,
        covered,
        left_out: runs.left_out + runs.covered.saturating_sub(covered),
        ..runs
    }
}

fn rough_lag(channels: &[Channel], runs: &Runs, stride: usize) -> f64 {
    let pairs = Pairs {
        channels,
        runs: &inner(&runs.runs, runs.period),
        stride,
    };
    pairs.local_lag(runs.period.round() as usize).lag
}

/// Places are that far apart.
pub(super) fn stride(channels: &[Channel], period: f64) -> usize {
    let most = period as usize / PLACES_PER_PERIOD;
    (Channel::n_samples(channels) / PLACES).min(most).max(1)
}
