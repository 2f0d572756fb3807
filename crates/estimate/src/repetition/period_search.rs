//! Search for the shortest period that explains as much of a recording as any.

use std::iter::zip;
use std::slice::from_ref;

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
        let best = best_of(from_ref(channel), &correlation)?;
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
    let mut refined = refined(channels, sound_runs(channels, correlation));
    let covered = refined.iter().map(|candidate| candidate.runs.covered);
    let enough = ENOUGH * covered.max()? as f64;
    refined.retain(|candidate| candidate.runs.covered as f64 >= enough);
    let best = refined
        .into_iter()
        .min_by(|a, b| a.residual.total_cmp(&b.residual))?;
    Some(climbed(channels, best, correlation))
}

/// The first of the runs that repeat over many periods.
fn refined(channels: &[Channel], runs: Vec<Runs>) -> Vec<Candidate> {
    let refine = |runs| Candidate::refined(channels, runs);
    let refined = runs.into_iter().filter_map(refine);
    refined.take(REFINED).collect()
}

/// Runs with the periods at the peaks, those that repeat best first.
fn sound_runs(channels: &[Channel], correlation: &[f64]) -> Vec<Runs> {
    let peaks = peaks(correlation).into_iter();
    let runs = peaks.map(|lag| runs_at(channels, correlation, lag));
    let mut runs: Vec<Runs> = runs.filter(Runs::is_sound).collect();
    runs.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    runs
}

/// Runs with the period of a peak, between samples if they are not sound with the whole one.
fn runs_at(channels: &[Channel], correlation: &[f64], lag: usize) -> Runs {
    let find = |period: f64| Runs::find(channels, period, stride(channels, period));
    let (whole, between) = (find(lag as f64), vertex(correlation, lag));
    if between != lag as f64 && !whole.is_sound() {
        find(between)
    } else {
        whole
    }
}

/// The best of the neighbours: the peaks of a narrow band lie one cycle apart and hardly differ.
fn climbed(channels: &[Channel], best: Candidate, correlation: &[f64]) -> Candidate {
    let Some(cycle) = cycle(correlation, best.runs.period) else {
        return best;
    };
    let up = climbed_by(channels, best, cycle);
    climbed_by(channels, up, -cycle)
}

/// The first lag at which the correlation is nearly that of the period, if it is far shorter.
fn cycle(correlation: &[f64], period: f64) -> Option<f64> {
    let like_best = 0.8 * at(correlation, period);
    let mut peaks = peaks(correlation).into_iter();
    let cycle = peaks.find(|&lag| at(correlation, lag as f64) > like_best)?;
    (4.0 * cycle as f64 <= period).then(|| vertex(correlation, cycle))
}

/// The last of the neighbours in one direction of which each is better than the one before.
fn climbed_by(channels: &[Channel], mut best: Candidate, step: f64) -> Candidate {
    for _ in 0..CLIMB {
        let next = Candidate::new(channels, best.runs.period + step);
        match next.filter(|next| next.residual < best.residual) {
            Some(next) => best = next,
            None => break,
        }
    }
    best
}

/// Top of the parabola through a peak.
fn vertex(correlation: &[f64], lag: usize) -> f64 {
    let Some([left, middle, right]) = correlation.get(lag - 1..lag + 2) else {
        return lag as f64;
    };
    let offset = vertex_offset(*left, *middle, *right);
    if offset.abs() < 0.1 {
        lag as f64
    } else {
        lag as f64 + offset
    }
}

/// Top of the parabola through three values, from the one in the middle: rounding bends a flat one.
fn vertex_offset(left: f64, middle: f64, right: f64) -> f64 {
    let bend = left - 2.0 * middle + right;
    if bend < 0.0 {
        (0.5 * (left - right) / bend).clamp(-1.0, 1.0)
    } else {
        0.0
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
    let least = WORTH_TRYING * at(correlation, period);
    at(correlation, part) > least && has_peak_near(correlation, part as usize)
}

/// The correlation at the nearest lag.
fn at(correlation: &[f64], lag: f64) -> f64 {
    let value = correlation.get(lag.round() as usize);
    value.copied().unwrap_or(0.0)
}

/// A peak lies before the period where it is wide, since the sum has fewer terms for a later lag: by up
/// to `T / (4 pi^2 n)` for a sinusoid of n periods.
fn has_peak_near(correlation: &[f64], lag: usize) -> bool {
    let end = (lag + 4).min(correlation.len());
    let mut near = lag.saturating_sub(2 + lag / 64).max(1)..end;
    near.any(|lag| is_peak(correlation, lag))
}

/// The part of a period, if it still explains as much: in runs of its own, or, where these are too
/// short for the noise, in those of the period.
fn part(channels: &[Channel], best: &Candidate, period: f64) -> Option<Candidate> {
    let own = Candidate::new(channels, period)
        .filter(|part| part.runs.covered as f64 >= AS_MUCH * best.runs.covered as f64);
    let part = own.unwrap_or_else(|| best.with_period(period));
    best.is_matched(channels, part.runs.period).then_some(part)
}
