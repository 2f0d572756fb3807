//! Search for the shortest period that explains as much of a recording as any.

use std::iter::zip;

use crate::correlation::autocorrelation::{SHORTEST, autocorrelation, is_peak, peaks};
use crate::correlation::channel::Channel;
use crate::repetition::candidate::{Candidate, stride};
use crate::repetition::runs::Runs;

/// Periods that are refined, those after which the signal repeats best.
const REFINED: usize = 6;
/// Neighbours that are climbed over at most.
const CLIMB: usize = 64;
/// Parts of a period that are tried at most.
const TRIED: usize = 64;
/// A period that covers so much of what another one covers may be better: two runs may be alike by
/// chance.
const ENOUGH: f64 = 0.7;
/// A part of a period explains as much if it covers so much of the same.
const AS_MUCH: f64 = 0.95;
/// Correlation of a part of the period, relative to that of the period, from which on it is tried.
const WORTH_TRYING: f64 = 0.5;

/// A channel that repeats somewhere.
pub(super) struct Repeating {
    /// Its runs at unit power, so that units do not matter.
    channel: Channel,
    correlation: Vec<f64>,
    best: Candidate,
}

impl Repeating {
    /// The channel, unless it does not repeat: it may be quiet.
    pub(super) fn new(channel: &Channel) -> Option<Self> {
        let correlation = autocorrelation(channel);
        let best = best_of(std::slice::from_ref(channel), &correlation)?;
        Some(Self {
            channel: channel.scaled(best.runs.power.sqrt().recip()),
            correlation,
            best,
        })
    }
}

/// The channels that repeat, and the shortest period that all of them have.
pub(super) fn shortest_period(repeating: Vec<Repeating>) -> Option<(Vec<Channel>, f64)> {
    let (mut channels, mut sum, mut best) = (Vec::new(), Vec::new(), None);
    for one in repeating {
        sum.resize(one.correlation.len(), 0.0);
        zip(&mut sum, one.correlation).for_each(|(sum, value)| *sum += value);
        channels.push(one.channel);
        best = Some(one.best);
    }
    if channels.len() > 1 {
        best = best_of(&channels, &sum);
    }
    let period = shortest(&channels, best?, &sum).runs.period;
    Some((channels, period))
}

/// Of the periods that cover most, the one after which the signal repeats best.
fn best_of(channels: &[Channel], correlation: &[f64]) -> Option<Candidate> {
    let find = |period: f64| Runs::find(channels, period, stride(channels, period));
    let runs = |&lag: &usize| {
        let whole = find(lag as f64);
        match vertex(correlation, lag) {
            between if between != lag as f64 && !whole.is_sound() => find(between),
            _ => whole,
        }
    };
    let found = peaks(correlation);
    let mut runs: Vec<Runs> = found.iter().map(runs).filter(Runs::is_sound).collect();
    runs.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    let refined = runs
        .into_iter()
        .filter_map(|runs| Candidate::refined(channels, runs));
    let refined: Vec<Candidate> = refined.take(REFINED).collect();
    let most = refined
        .iter()
        .map(|candidate| candidate.runs.covered)
        .max()?;
    let enough = |candidate: &Candidate| candidate.runs.covered as f64 >= ENOUGH * most as f64;
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
    let (mut best, mut divisor, mut tried) = (best, 2, 0);
    while best.runs.period / divisor as f64 >= SHORTEST as f64 && tried < TRIED {
        let period = best.runs.period / divisor as f64;
        let is_worth = is_worth(correlation, period, best.runs.period);
        tried += usize::from(is_worth);
        match is_worth.then(|| part(channels, &best, period)).flatten() {
            Some(part) => best = part,
            None => divisor += 1 + divisor % 2,
        }
    }
    best
}

/// Whether the correlation has a peak at a part of the period that is not far below that of the period.
fn is_worth(correlation: &[f64], part: f64, period: f64) -> bool {
    let at = |lag: usize| correlation.get(lag).copied().unwrap_or(0.0);
    let near = (part as usize).saturating_sub(2).max(1)..part as usize + 4;
    let is_high = at(part.round() as usize) > WORTH_TRYING * at(period.round() as usize);
    is_high
        && near
            .into_iter()
            .any(|lag| lag < correlation.len() && is_peak(correlation, lag))
}

/// The part of a period, if it still explains as much.
fn part(channels: &[Channel], best: &Candidate, period: f64) -> Option<Candidate> {
    let part = Candidate::new(channels, period)?;
    let covers = part.runs.covered as f64 >= AS_MUCH * best.runs.covered as f64;
    (covers && best.is_matched(channels, part.runs.period)).then_some(part)
}
