//! Stuck time of an axis, and whether its readings can tell it: readings that repeat, unless the
//! encoder makes them repeat or noise keeps them from it.

#[cfg(test)]
mod tests;

use std::iter::{self, zip};
use std::ops::Range;

use frfid_signals::Record;
use frfid_signals::power::rms;
use ndarray::{Array2, ArrayView1};

/// Share of the samples that an encoder may make repeat without a word: a tenth of what is warned
/// of.
const NEGLIGIBLE: f64 = 0.02;
/// Where the encoder makes more of them repeat, this many times as many must do so before the axis
/// is known to stick.
const BEYOND_THE_ENCODER: f64 = 3.0;
/// A motion of mean size m in a sample repeats a reading of step s for about s/(2 m) of the time:
/// s/(5 m) in a sine, s/(3 m) in Gaussian noise, more where its size varies.
const REPEATS: f64 = 0.5;
/// Parts of a run in which the size of the motion is taken; a chirp changes it by a tenth from one
/// to the next ...
const PARTS: usize = 32;
/// ... but none shorter than this, so that an axis moves and rests within a part.
const SHORTEST_PART: usize = 256;
/// How much smaller than usual a free motion may be in a part: torque of one size moves an axis at
/// velocities as 1 to 1/f, and through resonances. What is stiller than that stands.
const SMALLEST_MOTION: f64 = 1e-3;
/// Changes of up to so many steps in a reading are those of one that flickers while it stands.
const FLICKER: f64 = 2.5;
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
    let Some(position_rad) = &record.position_rad else {
        return stuck;
    };
    for (mut stuck, position) in zip(stuck.rows_mut(), position_rad.rows()) {
        for k in 1..position.len() {
            stuck[k] |= position[k] == position[k - 1];
        }
    }
    stuck
}

/// Share of the samples in which a velocity reading is exactly zero; `None` where noise, or a
/// resolution too coarse for the motion, hides whether the axis stands.
#[must_use]
pub fn standing_share(velocity_rad_s: ArrayView1<f64>) -> Option<f64> {
    Readings::new(velocity_rad_s, None).stuck_share(0..velocity_rad_s.len())
}

/// What the sensors of an axis say about its motion in each sample.
pub(super) struct Readings<'a> {
    velocity_rad_s: ArrayView1<'a, f64>,
    velocity: Reading,
    position: Option<Reading>,
}

impl<'a> Readings<'a> {
    /// Of an axis of a record that is sound.
    pub(super) fn of(record: &'a Record, axis: usize) -> Self {
        let position_rad = record.position_rad.as_ref();
        let position_rad = position_rad.map(|position_rad| position_rad.row(axis));
        Self::new(record.y.row(axis), position_rad)
    }

    fn new(velocity_rad_s: ArrayView1<'a, f64>, position_rad: Option<ArrayView1<f64>>) -> Self {
        let way = |q: ArrayView1<f64>| {
            let ways = zip(q.iter().skip(1), q).map(|(q, before)| (q - before).abs());
            // nothing is known of the motion before the first sample
            Reading::new(iter::once(f64::NAN).chain(ways).collect())
        };
        Self {
            velocity_rad_s,
            velocity: Reading::new(velocity_rad_s.iter().map(|y| y.abs()).collect()),
            position: position_rad.map(way),
        }
    }

    /// Share of samples in which a reading repeats that tells of sticking; 0 if none does and the
    /// velocity is clearly away from standstill; `None` where that cannot be known.
    pub(super) fn stuck_share(&self, samples: Range<usize>) -> Option<f64> {
        let velocity = self.velocity.within(&samples);
        let position = self.position.as_ref().map(|q| q.within(&samples));
        let position_tells = position.is_some_and(Motion::tells);
        let hidden = close_to_standstill(&self.velocity_within(&samples));
        let velocity_tells = velocity.tells()
            && (position_tells || hidden <= HIDDEN.max(0.1 * velocity.still_share()));
        let telling = [
            position.filter(|_| position_tells),
            Some(velocity).filter(|_| velocity_tells),
        ];
        if position_tells || velocity_tells {
            let stands = |told: &Motion, k| told.size.get(k) == Some(&0.0);
            let is_stuck = |&k: &usize| telling.iter().flatten().any(|told| stands(told, k));
            let stuck = (0..samples.len()).filter(is_stuck).count();
            return Some(stuck as f64 / samples.len() as f64);
        }
        let repeats = |motion: Motion| motion.still_share() > 0.0;
        let is_away = !repeats(velocity) && !position.is_some_and(repeats) && hidden <= HIDDEN;
        (is_away && !samples.is_empty()).then_some(0.0)
    }

    fn velocity_within(&self, samples: &Range<usize>) -> Vec<f64> {
        let velocity = self.velocity_rad_s.iter().copied();
        velocity.skip(samples.start).take(samples.len()).collect()
    }
}

/// Motion in each sample by one sensor.
struct Reading {
    /// Its size; 0 where the reading repeats, NaN where it is not known.
    size: Vec<f64>,
    /// The step in which it comes; 0 for a continuous one, infinite where it never changes.
    step: f64,
    /// Its smallest mean size in a free motion.
    smallest: f64,
}

impl Reading {
    fn new(size: Vec<f64>) -> Self {
        let moving = size.iter().filter(|&&size| size > 0.0);
        let usual = moving.clone().sum::<f64>() / moving.count().max(1) as f64;
        Self {
            step: step(&size),
            smallest: SMALLEST_MOTION * usual,
            size,
        }
    }

    fn within(&self, samples: &Range<usize>) -> Motion<'_> {
        Motion {
            size: self.size.get(samples.clone()).unwrap_or_default(),
            step: self.step,
            smallest: self.smallest,
        }
    }
}

/// A part of a reading.
#[derive(Clone, Copy)]
struct Motion<'a> {
    size: &'a [f64],
    step: f64,
    smallest: f64,
}

impl Motion<'_> {
    /// Whether the reading repeats because the axis stands.
    fn tells(self) -> bool {
        let still = self.still_share();
        let by_encoder = self.repeats_by_encoder();
        let flicker = FLICKER * self.step;
        let flickers = share(self.size, |size| size > 0.0 && size <= flicker);
        still > 0.0
            && (by_encoder <= NEGLIGIBLE || still >= BEYOND_THE_ENCODER * by_encoder)
            && flickers <= NEGLIGIBLE + BEYOND_THE_ENCODER * by_encoder
    }

    fn still_share(self) -> f64 {
        share(self.size, |size| size == 0.0)
    }

    /// Share of the samples in which a free motion of this size would repeat the reading.
    fn repeats_by_encoder(self) -> f64 {
        if self.step == 0.0 {
            return 0.0;
        }
        let length = SHORTEST_PART.max(self.size.len() / PARTS);
        let parts = self.size.chunks(length);
        let known = |part: &[f64]| part.iter().filter(|size| size.is_finite()).sum::<f64>();
        let mean = |part: &[f64]| known(part) / part.len() as f64;
        let means: Vec<f64> = parts.clone().map(mean).collect();
        let repeats = parts.enumerate().map(|(place, part)| {
            let near = means.iter().skip(place.saturating_sub(1)).take(3);
            let mean = near.copied().fold(self.smallest, f64::max);
            (REPEATS * self.step / mean).min(1.0) * part.len() as f64
        });
        repeats.sum::<f64>() / self.size.len() as f64
    }
}

/// The smallest size but 0, if all sizes are multiples of it; else 0. Infinite where nothing ever
/// moves: that may be for any step.
fn step(sizes: &[f64]) -> f64 {
    let moving = || sizes.iter().copied().filter(|&size| size > 0.0);
    let smallest = moving().fold(f64::INFINITY, f64::min);
    let is_multiple = |size: f64| (size / smallest - (size / smallest).round()).abs() < 0.05;
    let stride = sizes.len() / SAMPLED + 1;
    let in_steps = moving().step_by(stride).all(is_multiple);
    if in_steps { smallest } else { 0.0 }
}

/// Share of the samples that are not still, but as close to it as noise and filters leave an axis
/// that stands.
///
/// The noise shows in the sixth difference, which a smooth motion hardly has: of white noise sqrt(924)
/// times the standard deviation, and in a tenth of the samples below an eighth of that.
fn close_to_standstill(velocity: &[f64]) -> f64 {
    let sixth = |y: &[f64]| {
        let weights = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
        zip(y, weights).map(|(y, weight)| y * weight).sum::<f64>()
    };
    let stride = velocity.len() / SAMPLED + 1;
    let mut differences: Vec<f64> = velocity.windows(7).step_by(stride).map(sixth).collect();
    differences.iter_mut().for_each(|size| *size = size.abs());
    differences.sort_by(f64::total_cmp);
    let tenth = differences.get(differences.len() / 10).copied();
    let noise = tenth.unwrap_or(0.0) * 8.0 / 924.0_f64.sqrt();
    let close = (DEVIATIONS * noise).max(SMALL * rms(velocity));
    let is_slow = |y: &f64| y.abs() <= close;
    let stretches = velocity.chunk_by(|a, b| is_slow(a) == is_slow(b));
    let slow = stretches.filter(|stretch| stretch.len() >= IN_A_ROW && is_slow(&stretch[0]));
    let moving = slow.flatten().filter(|&&y| y != 0.0).count();
    moving as f64 / velocity.len().max(1) as f64
}

fn share(sizes: &[f64], counts: impl Fn(f64) -> bool) -> f64 {
    let count = sizes.iter().filter(|&&size| counts(size)).count();
    count as f64 / sizes.len().max(1) as f64
}
