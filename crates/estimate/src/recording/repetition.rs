//! Repetition in a recording that frfid did not make: its period, the runs in which it repeats, and
//! the rests around them.

use std::iter::zip;
use std::ops::Range;

use frfid_signals::check_finite;
use ndarray::ArrayView2;

use crate::error::EstimateError;
use crate::recording::aperiodic::why;
use crate::recording::autocorrelation::{SHORTEST, autocorrelation, peaks};
use crate::recording::channel::Channel;
use crate::recording::long_lags::Pairs;
use crate::recording::rests::{find_rests, single_periods};
use crate::recording::runs::{Runs, gaps, n_present};
use crate::recording::slips::without_slips;

/// Places that are looked at while periods are compared; more tell no more.
const PLACES: usize = 200_000;
/// Places in a period, at least, that are looked at.
const PLACES_PER_PERIOD: usize = 64;
/// Over many periods a machine drifts: so much may fail to repeat there (6 dB below the signal).
const LONG_LIMIT: f64 = 0.25;
/// Periods that are refined, those after which the signal repeats best.
const REFINED: usize = 6;
/// Neighbours that are climbed over at most.
const CLIMB: usize = 64;
/// Ends of runs are not compared, in periods.
const EDGE: f64 = 0.125;
/// A period that covers so much of what the best one covers is as good.
const AS_MUCH: f64 = 0.95;
/// Correlation of a part of the period, relative to that of the period, from which on it is tried.
const WORTH_TRYING: f64 = 0.5;
/// Power that may fail to repeat without a better period being looked for: rounding, and what is lost
/// between samples where the period has a fraction.
const ROUNDING: f64 = 1e-12;
const BETWEEN_SAMPLES: f64 = 1e-4;

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
    let mut excited: Vec<Channel> = Vec::new();
    let mut sum: Vec<f64> = Vec::new();
    let mut best = None;
    for channel in channels {
        let correlation = autocorrelation(channel);
        if let Some(alone) = best_of(std::slice::from_ref(channel), &correlation) {
            excited.push(channel.scaled(alone.runs.power.sqrt().recip()));
            sum.resize(correlation.len(), 0.0);
            zip(&mut sum, correlation).for_each(|(sum, value)| *sum += value);
            best = Some(alone);
        }
    }
    if excited.len() > 1 {
        best = best_of(&excited, &sum);
    }
    let Some(best) = best else {
        return Err(why(channels, None));
    };
    let best = shortest(&excited, best, &sum);
    found(&excited, best.runs.period).ok_or_else(|| why(channels, None))
}

/// A period and what it explains.
struct Candidate {
    runs: Runs,
    /// Share that does not repeat, the largest over 1, 2, 4, ... periods.
    residual: f64,
}

impl Candidate {
    fn new(channels: &[Channel], period: f64) -> Option<Self> {
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
    fn refined(channels: &[Channel], runs: Runs) -> Option<Self> {
        let stride = stride(channels, runs.period);
        let (period, parts) = without_slips(channels, &runs.runs, runs.period, stride);
        let inner = inner(&parts, period);
        let pairs = Pairs {
            channels,
            runs: &inner,
            stride,
        };
        let period = pairs.refine(period);
        let residual = pairs.worst(period);
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
        Some(Self { runs, residual }).filter(|found| found.runs.is_sound())
    }

    /// Residual below which another period explains as much.
    fn as_good(&self, period: f64) -> f64 {
        let inexact = if period == period.round() {
            ROUNDING
        } else {
            BETWEEN_SAMPLES
        };
        2.0 * self.residual + inexact
    }
}

/// The runs without their ends, whose place noise may hide: an eighth of a period each.
fn inner(runs: &[Range<usize>], period: f64) -> Vec<Range<usize>> {
    let edge = (EDGE * period) as usize;
    let inner = |run: &Range<usize>| run.start + edge..run.end - edge;
    runs.iter().map(inner).collect()
}

/// Places are that far apart.
fn stride(channels: &[Channel], period: f64) -> usize {
    let n_samples = channels.first().map_or(0, |channel| channel.values().len());
    (n_samples / PLACES)
        .min(period as usize / PLACES_PER_PERIOD)
        .max(1)
}

/// Of the periods that cover most, the one after which the signal repeats best.
fn best_of(channels: &[Channel], correlation: &[f64]) -> Option<Candidate> {
    let runs = |&lag: &usize| {
        let period = vertex(correlation, lag);
        Runs::find(channels, period, stride(channels, period))
    };
    let mut runs: Vec<Runs> = peaks(correlation)
        .iter()
        .map(runs)
        .filter(Runs::is_sound)
        .collect();
    runs.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    let refined = runs
        .into_iter()
        .filter_map(|runs| Candidate::refined(channels, runs));
    let refined: Vec<Candidate> = refined.take(REFINED).collect();
    let most = refined
        .iter()
        .map(|candidate| candidate.runs.covered)
        .max()?;
    let enough = |candidate: &Candidate| candidate.runs.covered as f64 >= AS_MUCH * most as f64;
    let best = refined
        .into_iter()
        .filter(enough)
        .min_by(|a, b| a.residual.total_cmp(&b.residual))?;
    Some(climbed(channels, best, correlation))
}

/// The best of the neighbours: the peaks of a narrow band lie one cycle apart and hardly differ.
fn climbed(channels: &[Channel], best: Candidate, correlation: &[f64]) -> Candidate {
    let at = |lag: usize| correlation.get(lag).copied().unwrap_or(0.0);
    let like_best = 0.8 * at(best.runs.period.round() as usize);
    let highest = peaks(correlation)
        .into_iter()
        .find(|&lag| at(lag) > like_best);
    let Some(cycle) = highest.filter(|&lag| 4.0 * lag as f64 <= best.runs.period) else {
        return best;
    };
    let cycle = vertex(correlation, cycle);
    let mut best = best;
    for step in [cycle, -cycle] {
        for _ in 0..CLIMB {
            let next = Candidate::new(channels, best.runs.period + step);
            let Some(next) = next.filter(|next| next.residual < best.residual) else {
                break;
            };
            best = next;
        }
    }
    best
}

/// Top of the parabola through a peak.
fn vertex(correlation: &[f64], lag: usize) -> f64 {
    let Some(&right) = correlation.get(lag + 1) else {
        return lag as f64;
    };
    let (left, middle) = (correlation[lag - 1], correlation[lag]);
    let bend = left - 2.0 * middle + right;
    let offset = if bend < 0.0 {
        0.5 * (left - right) / bend
    } else {
        0.0
    };
    if offset.abs() < 0.1 {
        lag as f64
    } else {
        lag as f64 + offset
    }
}

/// Divides a period by primes as long as what is left explains as much.
fn shortest(channels: &[Channel], best: Candidate, correlation: &[f64]) -> Candidate {
    let mut best = best;
    // small lags look alike for any smooth signal
    let is_left = |&value: &f64| value < 0.5 * correlation[0];
    let left = correlation
        .iter()
        .position(is_left)
        .unwrap_or(correlation.len());
    let least = left.max(SHORTEST) as f64;
    let mut divisor = 2;
    while best.runs.period / divisor as f64 >= least {
        match part(channels, &best, divisor, correlation) {
            Some(part) => best = part,
            None => divisor += 1 + divisor % 2,
        }
    }
    best
}

/// The period divided, if it still explains as much.
fn part(
    channels: &[Channel],
    best: &Candidate,
    divisor: usize,
    correlation: &[f64],
) -> Option<Candidate> {
    let at = |period: f64| {
        correlation
            .get(period.round() as usize)
            .copied()
            .unwrap_or(0.0)
    };
    let period = best.runs.period / divisor as f64;
    if at(period) < WORTH_TRYING * at(best.runs.period) {
        return None;
    }
    let part = Candidate::new(channels, period)?;
    let covers = part.runs.covered as f64 >= AS_MUCH * best.runs.covered as f64;
    let pairs = Pairs {
        channels,
        runs: &inner(&best.runs.runs, best.runs.period),
        stride: stride(channels, period),
    };
    let is_as_good = pairs.worst(part.runs.period) <= best.as_good(part.runs.period);
    (covers && is_as_good).then_some(part)
}

/// The runs of a period, sample by sample.
fn found(channels: &[Channel], period: f64) -> Option<Repetition> {
    let mut runs = Runs::find(channels, period, 1);
    let stride = stride(channels, period);
    runs.runs = without_slips(channels, &runs.runs, period, stride).1;
    let rests = find_rests(channels, &runs);
    let runs = Some(runs.runs).filter(|runs| !runs.is_empty())?;
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
    let n_samples = channels.first().map_or(0, |channel| channel.values().len());
    if !(SHORTEST as f64..=n_samples as f64).contains(&period) {
        let needed = "a number of samples from 4 to the length of the recording";
        return Err(EstimateError::parameter("period", period, needed));
    }
    let runs = |channels: &[Channel]| Runs::find(channels, period, stride(channels, period));
    let repeats = |channel: &&Channel| runs(std::slice::from_ref(*channel)).is_sound();
    let excited: Vec<Channel> = channels.iter().filter(repeats).cloned().collect();
    let sound = Some(runs(&excited)).filter(Runs::is_sound);
    if let Some(candidate) = sound.and_then(|runs| Candidate::refined(&excited, runs)) {
        let found = found(&excited, candidate.runs.period);
        return found.ok_or_else(|| why(channels, Some(period)));
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
