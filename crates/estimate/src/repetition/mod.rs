//! Repetition in a recording that frfid did not make: its period, the runs in which it repeats, and
//! the rests around them.

mod aperiodic;
mod bridged;
mod candidate;
mod holes;
pub(crate) mod period;
mod period_search;
mod rests;
mod run_ends;
mod runs;
mod single_sweep;
mod slips;
mod two_states;

use std::ops::Range;

use frfid_signals::check_finite;
use ndarray::ArrayView2;

use crate::correlation::autocorrelation::SHORTEST;
use crate::correlation::channel::Channel;
use crate::correlation::long_lags::Pairs;
use crate::error::EstimateError;
use crate::repetition::aperiodic::{candidates, why};
use crate::repetition::bridged::bridged;
use crate::repetition::candidate::{Candidate, stride};
use crate::repetition::period_search::{Repeating, shortest_period};
use crate::repetition::rests::{find_rests, single_periods};
use crate::repetition::runs::{Runs, gaps};
use crate::repetition::slips::without_slips;

/// Share of a period that is lost when lengths are divided.
const ROUNDING: f64 = 1e-9;

/// What repeats in a recording, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Repetition {
    /// Period in samples, with a fraction where the recorder's clock is not the player's.
    pub period: f64,
    /// Stretches that repeat back to back, rising, each of two periods or longer (of one and longer
    /// where the period was given); rests and transitions are left out.
    pub runs: Vec<Range<usize>>,
    /// Stretches without excitation, rising, none in a run.
    pub rests: Vec<Range<usize>>,
    /// Share of the power in the runs that does not repeat.
    pub residual: f64,
}

impl Repetition {
    /// Whole periods in so many samples: a period of T holds the whole numbers in a stretch of
    /// length T, one more or one less where T has a fraction.
    #[must_use]
    pub fn n_periods(&self, n_samples: usize) -> usize {
        n_periods(n_samples, self.period)
    }
}

/// The most periods of which all samples but a fraction of one are there.
pub(super) fn n_periods(n_samples: usize, period: f64) -> usize {
    ((n_samples + 1) as f64 / period - ROUNDING).ceil().max(1.0) as usize - 1
}

/// Finds the shortest period, in samples, after which a reference `(channel, sample)` repeats, and
/// the runs in which it does; or the runs of a `period` that is given. NaN where samples are lost.
///
/// A run lasts as long as `(x[k + T] - x[k])^2` stays small against the power around, so that a
/// rest, a transition, another signal of the same period or lost rows end it; noise may be 10 dB
/// below the signal. Channels that do not repeat anywhere, since they are not excited, do not count.
///
/// # Errors
/// [`EstimateError::NotPeriodic`] with the reason; [`frfid_signals::SignalError`] for a reference without
/// channels or without a single sample, and for a period that is not finite and above zero.
pub fn find_repetition(
    reference: ArrayView2<f64>,
    period: Option<f64>,
) -> Result<Repetition, EstimateError> {
    if reference.is_empty() {
        let needed = "(channel, sample) with at least one of both".to_string();
        return Err(EstimateError::shape("reference", reference.shape(), needed));
    }
    if !reference.iter().any(|value| value.is_finite()) {
        check_finite("reference", reference)?;
    }
    let channels = Channel::moving(reference);
    match period {
        Some(period) => given(&channels, period),
        None => search(&channels),
    }
}

/// The shortest period of the channels that repeat.
fn search(channels: &[Channel]) -> Result<Repetition, EstimateError> {
    let repeating: Vec<Repeating> = channels.iter().filter_map(Repeating::new).collect();
    let found = shortest_period(repeating).and_then(|(channels, period)| found(&channels, period));
    let bridged = || {
        let mut periods = candidates(channels);
        periods.sort_unstable();
        let mut periods = periods.into_iter();
        periods.find_map(|period| bridged(channels, period as f64))
    };
    let found = found.or_else(bridged);
    found.ok_or_else(|| why(channels, None))
}

/// The runs of a period, sample by sample.
fn found(channels: &[Channel], period: f64) -> Option<Repetition> {
    let mut runs = Runs::find(channels, period, 1);
    let stride = stride(channels, period);
    runs.runs = without_slips(channels, &runs.runs, period, stride).1;
    let rests = find_rests(channels, &runs);
    let is_long = |run: &Range<usize>| n_periods(run.len(), period) > 1;
    let runs: Vec<Range<usize>> = runs.runs.into_iter().filter(is_long).collect();
    if runs.is_empty() {
        return None;
    }
    let pairs = Pairs {
        channels,
        runs: &runs,
        stride,
    };
    let residual = pairs.residual(period);
    Some(Repetition {
        period,
        runs,
        rests,
        residual,
    })
}

/// The runs of a period that somebody gave: where nothing repeats, one period is enough.
fn given(channels: &[Channel], period: f64) -> Result<Repetition, EstimateError> {
    let n_samples = Channel::n_samples(channels);
    if n_samples > 0 && !(SHORTEST as f64..=n_samples as f64).contains(&period) {
        let needed = "a number of samples from 4 to the length of the recording";
        return Err(EstimateError::parameter("period", period, needed));
    }
    let excited: Vec<Channel> = channels
        .iter()
        .filter_map(|channel| excited(channel, period))
        .collect();
    if let Some(candidate) = Candidate::new(&excited, period) {
        let found = found(&excited, candidate.runs.period);
        return found.ok_or_else(|| why(channels, Some(period)));
    }
    if let Some(found) = bridged(channels, period) {
        return Ok(found);
    }
    let runs = single_periods(channels, period);
    if runs.is_empty() || runs.iter().any(|run| run.len() as f64 >= 2.0 * period) {
        return Err(why(channels, Some(period)));
    }
    let rests = gaps(&runs, n_samples);
    Ok(Repetition {
        period,
        runs,
        rests,
        residual: 0.0,
    })
}

/// The channel, its runs at unit power, if it repeats with this period.
fn excited(channel: &Channel, period: f64) -> Option<Channel> {
    let alone = Candidate::new(std::slice::from_ref(channel), period)?;
    Some(channel.scaled(alone.runs.power.sqrt().recip()))
}
