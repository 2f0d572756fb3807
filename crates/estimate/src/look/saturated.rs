//! Saturated signals: clipped by a limit of the drive, the sensor or the converter.

use std::mem::take;
use std::ops::RangeInclusive;

use crate::look::oddity::{Level, Oddity, share_at};
use crate::look::survey::{Survey, insert};

/// Samples in a row that make a stand: two equal ones a sampled sine may have at its top.
const IN_A_ROW: f64 = 3.0;
/// Fewest stands: the motion may rest once or twice at its farthest point.
const STANDS: usize = 3;
/// Smallest share of samples at the levels that is told: clipping it leaves an error of 1.5 % of
/// the rms.
const TOLD: f64 = 1e-3;
/// The level is a step of the values thick, and rounding: the last digit of a clipped reading flickers.
const LEVEL: f64 = 1.5;
/// What lies below the level is counted down to this part of the range ...
const BELOW: f64 = 0.005;
/// ... and at least over this many steps of the values, so that a smooth signal read in steps is
/// judged by several of them.
const BELOW_STEPS: f64 = 8.0;
/// How many times the samples below a level those at it must be. A parabola, the top of any smooth
/// signal, has at most `sqrt(2)/(3 - sqrt(2))` = 0.9 times as many, one that is flat to the third derivative
/// 2.2 times.
const PILED_UP: f64 = 2.5;
/// Highest values among which the step is looked for: those that a smooth signal takes at its top.
const HIGHEST: usize = 16;
/// A stand at 0 that is longer than this part of the signal is a rest, not a limit.
const REST_AT_ZERO: f64 = 0.02;

/// Levels at either end of the range at which the signal stands; `hold` samples of a held signal are
/// one.
pub(super) fn saturated(survey: &Survey, hold: f64) -> Option<Oddity> {
    let [low, high] = [-1.0, 1.0].map(|sign| level(survey, sign, hold));
    let is_told = share_at([low, high]) >= TOLD;
    is_told.then_some(Oddity::Saturated { low, high })
}

/// The highest level of the signal times `sign`, if it stands there.
fn level(survey: &Survey, sign: f64, hold: f64) -> Option<Level> {
    let top = if sign > 0.0 { survey.high } else { -survey.low };
    let depths = Depths::of(survey, step_at_top(survey, sign))?;
    let n_samples = survey.moving.len() as f64;
    let stand = stand_lengths(hold, n_samples, top.abs() <= depths.at_level);
    let count = count(survey, |x| top - sign * x, &depths, &stand);
    count.is_piled_up().then(|| Level {
        value: sign * top,
        share: count.at_level as f64 / n_samples,
    })
}

/// How many samples in a row make a stand; a longer one at zero is a rest.
fn stand_lengths(hold: f64, n_samples: f64, is_at_zero: bool) -> RangeInclusive<f64> {
    let longest = if is_at_zero { REST_AT_ZERO } else { 1.0 };
    IN_A_ROW * hold..=longest * n_samples
}

/// Smallest distance between the highest values of the signal times `sign`.
fn step_at_top(survey: &Survey, sign: f64) -> f64 {
    let upside_down = survey.numbers().map(|x| -sign * x);
    let lowest = lowest_values(upside_down, survey.one_value());
    let steps = lowest.windows(2).map(|pair| pair[1] - pair[0]);
    steps.fold(f64::INFINITY, f64::min)
}

/// Depths below the level up to which a sample counts.
struct Depths {
    /// As one at the level.
    at_level: f64,
    /// As one near it.
    below: f64,
}

impl Depths {
    /// Of a signal whose highest values are a step apart; `None` of too few values to have a top.
    fn of(survey: &Survey, step: f64) -> Option<Self> {
        let below = (BELOW_STEPS * step).max(BELOW * survey.range());
        let has_top = below <= 0.5 * survey.range();
        let at_level = LEVEL * step;
        has_top.then_some(Self { at_level, below })
    }
}

/// The lowest values, rising; at most [`HIGHEST`].
fn lowest_values(numbers: impl Iterator<Item = f64>, tolerance: f64) -> Vec<f64> {
    let mut values = Vec::with_capacity(HIGHEST + 1);
    for x in numbers {
        if values.get(HIGHEST - 1).is_none_or(|&highest| x < highest) {
            insert(&mut values, x, tolerance);
            values.truncate(HIGHEST);
        }
    }
    values
}

/// Samples at and below a level.
#[derive(Default)]
struct Count {
    /// Stretches of samples in a row at the level.
    stands: usize,
    /// Samples of these.
    at_level: usize,
    /// Samples near the level, but not at it.
    below: usize,
}

impl Count {
    /// Adds samples in a row at the level, if they are as many as `stand` says.
    fn add(&mut self, in_a_row: usize, stand: &RangeInclusive<f64>) {
        if stand.contains(&(in_a_row as f64)) {
            self.stands += 1;
            self.at_level += in_a_row;
        }
    }

    /// Whether the signal stands often, and more samples lie at the level than a smooth one has there.
    fn is_piled_up(&self) -> bool {
        self.stands >= STANDS && self.at_level as f64 >= PILED_UP * self.below as f64
    }
}

/// Counts samples by their `depth` below the level; only stretches of so many samples as `stand` says
/// are stands.
fn count(
    survey: &Survey,
    depth: impl Fn(f64) -> f64,
    depths: &Depths,
    stand: &RangeInclusive<f64>,
) -> Count {
    let (mut count, mut in_a_row) = (Count::default(), 0);
    for depth in survey.numbers().chain([f64::NAN]).map(depth) {
        if depth <= depths.at_level {
            in_a_row += 1;
        } else {
            count.add(take(&mut in_a_row), stand);
            count.below += usize::from(depth <= depths.below);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::oddity::Consequence;
    use crate::look::tests::{multisine, quantised};
    use frfid_signals::random::{normal, stream};
    use std::f64::consts::TAU;

    fn found(samples: &[f64]) -> Option<Oddity> {
        saturated(&Survey::of(samples).expect("changes"), 1.0)
    }

    fn clipped(samples: &[f64], low: f64, high: f64) -> Vec<f64> {
        samples.iter().map(|x| x.clamp(low, high)).collect()
    }

    fn sine(cycles: f64) -> Vec<f64> {
        let of = |k: usize| (TAU * cycles * k as f64 / 20_000.0).sin();
        (0..20_000).map(of).collect()
    }

    #[test]
    fn levels_and_shares_are_right() {
        let sound = multisine(2000, 5, 10);
        for step in [0.0, 2.0 / 4096.0, 0.02] {
            let samples = quantised(&clipped(&sound, -1.3, 1.3), step);
            let Some(Oddity::Saturated { low, high }) = found(&samples) else {
                panic!("saturated");
            };
            for (level, value) in [(low, -1.3), (high, 1.3)] {
                let level = level.expect("either side");
                let beyond = sound.iter().filter(|&&x| x * value > 1.3 * 1.3).count();
                assert!((level.value - value).abs() <= step);
                assert!(
                    (level.share - beyond as f64 / 1e4).abs() < 0.01,
                    "{level:?}"
                );
            }
        }
    }

    #[test]
    fn one_side_and_little_clipping_are_found() {
        let sound = multisine(2000, 5, 10);
        let upper = found(&clipped(&sound, -9.0, 1.0)).expect("saturated");
        assert!(matches!(
            upper,
            Oddity::Saturated {
                low: None,
                high: Some(_)
            }
        ));
        assert_eq!(upper.consequence(), Consequence::Flagged);
        let little = found(&clipped(&sound, -9.0, 2.35)).expect("saturated");
        assert_eq!(little.consequence(), Consequence::Told, "{little:?}");
        assert!(found(&clipped(&sine(7.0), -0.95, 9.0)).is_some());
    }

    #[test]
    fn smooth_signals_in_any_steps_and_noise_are_not_saturated() {
        let mut rng = stream(11, "noise", &[]);
        let noise: Vec<f64> = (0..20_000).map(|_| normal(&mut rng)).collect();
        let third: Vec<f64> = sine(5.0)
            .iter()
            .zip(sine(15.0))
            .map(|(a, b)| a + b / 9.0)
            .collect();
        for sound in [
            sine(1.0),
            sine(7.3),
            sine(1000.0),
            sine(5000.0),
            multisine(2000, 5, 12),
            noise,
            third,
        ] {
            for bits in [5, 6, 8, 10, 12, 16, 30] {
                let samples = quantised(&sound, 6.0 / 2.0_f64.powi(bits));
                assert_eq!(found(&samples), None, "{bits} bits");
            }
        }
    }

    #[test]
    fn a_rest_at_the_lowest_value_is_none() {
        let run: Vec<f64> = (0..4000)
            .map(|k| 1.0 - (TAU * f64::from(k) / 400.0).cos())
            .collect();
        let rest = vec![0.0; 3000];
        let session = [&run[..], &rest, &run, &rest, &run, &rest, &run].concat();
        assert_eq!(found(&session), None);
    }
}
