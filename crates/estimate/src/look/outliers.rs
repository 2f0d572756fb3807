//! Outliers: single samples far away from their neighbours, as a lost or garbled message leaves.

use std::iter::zip;

use frfid_signals::median;

use crate::look::oddity::Oddity;
use crate::look::survey::Survey;

/// Samples over which the second difference has one level; a chirp changes it within a second.
const BLOCK: usize = 128;
/// An outlier lies this many standard deviations of the second difference beside its neighbours, which
/// for white noise is 24 of its own: no chance in 2e6 samples even of the exponential distribution.
const DEVIATIONS: f64 = 10.0;
/// Standard deviation of normal numbers over the median of their size.
const PER_MEDIAN: f64 = 1.4826;
/// ... and further away than the spread of the signal. A smaller one, one in a period, moves a line
/// by less than sqrt(2 L)/N of itself (L lines, N samples): less than a per cent.
const SPREADS: f64 = 1.0;
/// ... and this many times as far as the third of the five samples around it lie from the middle one.
const TOGETHER: f64 = 4.0;
/// Largest share of outliers; more are the signal itself.
const RARE: f64 = 0.05;
/// Power of all outliers over that of the signal, below which they move no line by more than a per cent
/// of itself, even if every line is excited.
const MATERIAL: f64 = 1e-4;
/// Samples from which the spread is taken.
const SAMPLED: usize = 4096;

/// Samples that stick out of their neighbours on either side. `step` is the distance of the values
/// of a signal that has few, else 0.
///
/// What sticks out in each period alike is reported all the same: of an output it is a disturbance
/// that the estimate would take for true.
pub(super) fn outliers(survey: &Survey, step: f64) -> Option<Oddity> {
    let spread = spread(survey.moving)?;
    let found = Found::among(survey, &allowed(survey.moving, step, spread));
    found.told(spread, survey.moving.len() as f64)
}

/// How far a sample may lie beside its neighbours, block by block.
fn allowed(samples: &[f64], step: f64, spread: f64) -> Vec<f64> {
    let levels = levels(samples);
    let floor = usual_level(&levels).max(step);
    let near = (0..levels.len()).map(|block| level_near(&levels, block).max(floor));
    near.map(|level| (DEVIATIONS * PER_MEDIAN * level).max(SPREADS * spread))
        .collect()
}

/// Highest level of a block and those beside it.
fn level_near(levels: &[f64], block: usize) -> f64 {
    let near = levels.iter().skip(block.saturating_sub(1)).take(3);
    near.copied().fold(0.0, f64::max)
}

/// Median level of the blocks in which the signal moves.
fn usual_level(levels: &[f64]) -> f64 {
    let moving = levels.iter().copied().filter(|&level| level > 0.0);
    median(moving.collect()).unwrap_or(0.0)
}

/// Outliers so far.
#[derive(Default)]
struct Found {
    count: usize,
    first: usize,
    largest: f64,
    square: f64,
}

impl Found {
    /// The samples that lie beside their neighbours by more than is allowed in their block.
    fn among(survey: &Survey, allowed: &[f64]) -> Self {
        let mut found = Self::default();
        for (start, &allowed) in zip(block_starts(survey.moving), allowed) {
            for k in bends(survey.moving, start, allowed) {
                found.add(survey.start + k, beside(survey.moving, k), allowed);
            }
        }
        found
    }

    fn add(&mut self, sample: usize, size: f64, allowed: f64) {
        if size > allowed {
            if self.count == 0 {
                self.first = sample;
            }
            self.count += 1;
            self.largest = self.largest.max(size);
            self.square += size * size;
        }
    }

    /// What there is to say of them in a signal of this spread and length; `None` of none or too many.
    fn told(&self, spread: f64, n_samples: f64) -> Option<Oddity> {
        let power = self.square / (spread * spread * n_samples);
        let are_outliers = power >= MATERIAL && self.count as f64 <= RARE * n_samples;
        are_outliers.then_some(Oddity::Outliers {
            count: self.count,
            first_sample: self.first,
            size_over_spread: self.largest / spread,
            power_over_signal: power,
        })
    }
}

fn block_starts(samples: &[f64]) -> impl Iterator<Item = usize> {
    (0..samples.len().saturating_sub(2)).step_by(BLOCK)
}

/// Size of the second difference at every sample of a block but the first.
fn second_differences(samples: &[f64], start: usize) -> impl Iterator<Item = f64> {
    let block = &samples[start..samples.len().min(start + BLOCK + 2)];
    let near = block.windows(3);
    near.map(|near| (near[0] - 2.0 * near[1] + near[2]).abs())
}

/// Places in a block at which the second difference is larger than allowed.
fn bends(samples: &[f64], start: usize, allowed: f64) -> impl Iterator<Item = usize> {
    let sizes = zip(second_differences(samples, start), start + 1..);
    let large = sizes.filter(move |&(size, _)| size > allowed);
    large.map(|(_, k)| k)
}

/// Median size of the second difference in each block.
fn levels(samples: &[f64]) -> Vec<f64> {
    let level = |start: usize| {
        let known = second_differences(samples, start).filter(|size| size.is_finite());
        upper_median(known.collect())
    };
    block_starts(samples).map(level).collect()
}

/// The middle size, the larger of two; 0 of none.
fn upper_median(mut sizes: Vec<f64>) -> f64 {
    let middle = sizes.len() / 2;
    if sizes.is_empty() {
        return 0.0;
    }
    *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// How far a sample sticks out of the five around it: its distance from their median. 0 on any slope
/// or step, at the ends and beside lost samples, and where three of the five do not lie together: at
/// the top of a pulse.
fn beside(samples: &[f64], k: usize) -> f64 {
    let near = k.checked_sub(2).and_then(|from| samples.get(from..));
    near.and_then(<[f64]>::first_chunk).map_or(0.0, out_of_five)
}

/// How far the third of five samples sticks out.
fn out_of_five(near: &[f64; 5]) -> f64 {
    let middle = median(near.to_vec()).unwrap_or(f64::NAN);
    let mut distances = near.map(|x| (x - middle).abs());
    let size = distances[2];
    distances.sort_by(f64::total_cmp);
    let sticks_out = size.is_finite() && size >= TOGETHER * distances[2];
    if sticks_out { size } else { 0.0 }
}

/// Half of what holds the middle 68 % of the samples about a straight line, which 16 % of outliers
/// cannot move; `None` for a signal that stands for as long, of which impulses are the motion.
fn spread(samples: &[f64]) -> Option<f64> {
    let mut sorted = about_line(sampled(samples));
    sorted.sort_by(f64::total_cmp);
    let spread = 0.5 * (quantile(&sorted, 0.84)? - quantile(&sorted, 0.16)?);
    (spread > 0.0).then_some(spread)
}

/// The value below which this share of sorted ones lies.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = (share * sorted.len() as f64) as usize;
    sorted.get(place).copied()
}

/// Some of the samples that are numbers, evenly over all.
fn sampled(samples: &[f64]) -> Vec<f64> {
    let sampled = samples.iter().step_by(samples.len() / SAMPLED + 1);
    sampled.copied().filter(|x| x.is_finite()).collect()
}

/// Values less a straight line, which leaves the first of them as it is.
fn about_line(mut values: Vec<f64>) -> Vec<f64> {
    let slope = slope(&values);
    for (k, x) in values.iter_mut().enumerate() {
        *x -= slope * k as f64;
    }
    values
}

/// Slope from the median of the first quarter to that of the last one.
fn slope(values: &[f64]) -> f64 {
    let (quarter, count) = (values.len() / 4, values.len());
    let first = median_or_0(&values[..quarter]);
    let last = median_or_0(&values[count - quarter..]);
    (last - first) / (0.75 * count as f64)
}

fn median_or_0(values: &[f64]) -> f64 {
    median(values.to_vec()).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::oddity::Consequence;
    use crate::look::tests::multisine;
    use frfid_signals::random::{normal, stream, uniform};

    fn found(samples: &[f64]) -> Option<Oddity> {
        outliers(&Survey::of(samples).expect("changes"), 0.0)
    }

    #[test]
    fn count_place_and_size_are_right_on_a_motion_on_a_ramp_and_in_noise() {
        let mut rng = stream(13, "outliers", &[]);
        let sound = multisine(2000, 5, 13);
        for (ramp, noise) in [(0.0, 0.0), (10.0, 0.0), (0.0, 0.3), (-3.0, 0.1)] {
            let at = |(k, x): (usize, &f64)| x + ramp * k as f64 * 1e-3 + noise * normal(&mut rng);
            let mut samples: Vec<f64> = sound.iter().enumerate().map(at).collect();
            assert_eq!(found(&samples), None);
            for (k, size) in [(2222, 30.0), (5000, -20.0), (5001, -20.0), (9990, 25.0)] {
                samples[k] += size;
            }
            let oddity = found(&samples).expect("outliers");
            let Oddity::Outliers {
                count,
                first_sample,
                size_over_spread,
                ..
            } = oddity
            else {
                panic!("{oddity:?}");
            };
            assert_eq!((count, first_sample), (4, 2222), "{oddity:?}");
            let spread = spread(&samples).expect("moves");
            assert!(
                (size_over_spread * spread / 30.0 - 1.0).abs() < 0.1,
                "{oddity:?}"
            );
            assert_eq!(oddity.consequence(), Consequence::Flagged);
        }
    }

    #[test]
    fn one_that_moves_no_line_is_none() {
        let mut samples = multisine(2000, 50, 16);
        let size = spread(&samples).expect("moves");
        samples[5000] += 3.0 * size;
        assert_eq!(found(&samples), None);
        samples[5000] += 3.0 * size;
        assert!(found(&samples).is_some());
    }

    #[test]
    fn noise_of_any_kind_has_none() {
        let mut rng = stream(14, "noise", &[]);
        let exponential = |rng: &mut _| -(1.0 - uniform(rng)).ln() * (uniform(rng) - 0.5).signum();
        let normal: Vec<f64> = (0..2_000_000).map(|_| normal(&mut rng)).collect();
        let heavy: Vec<f64> = (0..500_000).map(|_| exponential(&mut rng)).collect();
        let brown = normal.iter().scan(0.0, |x, dx| {
            *x += dx;
            Some(*x)
        });
        let brown: Vec<f64> = brown.collect();
        assert_eq!(
            [&normal, &heavy, &brown].map(|samples| found(samples)),
            [None, None, None]
        );
    }

    #[test]
    fn edges_pulses_and_a_start_from_rest_are_none() {
        let square: Vec<f64> = (0..9000).map(|k| f64::from(k / 100 % 2)).collect();
        let hammer: Vec<f64> = (0..9000)
            .map(|k| (-((f64::from(k % 1500) - 700.0) / 4.0).powi(2)).exp())
            .collect();
        let impulses: Vec<f64> = (0..9000)
            .map(|k| f64::from(u8::from(k % 1500 == 700)))
            .collect();
        let mut from_rest = vec![0.0; 1000];
        from_rest.extend(multisine(2000, 5, 15).iter().map(|x| x + 2.0));
        from_rest.extend(vec![0.0; 1000]);
        for samples in [square, hammer, impulses, from_rest] {
            assert_eq!(found(&samples), None);
        }
    }
}
