//! Wrapped signals: an angle that jumps by a turn where it leaves its range, and its unwrapping.

#[cfg(test)]
mod tests;

use std::f64::consts::{PI, TAU};

use frfid_signals::median;
use ndarray::{Array1, ArrayView1};

use crate::look::survey::Survey;

/// A jump is larger than this part of the range: a wrapped signal goes from one end to the other.
const JUMP: f64 = 0.5;
/// The other changes stay below this part of the range, or a turn could not be told from a motion
/// ...
const LARGE: f64 = 0.25;
/// ... except for some, for each jump: noise and oscillations near half the sampling frequency have
/// far more of them.
const LARGE_PER_JUMP: f64 = 0.5;
/// Fewest samples for each jump; with fewer to a turn the direction of turning is a guess.
const PER_JUMP: usize = 8;
/// Share of the jumps that must look like a turn; noise spoils one now and then.
const TURNS: f64 = 0.8;
/// Share of samples that may lie beyond the ends: outliers, and a start outside of the range.
const BEYOND: f64 = 0.01;
/// Neighbours of a jump that tell how far the signal moves within a sample.
const NEAR: usize = 3;
/// How much farther than its neighbours a signal may move in the sample of the jump.
const FARTHER: f64 = 1.5;
/// Samples on either side of a jump within which the signal must move: a message that is missing
/// (0 until the first one comes) leaves a signal that stands.
const MOVES_WITHIN: usize = 64;
/// A jump back within so many samples is an outlier.
const JUMP_BACK: usize = 2;
/// Median size of the unwrapped signal, about a straight line, over that of its changes: 0.7 for white noise,
/// more than 1.2 for what has most of its power below an eighth of the sampling frequency.
const SMOOTH: f64 = 1.2;
/// Smallest median size of the unwrapped signal about a straight line, in turns; below is rounding, and the
/// signal a sawtooth (or a shaft that turns evenly, which has no more to tell).
const MORE_THAN_A_LINE: f64 = 1e-6;
/// Jumps that are looked at closely, and samples from which the range is taken.
const JUDGED: usize = 4096;
/// The range leaves out this share of the samples at either end, for outliers.
const OUTSIDE: f64 = 0.005;

/// Turn and number of jumps of a signal that wraps.
///
/// A jump counts as a turn when it leads from one end of the range to the other but for what the
/// signal moves in a sample, and the signal moves before and after it; hardly a sample lies beyond
/// these ends, and what the turns leave is smooth, and no straight line.
pub(super) fn wrapped(survey: &Survey) -> Option<(f64, usize)> {
    let samples = survey.moving;
    let range = usual_range(survey)?;
    let jumps = jumps(samples, range)?;
    let judged = || jumps.iter().copied().take(JUDGED);
    let usual = |of: &dyn Fn(usize) -> f64| median(judged().map(of).collect());
    let reach_usual = usual(&|k| reach(samples, range, k))?;
    let low = usual(&|k| ends(samples, k)[0])?;
    let high = usual(&|k| ends(samples, k)[1])?;
    let is_turn = |&k: &usize| {
        let [low_here, high_here] = ends(samples, k);
        let away = (low_here - low).abs().max((high_here - high).abs());
        away <= FARTHER * reach(samples, range, k).max(reach_usual) && moves_around(samples, k)
    };
    let n_turns = judged().filter(is_turn).count();
    let room = FARTHER * reach_usual;
    let is_beyond = |x: &f64| *x < low - room || *x > high + room;
    let n_beyond = survey.numbers().filter(is_beyond).count();
    if (n_turns as f64) < TURNS * judged().count() as f64
        || n_beyond as f64 > BEYOND * samples.len() as f64
    {
        return None;
    }
    let turn = usual_turn(usual(&|k| turn_at(samples, k))?, reach_usual);
    let numbers = unwrap(survey.numbers(), turn);
    is_smooth(&numbers, turn).then_some((turn, jumps.len()))
}

/// The signal without its jumps by a `turn`: every sample becomes the one nearest to that before it
/// among those that differ by whole turns. Lost samples stay lost; a signal that moves by half a turn
/// or more while they last cannot be put right.
#[must_use]
pub fn unwrapped(signal: ArrayView1<f64>, turn: f64) -> Array1<f64> {
    let mut numbers = unwrap(signal.iter().copied(), turn).into_iter();
    Array1::from_shape_simple_fn(signal.len(), || numbers.next().unwrap_or(f64::NAN))
}

fn unwrap(numbers: impl Iterator<Item = f64>, turn: f64) -> Vec<f64> {
    let (mut before, mut turns) = (f64::NAN, 0.0);
    let next = |x: f64| {
        let passed = ((x - before) / turn).round();
        if passed.is_finite() {
            turns += passed;
        }
        if x.is_finite() {
            before = x;
        }
        if turns == 0.0 { x } else { x - turns * turn }
    };
    numbers.map(next).collect()
}

/// Change from the sample before the `k`-th; 0 where there is none.
fn change(samples: &[f64], k: usize) -> f64 {
    let (Some(before), Some(x)) = (samples.get(k.wrapping_sub(1)), samples.get(k)) else {
        return 0.0;
    };
    x - before
}

/// Largest less smallest value but for outliers; `None` of a signal that rests nearly all the time.
fn usual_range(survey: &Survey) -> Option<f64> {
    let stride = survey.moving.len() / JUDGED + 1;
    let mut sampled: Vec<f64> = survey.numbers().step_by(stride).collect();
    sampled.sort_by(f64::total_cmp);
    let outside = (OUTSIDE * sampled.len() as f64) as usize;
    let (low, high) = (sampled.get(outside)?, sampled.iter().rev().nth(outside)?);
    Some(high - low).filter(|&range| range > 0.0)
}

/// The lower and the upper end of a jump.
fn ends(samples: &[f64], k: usize) -> [f64; 2] {
    let (before, x) = (samples[k - 1], samples[k]);
    [before.min(x), before.max(x)]
}

/// Places of the jumps; `None` if there are none, or the signal moves too fast beside them.
fn jumps(samples: &[f64], range: f64) -> Option<Vec<usize>> {
    let (mut jumps, mut n_large) = (Vec::new(), 0);
    for (k, pair) in samples.windows(2).enumerate() {
        let size = (pair[1] - pair[0]).abs();
        if size > JUMP * range {
            jumps.push(k + 1);
        } else if size > LARGE * range {
            n_large += 1;
        }
    }
    let is_slow = PER_JUMP * jumps.len() <= samples.len()
        && f64::from(n_large) <= LARGE_PER_JUMP * jumps.len() as f64;
    let jumps = without_outliers(samples, &jumps);
    (is_slow && !jumps.is_empty()).then_some(jumps)
}

/// Jumps that are not undone at once.
fn without_outliers(samples: &[f64], jumps: &[usize]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(jumps.len());
    for &k in jumps {
        let is_back = |&before: &usize| {
            k - before <= JUMP_BACK && change(samples, before) * change(samples, k) < 0.0
        };
        if kept.last().is_some_and(is_back) {
            kept.pop();
        } else {
            kept.push(k);
        }
    }
    kept
}

/// The farthest that the signal moves in a sample near the jump at `k`, large changes aside.
fn reach(samples: &[f64], range: f64, k: usize) -> f64 {
    let near = (k.saturating_sub(NEAR)..=k + NEAR).map(|near| change(samples, near).abs());
    near.filter(|&size| size <= LARGE * range)
        .fold(0.0, f64::max)
}

/// Whether the signal moves before and after the jump at `k`.
fn moves_around(samples: &[f64], k: usize) -> bool {
    let before = &samples[k.saturating_sub(MOVES_WITHIN)..k];
    let after = &samples[k..samples.len().min(k + MOVES_WITHIN)];
    let moves = |side: &[f64]| side.windows(2).any(|pair| pair[0] != pair[1]);
    moves(before) && moves(after)
}

/// The turn of a jump: its size, and what the signal moves in its sample the other way, the mean of
/// the changes before and after.
fn turn_at(samples: &[f64], k: usize) -> f64 {
    let jump = change(samples, k);
    let moved = 0.5 * (change(samples, k - 1) + change(samples, k + 1));
    let is_near_a_jump = moved.abs() > LARGE * jump.abs();
    if moved.is_finite() && !is_near_a_jump {
        (jump - moved).abs()
    } else {
        jump.abs()
    }
}

/// The usual turn within `tolerance` of that found: of angles in turns, rad, mrad, degrees, gon and
/// hundredths of a degree, halves of them, counts of an encoder.
fn usual_turn(found: f64, tolerance: f64) -> f64 {
    let whole = [1.0, TAU, 1e3 * TAU, 360.0, 400.0, 3600.0, 36_000.0];
    let half = [PI, 1e3 * PI, 180.0, 200.0];
    let counts = (8..=32).map(|bits| 2.0_f64.powi(bits));
    let decimal = (3..=7).map(|digits| 10.0_f64.powi(digits));
    let all = whole.into_iter().chain(half).chain(counts).chain(decimal);
    all.filter(|usual| (usual - found).abs() <= tolerance)
        .min_by(|a, b| (a - found).abs().total_cmp(&(b - found).abs()))
        .unwrap_or(found)
}

/// Whether a signal is smooth about a straight line, and more than that line; outliers aside.
fn is_smooth(samples: &[f64], turn: f64) -> bool {
    let places = || (1..samples.len()).step_by(samples.len() / JUDGED + 1);
    let count = places().count() as f64;
    let mean = |of: &dyn Fn(usize) -> f64| places().map(of).sum::<f64>() / count;
    let (middle, offset) = (mean(&|k| k as f64), mean(&|k| samples[k]));
    let tilt = mean(&|k| (k as f64 - middle) * (samples[k] - offset));
    let slope = tilt / mean(&|k| (k as f64 - middle).powi(2));
    let usual = |of: &dyn Fn(usize) -> f64| median(places().map(|k| of(k).abs()).collect());
    let size = usual(&|k| samples[k] - offset - slope * (k as f64 - middle));
    let of_changes = usual(&|k| samples[k] - samples[k - 1] - slope);
    let sizes = size.zip(of_changes);
    sizes.is_some_and(|(size, of_changes)| {
        size > MORE_THAN_A_LINE * turn && size >= SMOOTH * of_changes
    })
}
