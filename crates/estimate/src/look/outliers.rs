//! Outliers: single samples far away from their neighbours, as a lost or garbled message leaves.

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
/// Samples from which the spread is taken.
const SAMPLED: usize = 4096;

/// Samples that stick out of their neighbours on either side. `step` is the distance of the values
/// of a signal that has few, else 0.
///
/// What sticks out in each period alike is reported all the same: of an output it is a disturbance
/// that the estimate would take for true.
pub(super) fn outliers(survey: &Survey, step: f64) -> Option<Oddity> {
    let levels = levels(survey.moving);
    let floor = median(
        levels
            .iter()
            .copied()
            .filter(|&level| level > 0.0)
            .collect(),
    );
    let floor = floor.unwrap_or(0.0).max(step);
    let spread = spread(survey)?;
    let allowed = |block: usize| {
        let near = levels.iter().skip(block.saturating_sub(1)).take(3);
        let level = near.copied().fold(floor, f64::max);
        (DEVIATIONS * PER_MEDIAN * level).max(SPREADS * spread)
    };
    let mut found = Found::default();
    for (block, start) in block_starts(survey.moving).enumerate() {
        let allowed = allowed(block);
        for (near, k) in block_of(survey.moving, start).windows(3).zip(start + 1..) {
            if second_difference(near) > allowed {
                found.add(survey.start + k, beside(survey.moving, k), allowed);
            }
        }
    }
    let is_rare = found.count as f64 <= RARE * survey.moving.len() as f64;
    (found.count > 0 && is_rare).then_some(Oddity::Outliers {
        count: found.count,
        first_sample: found.first,
        size_over_spread: found.largest / spread,
        power_over_signal: found.square / (spread * spread * survey.moving.len() as f64),
    })
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
}

fn block_starts(samples: &[f64]) -> impl Iterator<Item = usize> {
    (0..samples.len().saturating_sub(2)).step_by(BLOCK)
}

/// The samples of a block, and the two more that its second differences take.
fn block_of(samples: &[f64], start: usize) -> &[f64] {
    &samples[start..samples.len().min(start + BLOCK + 2)]
}

fn second_difference(near: &[f64]) -> f64 {
    (near[0] - 2.0 * near[1] + near[2]).abs()
}

/// Median size of the second difference in each block.
fn levels(samples: &[f64]) -> Vec<f64> {
    let mut sizes = Vec::with_capacity(BLOCK);
    let level = |start: usize| {
        sizes.clear();
        let all = block_of(samples, start).windows(3).map(second_difference);
        sizes.extend(all.filter(|size| size.is_finite()));
        let middle = sizes.len() / 2;
        if sizes.is_empty() {
            return 0.0;
        }
        *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    block_starts(samples).map(level).collect()
}

/// How far a sample sticks out of the five around it: its distance from their median. 0 on any slope
/// or step, at the ends and beside lost samples, and where three of the five do not lie together: at
/// the top of a pulse.
fn beside(samples: &[f64], k: usize) -> f64 {
    let near = k.checked_sub(2).and_then(|from| samples.get(from..k + 3));
    let Some((near, middle)) = near.and_then(|near| Some((near, median(near.to_vec())?))) else {
        return 0.0;
    };
    let mut distances: Vec<f64> = near.iter().map(|x| (x - middle).abs()).collect();
    let size = distances[2];
    distances.sort_by(f64::total_cmp);
    let sticks_out = size.is_finite() && size >= TOGETHER * distances[2];
    if sticks_out { size } else { 0.0 }
}

/// Half of what holds the middle 68 % of the samples about a straight line, which 16 % of outliers
/// cannot move; `None` for a signal that stands for as long, of which impulses are the motion.
fn spread(survey: &Survey) -> Option<f64> {
    let stride = survey.moving.len() / SAMPLED + 1;
    let sampled = survey.moving.iter().copied().step_by(stride);
    let sampled: Vec<f64> = sampled.filter(|x| x.is_finite()).collect();
    let (quarter, count) = (sampled.len() / 4, sampled.len() as f64);
    let first = median(sampled[..quarter].to_vec()).unwrap_or(0.0);
    let last = median(sampled[sampled.len() - quarter..].to_vec()).unwrap_or(0.0);
    let slope = (last - first) / (0.75 * count);
    let about_line = sampled
        .iter()
        .enumerate()
        .map(|(k, x)| x - slope * k as f64);
    let mut about_line: Vec<f64> = about_line.collect();
    about_line.sort_by(f64::total_cmp);
    let at = |share: f64| about_line.get((share * count) as usize).copied();
    let spread = at(0.84)
        .zip(at(0.16))
        .map_or(0.0, |(high, low)| 0.5 * (high - low));
    (spread > 0.0).then_some(spread)
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
            let spread = spread(&Survey::of(&samples).expect("changes")).expect("moves");
            assert!(
                (size_over_spread * spread / 30.0 - 1.0).abs() < 0.1,
                "{oddity:?}"
            );
            assert_eq!(oddity.consequence(), Consequence::Flagged);
        }
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
