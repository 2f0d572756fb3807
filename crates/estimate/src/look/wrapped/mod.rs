//! Wrapped signals: an angle that jumps by a turn where it leaves its range, and its unwrapping.

mod smoothness;
#[cfg(test)]
mod tests;

use std::f64::consts::{PI, TAU};

use frfid_signals::median;
use ndarray::{Array1, ArrayView1};

use crate::look::survey::Survey;
use crate::look::wrapped::smoothness::is_smooth;

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
    let jumps = Jumps::of(survey)?;
    let ends = Ends::of(&jumps)?;
    if !ends.are_of_turns(&jumps) || !ends.hold(survey) {
        return None;
    }
    let turn = jumps.usual(|k| turn_at(jumps.samples, k))?;
    let turn = usual_turn(turn, ends.reach);
    let numbers = unwrap(survey.numbers(), turn);
    is_smooth(&numbers, turn).then_some((turn, jumps.places.len()))
}

/// The jumps of a signal.
struct Jumps<'a> {
    samples: &'a [f64],
    /// Range of the signal.
    range: f64,
    /// Samples that come after a jump.
    places: Vec<usize>,
}

impl<'a> Jumps<'a> {
    /// `None` if there are none, or the signal moves too fast beside them.
    fn of(survey: &Survey<'a>) -> Option<Self> {
        let range = usual_range(survey)?;
        let places = jumps(survey.moving, range)?;
        Some(Self {
            samples: survey.moving,
            range,
            places,
        })
    }

    /// Those that are looked at closely.
    fn judged(&self) -> &[usize] {
        &self.places[..self.places.len().min(JUDGED)]
    }

    /// Median of something over the jumps.
    fn usual(&self, of: impl Fn(usize) -> f64) -> Option<f64> {
        median(self.judged().iter().map(|&k| of(k)).collect())
    }

    /// The farthest that the signal moves in a sample near the jump at `k`, large changes aside.
    fn reach(&self, k: usize) -> f64 {
        let near = k.saturating_sub(NEAR)..=k + NEAR;
        let sizes = near.map(|near| change(self.samples, near).abs());
        let usual = sizes.filter(|size| *size <= LARGE * self.range);
        usual.fold(0.0, f64::max)
    }
}

/// The ends of the range as the jumps show them.
struct Ends {
    low: f64,
    high: f64,
    /// How far the signal moves in a sample near them.
    reach: f64,
}

impl Ends {
    fn of(jumps: &Jumps) -> Option<Self> {
        Some(Self {
            low: jumps.usual(|k| ends(jumps.samples, k)[0])?,
            high: jumps.usual(|k| ends(jumps.samples, k)[1])?,
            reach: jumps.usual(|k| jumps.reach(k))?,
        })
    }

    /// Whether enough jumps lead from one end to the other.
    fn are_of_turns(&self, jumps: &Jumps) -> bool {
        let judged = jumps.judged();
        let turns = judged.iter().filter(|&&k| self.is_turn(jumps, k));
        turns.count() as f64 >= TURNS * judged.len() as f64
    }

    /// Whether the jump at `k` leads from one end to the other, out of a motion into a motion.
    fn is_turn(&self, jumps: &Jumps, k: usize) -> bool {
        let [low, high] = ends(jumps.samples, k);
        let away = (low - self.low).abs().max((high - self.high).abs());
        away <= FARTHER * jumps.reach(k).max(self.reach) && moves_around(jumps.samples, k)
    }

    /// Whether hardly a sample lies beyond them.
    fn hold(&self, survey: &Survey) -> bool {
        let room = FARTHER * self.reach;
        let is_beyond = |x: &f64| *x < self.low - room || *x > self.high + room;
        let n_beyond = survey.numbers().filter(is_beyond).count();
        n_beyond as f64 <= BEYOND * survey.moving.len() as f64
    }
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
        turns += whole_turns(x - before, turn);
        before = if x.is_finite() { x } else { before };
        if turns == 0.0 { x } else { x - turns * turn }
    };
    numbers.map(next).collect()
}

/// The whole turns in a change; 0 where that is not known.
fn whole_turns(change: f64, turn: f64) -> f64 {
    let turns = (change / turn).round();
    if turns.is_finite() { turns } else { 0.0 }
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
    let sorted = sorted_sample(survey);
    let outside = (OUTSIDE * sorted.len() as f64) as usize;
    let (low, high) = (sorted.get(outside)?, sorted.iter().rev().nth(outside)?);
    Some(high - low).filter(|&range| range > 0.0)
}

/// Some of the values, evenly over the signal, in rising order.
fn sorted_sample(survey: &Survey) -> Vec<f64> {
    let stride = survey.moving.len() / JUDGED + 1;
    let mut sampled: Vec<f64> = survey.numbers().step_by(stride).collect();
    sampled.sort_by(f64::total_cmp);
    sampled
}

/// The lower and the upper end of a jump.
fn ends(samples: &[f64], k: usize) -> [f64; 2] {
    let (before, x) = (samples[k - 1], samples[k]);
    [before.min(x), before.max(x)]
}

/// Places of the jumps; `None` if there are none, or the signal moves too fast beside them.
fn jumps(samples: &[f64], range: f64) -> Option<Vec<usize>> {
    let jumps: Vec<usize> = changes_above(samples, JUMP * range).collect();
    let n_large = changes_above(samples, LARGE * range).count() - jumps.len();
    let is_slow = PER_JUMP * jumps.len() <= samples.len()
        && n_large as f64 <= LARGE_PER_JUMP * jumps.len() as f64;
    let jumps = without_outliers(samples, &jumps);
    (is_slow && !jumps.is_empty()).then_some(jumps)
}

/// Places of the changes that are larger than `size`.
fn changes_above(samples: &[f64], size: f64) -> impl Iterator<Item = usize> {
    (1..samples.len()).filter(move |&k| change(samples, k).abs() > size)
}

/// Jumps that are not undone at once.
fn without_outliers(samples: &[f64], jumps: &[usize]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for &k in jumps {
        match kept.last() {
            Some(&before) if undoes(samples, k, before) => drop(kept.pop()),
            _ => kept.push(k),
        }
    }
    kept
}

/// Whether the jump at `k` leads back at once from where that at `before` led.
fn undoes(samples: &[f64], k: usize, before: usize) -> bool {
    k - before <= JUMP_BACK && change(samples, before) * change(samples, k) < 0.0
}

/// Whether the signal moves before and after the jump at `k`.
fn moves_around(samples: &[f64], k: usize) -> bool {
    let end = samples.len().min(k + MOVES_WITHIN);
    moves(&samples[k.saturating_sub(MOVES_WITHIN)..k]) && moves(&samples[k..end])
}

/// Whether any sample differs from the one before it.
fn moves(samples: &[f64]) -> bool {
    samples.windows(2).any(|pair| pair[0] != pair[1])
}

/// The turn of a jump: its size, and what the signal moves in its sample the other way, the mean of
/// the changes before and after.
fn turn_at(samples: &[f64], k: usize) -> f64 {
    let jump = change(samples, k);
    let moved = 0.5 * (change(samples, k - 1) + change(samples, k + 1));
    let is_motion = moved.is_finite() && moved.abs() <= LARGE * jump.abs();
    (if is_motion { jump - moved } else { jump }).abs()
}

/// The usual turn within `tolerance` of that found.
fn usual_turn(found: f64, tolerance: f64) -> f64 {
    let away = |usual: f64| (usual - found).abs();
    usual_turns()
        .filter(|&usual| away(usual) <= tolerance)
        .min_by(|&a, &b| away(a).total_cmp(&away(b)))
        .unwrap_or(found)
}

/// Turns of angles in turns, rad, mrad, degrees, gon and hundredths of a degree, halves of them,
/// counts of an encoder.
fn usual_turns() -> impl Iterator<Item = f64> {
    let whole = [1.0, TAU, 1e3 * TAU, 360.0, 400.0, 3600.0, 36_000.0];
    let half = [PI, 1e3 * PI, 180.0, 200.0];
    let counts = (8..=32).map(|bits| 2.0_f64.powi(bits));
    let decimal = (3..=7).map(|digits| 10.0_f64.powi(digits));
    whole.into_iter().chain(half).chain(counts).chain(decimal)
}
