//! Held signals: recorded at a lower rate and repeated until the next value came.

use std::mem::replace;

use crate::look::oddity::Oddity;
use crate::look::survey::Survey;

/// Share of the changes that must come in time: the others are values that happen to repeat, lost
/// samples, and a clock that slips.
const IN_TIME: f64 = 0.9;
/// Longest hold that is looked for: 1 kHz from a sensor of one value in a second.
const LONGEST: usize = 1000;
/// Distances between changes beyond this many holds are rests.
const REST: usize = 8;
/// Fewer distances between changes show no rhythm.
const FEWEST: usize = 16;
/// Share of the distances that are the hold itself, not a multiple: with fewer, a signal that
/// rarely changes would be one that is held for the greatest common divisor.
const THE_HOLD_ITSELF: f64 = 0.5;
/// Share of distances of one length from which the hold is a whole number of samples; where two
/// lengths alternate, it lies between them.
const WHOLE: f64 = 0.95;
/// A smooth signal read in coarse steps changes by a single step when it changes rarely; a held one
/// by any size. At least this share of the changes must exceed the smallest by half.
const OF_OTHER_SIZE: f64 = 0.25;
/// Changes whose size is looked at.
const SIZES: usize = 4096;

/// Whether a signal changes every n samples only, n >= 2.
pub(super) fn held(survey: &Survey) -> Option<Oddity> {
    let counts = counts(distances(survey.moving));
    let samples = rhythm(&counts)?;
    let is_held = sizes_differ(survey.moving, counts.iter().sum());
    is_held.then(|| Oddity::Held {
        samples,
        phase: phase(survey, samples),
    })
}

/// Place and size of every change.
fn changes(samples: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let mut before = f64::NAN;
    let size = move |(k, x): (usize, f64)| (k, (x - replace(&mut before, x)).abs());
    numbered(samples).map(size).filter(|&(_, size)| size > 0.0)
}

/// Place and value of the samples that are numbers.
fn numbered(samples: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let all = samples.iter().copied().enumerate();
    all.filter(|(_, x)| x.is_finite())
}

/// Places of the changes.
fn places(samples: &[f64]) -> impl Iterator<Item = usize> {
    changes(samples).map(|(k, _)| k)
}

/// Distances between successive changes.
fn distances(samples: &[f64]) -> impl Iterator<Item = usize> {
    let mut places = places(samples);
    let mut before = places.next().unwrap_or(0);
    places.map(move |k| k - replace(&mut before, k))
}

/// How often each distance or place occurs; longer ones are left out.
fn counts(distances: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut counts = vec![0; REST * (LONGEST + 1) + 1];
    for distance in distances {
        if let Some(count) = counts.get_mut(distance) {
            *count += 1;
        }
    }
    counts
}

/// The two neighbouring distances between which a hold lies, and how often they occur.
struct Hold {
    shorter: usize,
    counts: [usize; 2],
}

impl Hold {
    fn new(shorter: usize, counts: &[usize]) -> Self {
        let counts = [counts[shorter], counts[shorter + 1]];
        Self { shorter, counts }
    }

    /// The pair that occurs most often.
    fn most_frequent(counts: &[usize]) -> Option<Self> {
        let all = (2..=LONGEST).map(|shorter| Self::new(shorter, counts));
        all.max_by_key(|hold| (hold.count(), hold.counts[0]))
    }

    fn count(&self) -> usize {
        self.counts.iter().sum()
    }

    /// The one of the two that nearly all distances are.
    fn whole(&self) -> Option<usize> {
        let enough = WHOLE * self.count() as f64;
        let place = self.counts.iter().position(|&n| n as f64 >= enough);
        place.map(|place| self.shorter + place)
    }

    /// Length in samples.
    fn samples(&self) -> f64 {
        let longer = || self.counts[1] as f64 / self.count() as f64;
        let mean = || self.shorter as f64 + longer();
        self.whole().map_or_else(mean, |n| n as f64)
    }

    /// Whether a signal held so long may change at this distance.
    fn is_in_time(&self, distance: usize) -> bool {
        match self.whole() {
            Some(n) => distance.is_multiple_of(n),
            None => [self.shorter, self.shorter + 1].contains(&distance),
        }
    }

    /// How many distances of these are no rests.
    fn count_of(&self, counts: &[usize], is_counted: impl Fn(usize) -> bool) -> usize {
        let until_rest = 1..=REST * (self.shorter + 1);
        let counted = until_rest.filter(|&distance| is_counted(distance));
        counted.map(|distance| counts[distance]).sum()
    }

    /// Whether nearly all changes come in time, and enough of them after the hold itself.
    fn explains(&self, counts: &[usize]) -> bool {
        let all = self.count_of(counts, |_| true);
        let in_time = self.count_of(counts, |distance| self.is_in_time(distance));
        let are = |count: usize, share: f64| count as f64 >= share * all as f64;
        all >= FEWEST && are(in_time, IN_TIME) && are(self.count(), THE_HOLD_ITSELF)
    }
}

/// The hold in samples, from how often each distance occurs.
fn rhythm(counts: &[usize]) -> Option<f64> {
    let hold = Hold::most_frequent(counts)?;
    hold.explains(counts).then(|| hold.samples())
}

/// The place within a hold of whole samples at which the new values come.
fn phase(survey: &Survey, hold: f64) -> Option<usize> {
    let is_whole = hold.fract() == 0.0;
    is_whole.then(|| usual_phase(survey, hold as usize))
}

/// The place within `every` samples at which most changes lie; a slip moves it.
fn usual_phase(survey: &Survey, every: usize) -> usize {
    let phases = places(survey.moving).map(|k| (survey.start + k) % every);
    let counts = counts(phases);
    (0..every).max_by_key(|&phase| counts[phase]).unwrap_or(0)
}

/// Whether a signal may change by any size, by some of its `n_changes`.
fn sizes_differ(samples: &[f64], n_changes: usize) -> bool {
    let sizes = changes(samples).map(|(_, size)| size);
    let sizes: Vec<f64> = sizes.step_by(n_changes / SIZES + 1).collect();
    let other = count_other_sizes(&sizes);
    other as f64 >= OF_OTHER_SIZE * sizes.len() as f64
}

/// How many sizes exceed the smallest by half.
fn count_other_sizes(sizes: &[f64]) -> usize {
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    sizes.iter().filter(|&&size| size > 1.5 * smallest).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::tests::{multisine, quantised};

    fn found(samples: &[f64]) -> Option<(f64, Option<usize>)> {
        match held(&Survey::of(samples).expect("changes")) {
            Some(Oddity::Held { samples, phase }) => Some((samples, phase)),
            _ => None,
        }
    }

    fn repeated(source: &[f64], every: f64, shift: usize) -> Vec<f64> {
        let of = |k: usize| source[((k + shift) as f64 / every) as usize];
        (0..(source.len() as f64 * every) as usize - shift)
            .map(of)
            .collect()
    }

    #[test]
    fn hold_and_phase_are_found_through_rests_lost_samples_and_slips() {
        let source = multisine(2000, 2, 4);
        for every in [2, 3, 4, 10, 100] {
            for shift in [0, 1] {
                let phase = (every - shift) % every;
                let mut samples = repeated(&source, every as f64, shift);
                assert_eq!(found(&samples), Some((every as f64, Some(phase))));
                samples[333] = f64::NAN;
                let late = samples.len() - 500;
                samples.insert(late, samples[late]);
                samples.splice(..0, vec![0.0; 10 * every]);
                samples.extend(vec![0.0; 5000]);
                assert_eq!(found(&samples), Some((every as f64, Some(phase))));
            }
        }
        let (hold, phase) = found(&repeated(&source, 10.0 / 3.0, 0)).expect("held");
        assert!((hold * 0.3 - 1.0).abs() < 0.01 && phase.is_none(), "{hold}");
    }

    #[test]
    fn a_held_signal_of_coarse_steps_is_found() {
        let source = quantised(&multisine(2000, 2, 5), 0.2);
        assert_eq!(found(&repeated(&source, 10.0, 0)), Some((10.0, Some(0))));
    }

    #[test]
    fn what_changes_rarely_for_other_reasons_is_not_held() {
        let slow: Vec<f64> = (0..20_000)
            .map(|k| 10.0 * (k as f64 / 500.0).sin())
            .collect();
        assert_eq!(found(&quantised(&slow, 0.1)), None, "coarse steps");
        let ramp: Vec<f64> = (0..20_000).map(|k| 0.2 * k as f64).collect();
        assert_eq!(found(&quantised(&ramp, 1.0)), None, "a ramp in steps");
        let square: Vec<f64> = (0..20_000).map(|k| f64::from(k / 50 % 2)).collect();
        assert_eq!(found(&square), None, "a square wave");
        assert_eq!(found(&multisine(2000, 5, 6)), None);
    }
}
