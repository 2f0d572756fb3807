//! Reasons why nothing repeats in a recording, as advice.

use std::slice::from_ref;

use crate::correlation::autocorrelation::{autocorrelation, peaks};
use crate::correlation::channel::Channel;
use crate::correlation::long_lags::Pairs;
use crate::error::EstimateError;
use crate::error::aperiodic::Aperiodic;
use crate::repetition::runs::{LIMIT, Runs};
use crate::repetition::single_sweep::is_single_sweep;

/// A repetition that covers less than this share of what moves is chance.
const CHANCE: f64 = 0.2;
/// Lags that are compared for the message, the highest peaks of the correlation.
const TRIED: usize = 12;

/// The refusal of `channels`, in which no period was found, or not the one that was `given`.
pub(super) fn why(channels: &[Channel], given: Option<f64>) -> EstimateError {
    let periods = match given {
        Some(period) => vec![period.round() as usize],
        None => candidates(channels),
    };
    let (period, residual) = least_residual(channels, &periods);
    EstimateError::NotPeriodic {
        period,
        residual,
        limit: LIMIT,
        cause: match given {
            Some(_) if residual <= LIMIT && !channels.is_empty() => Aperiodic::TooLittle,
            _ => cause(channels, given, &periods),
        },
    }
}

/// The period after which most repeats, and what does not.
fn least_residual(channels: &[Channel], periods: &[usize]) -> (usize, f64) {
    let rate = |&period: &usize| (period, residual(channels, period));
    let rated = periods.iter().map(rate);
    let best = rated.min_by(|a, b| a.1.total_cmp(&b.1));
    best.unwrap_or((0, 1.0))
}

fn cause(channels: &[Channel], given: Option<f64>, periods: &[usize]) -> Aperiodic {
    if channels.is_empty() {
        return Aperiodic::Silent;
    }
    if given.is_some() {
        return Aperiodic::OtherPeriod;
    }
    let mut signals = channels.iter().map(Channel::values);
    match signals.any(is_single_sweep) {
        true => Aperiodic::SingleSweep,
        false => most_partly(channels, periods),
    }
}

/// The most that repeats with any of the periods.
fn most_partly(channels: &[Channel], periods: &[usize]) -> Aperiodic {
    let found = periods
        .iter()
        .filter_map(|&period| partly(channels, period));
    let most = found.max_by_key(|found| found.0);
    most.map_or(Aperiodic::Nothing, |most| most.1)
}

/// The highest peaks of each channel's correlation.
pub(super) fn candidates(channels: &[Channel]) -> Vec<usize> {
    let of_channel = |channel| highest_peaks(&autocorrelation(channel));
    channels.iter().flat_map(of_channel).collect()
}

/// The highest peaks beyond the one at lag 0, the highest first.
fn highest_peaks(correlation: &[f64]) -> Vec<usize> {
    let left = correlation.iter().position(|&value| value < 0.5);
    let mut lags = peaks(correlation);
    lags.retain(|&lag| left.is_some_and(|left| lag >= left));
    lags.sort_by(|&a, &b| correlation[b].total_cmp(&correlation[a]));
    lags.truncate(TRIED);
    lags
}

/// Share of the power of the best channel that does not repeat, over the whole recording.
fn residual(channels: &[Channel], period: usize) -> f64 {
    let residual = |channel| channel_residual(channel, period);
    channels.iter().map(residual).fold(1.0, f64::min)
}

fn channel_residual(channel: &Channel, period: usize) -> f64 {
    let whole = 0..channel.values().len();
    let pairs = Pairs {
        channels: from_ref(channel),
        runs: &[whole],
        stride: 1,
    };
    pairs.residual(period as f64)
}

/// What repeats of the channel that repeats most, and how many samples that are.
fn partly(channels: &[Channel], period: usize) -> Option<(usize, Aperiodic)> {
    let runs = |channel| Runs::find(from_ref(channel), period as f64, 1);
    let runs = channels.iter().map(runs).max_by_key(|runs| runs.covered)?;
    let longest = runs.runs.iter().max_by_key(|run| run.len())?;
    let cause = Aperiodic::Partly {
        first: longest.start,
        end: longest.end,
        n_periods: (longest.len() as f64 / period as f64 + 1e-9) as usize,
    };
    (!is_chance(&runs)).then_some((runs.covered, cause))
}

fn is_chance(runs: &Runs) -> bool {
    (runs.covered as f64) < CHANCE * runs.left_out as f64 || runs.residual > LIMIT
}
