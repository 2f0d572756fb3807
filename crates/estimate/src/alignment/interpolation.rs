//! Interpolation between samples at their true times, over missing ones: a polynomial through the ten
//! nearest, refused where it would not carry the band.

use std::array::from_fn;
use std::f64::consts::TAU;

use num_complex::Complex64;

/// Samples on either side.
const HALF: usize = 5;
const POINTS: usize = 2 * HALF;
/// Largest error at the upper end of the band, relative to the amplitude there.
const TOLERANCE: f64 = 0.01;

/// Samples of one signal that are there, with their times.
#[derive(Debug, Clone)]
pub(crate) struct Interpolation {
    times_s: Vec<f64>,
    values: Vec<f64>,
}

/// Weights of ten neighbours.
struct Weights {
    first: usize,
    weights: [f64; POINTS],
}

impl Interpolation {
    /// The finite ones of some samples whose times rise; `None` of fewer than ten.
    pub(crate) fn of(times_s: &[f64], values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let pairs = times_s.iter().copied().zip(values);
        let (times_s, values): (Vec<f64>, Vec<f64>) =
            pairs.filter(|(_, value)| value.is_finite()).unzip();
        (times_s.len() >= POINTS).then_some(Self { times_s, values })
    }

    /// The value at a time in s; `None` where a sine of `high_hz` would be wrong by more than 1 %: in a
    /// hole, or outside.
    pub(crate) fn within(&self, time_s: f64, high_hz: f64) -> Option<f64> {
        let weights = self.weights(time_s);
        let (first, turn) = (weights.first, TAU * high_hz);
        let sines = (0..POINTS).map(|i| {
            let away_s = self.times_s[first + i] - time_s;
            weights.weights[i] * Complex64::cis(turn * away_s)
        });
        let error = (sines.sum::<Complex64>() - 1.0).norm();
        (error <= TOLERANCE).then(|| self.value(&weights))
    }

    fn value(&self, Weights { first, weights }: &Weights) -> f64 {
        let values = &self.values[*first..first + POINTS];
        values
            .iter()
            .zip(weights)
            .map(|(value, weight)| value * weight)
            .sum()
    }

    /// Lagrange's weights.
    fn weights(&self, time_s: f64) -> Weights {
        let above = self.times_s.partition_point(|time| *time <= time_s);
        let first = above.saturating_sub(HALF).min(self.times_s.len() - POINTS);
        let times: [f64; POINTS] = from_fn(|i| self.times_s[first + i] - time_s);
        let weight = |i: usize| -> f64 {
            let (mut above, mut below) = (1.0, 1.0);
            for j in (0..POINTS).filter(|j| *j != i) {
                above *= times[j];
                below *= times[j] - times[i];
            }
            above / below
        };
        Weights {
            first,
            weights: from_fn(weight),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of a sine, 60 Hz, every 2 ms with a jitter, a tenth of them missing.
    fn sampled() -> Interpolation {
        let times: Vec<f64> = (0..500)
            .map(|k| 2e-3 * f64::from(k) + 1e-4 * f64::from(k % 3))
            .collect();
        let value = |(k, t): (usize, &f64)| {
            if k % 10 == 7 {
                f64::NAN
            } else {
                (TAU * 60.0 * t).sin()
            }
        };
        let values: Vec<f64> = times.iter().enumerate().map(value).collect();
        Interpolation::of(&times, values).expect("enough samples")
    }

    #[test]
    fn single_missing_samples_cost_less_than_a_thousandth() {
        let sampled = sampled();
        for k in 0..900 {
            let t = 0.02 + 1e-3 * f64::from(k);
            let error =
                sampled.within(t, 60.0).expect("a sample is there") - (TAU * 60.0 * t).sin();
            assert!(error.abs() < 1e-3, "{error} at {t}");
        }
    }

    #[test]
    fn holes_and_what_lies_outside_are_refused() {
        let times: Vec<f64> = (0..200).map(|k| 1e-3 * f64::from(k)).collect();
        let value = |k: usize| {
            if (80..120).contains(&k) {
                f64::NAN
            } else {
                1.0
            }
        };
        let holed = Interpolation::of(&times, (0..200).map(value)).expect("enough samples");
        assert_eq!(holed.within(0.05, 60.0), Some(1.0));
        assert_eq!(
            (holed.within(0.1, 60.0), holed.within(0.25, 60.0)),
            (None, None)
        );
        assert!(Interpolation::of(&times[..9], vec![0.0; 9]).is_none());
    }
}
