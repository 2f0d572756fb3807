//! Reasons why nothing repeats in a recording, as advice.

use crate::correlation::autocorrelation::{autocorrelation, peaks};
use crate::correlation::channel::Channel;
use crate::correlation::long_lags::Pairs;
use crate::error::EstimateError;
use crate::error::aperiodic::Aperiodic;
use crate::repetition::runs::{LIMIT, Runs};
use crate::repetition::single_sweep::single_sweep;

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
    let rated = periods
        .iter()
        .map(|&period| (period, residual(channels, period)));
    let best = rated.min_by(|a, b| a.1.total_cmp(&b.1));
    let (period, residual) = best.unwrap_or((0, 1.0));
    let cause = cause(channels, given, &periods);
    EstimateError::NotPeriodic {
        period,
        residual,
        limit: LIMIT,
        cause,
    }
}

fn cause(channels: &[Channel], given: Option<f64>, periods: &[usize]) -> Aperiodic {
    if channels.is_empty() {
        return Aperiodic::Silent;
    }
    if given.is_some() {
        return Aperiodic::OtherPeriod;
    }
    let sweep = |channel: &Channel| single_sweep(channel.values());
    if let Some(sweep) = channels.iter().find_map(sweep) {
        return Aperiodic::SingleSweep(sweep);
    }
    let partly = periods
        .iter()
        .filter_map(|&period| partly(channels, period));
    let longest = partly.max_by_key(|(covered, _)| *covered);
    longest.map_or(Aperiodic::Nothing, |(_, cause)| cause)
}

/// The highest peaks of each channel's correlation.
fn candidates(channels: &[Channel]) -> Vec<usize> {
    let of_channel = |channel: &Channel| {
        let correlation = autocorrelation(channel);
        let left = correlation
            .iter()
            .position(|&value| value < 0.5)
            .unwrap_or(correlation.len());
        let mut lags = peaks(&correlation);
        lags.retain(|&lag| lag >= left);
        lags.sort_by(|&a, &b| correlation[b].total_cmp(&correlation[a]));
        lags.truncate(TRIED);
        lags
    };
    channels.iter().flat_map(of_channel).collect()
}

/// Share of the power of the best channel that does not repeat, over the whole recording.
fn residual(channels: &[Channel], period: usize) -> f64 {
    let share = |channel: &Channel| {
        let whole = 0..channel.values().len();
        let pairs = Pairs {
            channels: std::slice::from_ref(channel),
            runs: &[whole],
            stride: 1,
        };
        pairs.residual(period as f64)
    };
    channels.iter().map(share).fold(1.0, f64::min)
}

/// What repeats of the channel that repeats most, and how many samples that are.
fn partly(channels: &[Channel], period: usize) -> Option<(usize, Aperiodic)> {
    let runs = |channel: &Channel| Runs::find(std::slice::from_ref(channel), period as f64, 1);
    let runs = channels.iter().map(runs).max_by_key(|runs| runs.covered)?;
    let is_chance = (runs.covered as f64) < CHANCE * runs.left_out as f64 || runs.residual > LIMIT;
    let longest = runs
        .runs
        .iter()
        .max_by_key(|run| run.len())
        .filter(|_| !is_chance)?;
    let n_periods = (longest.len() as f64 / period as f64 + 1e-9) as usize;
    Some((
        runs.covered,
        Aperiodic::Partly {
            first: longest.start,
            end: longest.end,
            n_periods,
        },
    ))
}
