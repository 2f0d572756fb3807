//! Stuck time of an axis, and whether its readings can tell it: readings that repeat, unless the
//! encoder makes them repeat or noise keeps them from it.

#[cfg(test)]
mod tests;

use std::iter::{self, zip};
use std::ops::Range;

use frfid_signals::Record;
use frfid_signals::power::rms;
use ndarray::{Array2, ArrayView1, ArrayViewMut1};

/// Share of the samples that may be in doubt: a tenth of what is warned of.
const NEGLIGIBLE: f64 = 0.02;
/// ... or this part of all that repeat.
const SMALL_PART: f64 = 1.0 / 3.0;
/// Changes of a reading on either side of a stretch without one that tell how fast the axis moves.
const BESIDE: usize = 3;
/// An axis that moves at a constant acceleration a, and turns back, repeats its reading of step s for
/// up to 2 sqrt(2 s/a), six times what it then takes for each step of the next three. Beyond eight
/// times it stands.
const TURNS_BACK: f64 = 8.0;
/// ... if the three changes lead away by so many steps: a reading that flickers, or a vibration
/// within a step, leads nowhere.
const FEWEST_STEPS: f64 = 2.0;
/// Share of samples close to standstill up to which an axis is said to stick for 0.0 % of the time.
const HIDDEN: f64 = 0.005;
/// Where noise is to be seen, velocities below so many of its standard deviations are close to
/// standstill ...
const DEVIATIONS: f64 = 8.0;
/// ... and those below this part of the rms in any case: a filter leaves them after a stop ...
const SMALL: f64 = 1e-3;
/// ... if this many of them come in a row. A motion that turns back passes by faster.
const IN_A_ROW: usize = 3;
/// Samples from which step and noise are taken.
const SAMPLED: usize = 4096;

/// Samples in which the position reading does not change, or the velocity reading is at most
/// `still_rad_s`, `(axis, sample)`.
pub(crate) fn stuck_samples(record: &Record, still_rad_s: f64) -> Array2<bool> {
    let mut stuck = record.y.mapv(|y| y.abs() <= still_rad_s);
    let positions = record.position_rad.iter().flat_map(|q| q.rows());
    for (stuck, position) in zip(stuck.rows_mut(), positions) {
        add_repeated(stuck, position);
    }
    stuck
}

/// Adds the samples in which a reading is that of the sample before.
fn add_repeated(mut stuck: ArrayViewMut1<bool>, reading: ArrayView1<f64>) {
    for k in 1..reading.len() {
        stuck[k] |= reading[k] == reading[k - 1];
    }
}

/// Share of the samples in which a velocity reading is exactly zero; `None` where noise, or a
/// resolution too coarse for the motion, hides whether the axis stands.
#[must_use]
pub fn standing_share(velocity_rad_s: ArrayView1<f64>) -> Option<f64> {
    Readings::new(velocity_rad_s, None).stuck_share(0..velocity_rad_s.len())
}

/// What the sensors of an axis say about its motion in each sample.
pub(super) struct Readings {
    velocity: Reading,
    position: Option<Reading>,
}

impl Readings {
    /// Of an axis of a record that is sound.
    pub(super) fn of(record: &Record, axis: usize) -> Self {
        let position_rad = record.position_rad.as_ref();
        let position_rad = position_rad.map(|position_rad| position_rad.row(axis));
        Self::new(record.y.row(axis), position_rad)
    }

    fn new(velocity_rad_s: ArrayView1<f64>, position_rad: Option<ArrayView1<f64>>) -> Self {
        Self {
            velocity: Reading::new(velocity_rad_s.to_vec()),
            position: position_rad.map(Reading::of_position),
        }
    }

    /// Share of samples in which a reading repeats that tells of sticking; 0 if none does and the
    /// velocity is clearly away from standstill; `None` where that cannot be known.
    pub(super) fn stuck_share(&self, samples: Range<usize>) -> Option<f64> {
        let velocity = self.velocity.within(&samples);
        let position = self.position.as_ref().map(|q| q.within(&samples));
        let all: Vec<Part> = iter::once(velocity).chain(position).collect();
        let telling: Vec<&Part> = all.iter().filter(|part| part.tells()).collect();
        if telling.is_empty() {
            return never_stands(&all).then_some(0.0);
        }
        let is_stuck = |&k: &usize| telling.iter().any(|part| part.repeats(k));
        let stuck = (0..samples.len()).filter(is_stuck).count();
        Some(stuck as f64 / samples.len() as f64)
    }
}

/// What one sensor says in a sample.
#[derive(Clone, Copy, PartialEq)]
enum Stand {
    /// The reading changes.
    Moves,
    /// It repeats, as that of a slow motion may.
    Repeats,
    /// It repeats for longer than its step explains.
    Stands,
}

impl Stand {
    fn repeats(self) -> bool {
        self != Self::Moves
    }
}

/// What one sensor says in each sample.
struct Reading {
    /// How far the axis moved, in any unit; NaN where that is not known.
    change: Vec<f64>,
    stands: Vec<Stand>,
}

impl Reading {
    fn new(change: Vec<f64>) -> Self {
        let stands = stands(&change);
        Self { change, stands }
    }

    /// Of a position: nothing is known of the motion before the first sample.
    fn of_position(q: ArrayView1<f64>) -> Self {
        let ways = zip(q.iter().skip(1), q).map(|(q, before)| q - before);
        Self::new(iter::once(f64::NAN).chain(ways).collect())
    }

    fn within(&self, samples: &Range<usize>) -> Part<'_> {
        Part {
            change: self.change.get(samples.clone()).unwrap_or_default(),
            stands: self.stands.get(samples.clone()).unwrap_or_default(),
        }
    }
}

/// A part of a reading.
#[derive(Clone, Copy)]
struct Part<'a> {
    change: &'a [f64],
    stands: &'a [Stand],
}

impl Part<'_> {
    /// Whether the samples that repeat do so because the axis stands, and no others are hidden.
    fn tells(&self) -> bool {
        let repeating = self.share(Stand::repeats);
        let unexplained = self.share(|stand| stand == Stand::Repeats);
        let in_doubt = unexplained + close_to_standstill(self.change);
        repeating > 0.0 && in_doubt <= NEGLIGIBLE.max(SMALL_PART * repeating)
    }

    fn repeats(&self, k: usize) -> bool {
        self.stands.get(k).is_some_and(|stand| stand.repeats())
    }

    fn share(&self, counts: impl Fn(Stand) -> bool) -> f64 {
        let count = self.stands.iter().filter(|&&stand| counts(stand)).count();
        count as f64 / self.stands.len().max(1) as f64
    }
}

/// Whether an axis is clearly away from standstill all the time; its velocity is the first of the
/// readings.
fn never_stands(all: &[Part]) -> bool {
    let velocity = all[0].change;
    let repeats = |part: &Part| part.share(Stand::repeats) != 0.0;
    !velocity.is_empty() && !all.iter().any(repeats) && close_to_standstill(velocity) <= HIDDEN
}

/// A change of a reading.
#[derive(Clone, Copy)]
struct Change {
    sample: usize,
    by: f64,
}

/// What the changes of a reading say in each sample.
fn stands(change: &[f64]) -> Vec<Stand> {
    let mut stands = vec![Stand::Moves; change.len()];
    let step = step(change);
    let changes = changes(change);
    for place in 0..=changes.len() {
        let (before, after) = changes.split_at(place);
        let stretch = between(before, after, change.len());
        let stand = stand(before, after, stretch.len(), step);
        stands[stretch].fill(stand);
    }
    for (stand, _) in zip(&mut stands, change).filter(|(_, by)| by.is_nan()) {
        *stand = Stand::Moves;
    }
    stands
}

/// The changes of a reading.
fn changes(change: &[f64]) -> Vec<Change> {
    let all = change.iter().copied().enumerate();
    let changes = all.filter(|&(_, by)| by.abs() > 0.0);
    changes.map(|(sample, by)| Change { sample, by }).collect()
}

/// The samples of a reading that lie between two changes, or a change and an end.
fn between(before: &[Change], after: &[Change], n_samples: usize) -> Range<usize> {
    let from = before.last().map_or(0, |change| change.sample + 1);
    from..after.first().map_or(n_samples, |change| change.sample)
}

/// What `length` samples without a change between others say.
fn stand(before: &[Change], after: &[Change], length: usize, step: f64) -> Stand {
    let near = [
        &before[before.len().saturating_sub(BESIDE)..],
        &after[..after.len().min(BESIDE)],
    ];
    match stands_between(near, length, step) {
        true => Stand::Stands,
        false => Stand::Repeats,
    }
}

/// Whether `length` samples without a change between two groups of changes are more than a reading of
/// this `step` makes of a motion as fast as they show.
fn stands_between(near: [&[Change]; 2], length: usize, step: f64) -> bool {
    let is_longer = |changes: &&[Change]| is_longer(length, changes, step);
    step == 0.0 || step.is_finite() && near.iter().all(is_longer)
}

/// Whether `length` samples are more than a motion as fast as these changes takes for a `step`; none,
/// at an end of the record, show nothing.
fn is_longer(length: usize, changes: &[Change], step: f64) -> bool {
    let (Some(first), Some(last)) = (changes.first(), changes.last()) else {
        return true;
    };
    let way = changes.iter().map(|change| change.by).sum::<f64>().abs();
    let samples = (last.sample - first.sample + 1) as f64;
    let is_far = way > (FEWEST_STEPS - 0.5) * step;
    is_far && length as f64 * way > TURNS_BACK * samples * step
}

/// The smallest size of a change, if all are multiples of it; else 0. Infinite where nothing ever
/// changes: that may be for any step.
fn step(change: &[f64]) -> f64 {
    let smallest = sizes(change).fold(f64::INFINITY, f64::min);
    let mut sampled = sizes(change).step_by(change.len() / SAMPLED + 1);
    let in_steps = sampled.all(|size| is_multiple(size / smallest));
    if in_steps { smallest } else { 0.0 }
}

fn sizes(change: &[f64]) -> impl Iterator<Item = f64> {
    let sizes = change.iter().map(|by| by.abs());
    sizes.filter(|&size| size > 0.0)
}

fn is_multiple(ratio: f64) -> bool {
    (ratio - ratio.round()).abs() < 0.05
}

/// Share of the samples that are not still, but as close to it as noise and filters leave an axis
/// that stands.
fn close_to_standstill(velocity: &[f64]) -> f64 {
    let close = (DEVIATIONS * noise(velocity)).max(SMALL * rms(velocity));
    let is_slow = |y: &f64| y.abs() <= close;
    let stretches = velocity.chunk_by(|a, b| is_slow(a) == is_slow(b));
    let slow = stretches.filter(|stretch| stretch.len() >= IN_A_ROW && is_slow(&stretch[0]));
    let moving = slow.flatten().filter(|&&y| y != 0.0).count();
    moving as f64 / velocity.len().max(1) as f64
}

/// Standard deviation of the noise of a velocity, from the sixth difference, which a smooth motion
/// hardly has: of white noise sqrt(924) times the standard deviation, and in a tenth of the samples
/// below an eighth of that.
fn noise(velocity: &[f64]) -> f64 {
    let windows = velocity.windows(7).step_by(velocity.len() / SAMPLED + 1);
    let mut sizes: Vec<f64> = windows.map(|y| sixth_difference(y).abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let tenth = sizes.get(sizes.len() / 10).copied();
    tenth.unwrap_or(0.0) * 8.0 / 924.0_f64.sqrt()
}

fn sixth_difference(y: &[f64]) -> f64 {
    let weights = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
    zip(y, weights).map(|(y, weight)| y * weight).sum()
}
