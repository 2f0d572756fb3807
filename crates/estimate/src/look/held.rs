//! Held signals: recorded at a lower rate and repeated until the next value came.

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
    let counts = distances(survey.moving);
    let samples = rhythm(&counts)?;
    let n_changes = counts.iter().sum::<usize>();
    if !sizes_differ(survey.moving, n_changes / SIZES + 1) {
        return None;
    }
    let is_whole = samples.fract() == 0.0;
    let phase = is_whole.then(|| phase(survey, samples as usize));
    Some(Oddity::Held { samples, phase })
}

/// Place and size of every change.
fn changes(samples: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let numbers = samples.iter().copied().enumerate();
    let changes = numbers.filter(|(_, x)| x.is_finite());
    changes
        .scan(f64::NAN, |before, (k, x)| {
            let size = (x - *before).abs();
            *before = x;
            Some((k, size))
        })
        .filter(|&(_, size)| size > 0.0)
}

/// How often each distance between successive changes occurs, by distance; longer ones are left
/// out.
fn distances(samples: &[f64]) -> Vec<usize> {
    let mut counts = vec![0; REST * (LONGEST + 1) + 1];
    let mut before = None;
    for (k, _) in changes(samples) {
        let distance = before.replace(k).map_or(0, |before| k - before);
        if let Some(count) = counts.get_mut(distance) {
            *count += 1;
        }
    }
    counts[0] = 0; // the first change has none before it
    counts
}

/// The hold in samples, from how often each distance occurs.
fn rhythm(counts: &[usize]) -> Option<f64> {
    let pair = |shorter: usize| counts[shorter] + counts[shorter + 1];
    let shorter = (2..=LONGEST).max_by_key(|&shorter| (pair(shorter), counts[shorter]))?;
    let beside = [shorter, shorter + 1];
    let of_pair = pair(shorter) as f64;
    let whole = beside
        .into_iter()
        .find(|&n| counts[n] as f64 >= WHOLE * of_pair);
    let is_in_time = |distance: usize| match whole {
        Some(n) => distance.is_multiple_of(n),
        None => beside.contains(&distance),
    };
    let until_rest = 1..=REST * (shorter + 1);
    let all: usize = until_rest.clone().map(|distance| counts[distance]).sum();
    let in_time: usize = until_rest
        .filter(|&distance| is_in_time(distance))
        .map(|distance| counts[distance])
        .sum();
    let is_held = all >= FEWEST
        && in_time as f64 >= IN_TIME * all as f64
        && of_pair >= THE_HOLD_ITSELF * all as f64;
    let mean = || shorter as f64 + counts[shorter + 1] as f64 / of_pair;
    is_held.then(|| whole.map_or_else(mean, |n| n as f64))
}

/// The place within `every` samples at which most changes lie; a slip moves it.
fn phase(survey: &Survey, every: usize) -> usize {
    let mut counts = vec![0_usize; every];
    for (k, _) in changes(survey.moving) {
        counts[(survey.start + k) % every] += 1;
    }
    (0..every).max_by_key(|&phase| counts[phase]).unwrap_or(0)
}

/// Whether every `stride`-th change is one of a signal that may change by any size.
fn sizes_differ(samples: &[f64], stride: usize) -> bool {
    let sizes: Vec<f64> = changes(samples)
        .map(|(_, size)| size)
        .step_by(stride)
        .collect();
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let other = sizes.iter().filter(|&&size| size > 1.5 * smallest).count();
    other as f64 >= OF_OTHER_SIZE * sizes.len() as f64
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
