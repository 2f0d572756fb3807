//! Samples one lag later, also a fraction of a sample: by a windowed sinc of 16 samples.

use std::array::from_fn;
use std::f64::consts::PI;

use pulp::{Arch, Simd, WithSimd};

/// Samples on either side of the place asked for.
const HALF: usize = 8;
const TAPS: usize = 2 * HALF;
/// The sample that the first of the weights between samples belongs to.
pub(crate) const FIRST_TAP: isize = 1 - HALF as isize;
/// A fraction below this is none: over a million periods it makes a tenth of a sample.
const WHOLE: f64 = 1e-7;

/// A lag, by which signals are compared with themselves.
pub(crate) struct Lag {
    /// The first sample that counts, relative to the sample the lag starts from.
    first: usize,
    /// Weights from there on, ...
    taps: Vec<f64>,
    gain: f64,
    /// ... and those of the nearest four where others are lost.
    cubic: [f64; 4],
    straight: [f64; 4],
}

impl Lag {
    /// A lag in samples; a fraction of one needs more than eight samples and is rounded below.
    pub(crate) fn new(lag: f64) -> Self {
        if (lag - lag.round()).abs() < WHOLE || lag < HALF as f64 {
            Self::with_taps(lag.round().max(0.0) as usize, vec![1.0], 0.0)
        } else {
            Self::between_samples(lag)
        }
    }

    fn between_samples(lag: f64) -> Self {
        let fraction = lag - lag.floor();
        let first = lag.floor() as usize + 1 - HALF;
        Self::with_taps(first, taps(fraction).to_vec(), fraction)
    }

    fn with_taps(first: usize, taps: Vec<f64>, fraction: f64) -> Self {
        Self {
            first,
            gain: gain(&taps),
            taps,
            cubic: cubic(fraction),
            straight: [0.0, 1.0 - fraction, fraction, 0.0],
        }
    }

    /// How many of `n_samples` have a partner that is not beyond the last.
    pub(crate) fn n_pairs(&self, n_samples: usize) -> usize {
        let beyond = self.taps.len() / 2;
        (n_samples + beyond + 1).saturating_sub(self.first + self.taps.len())
    }

    /// The difference between the value one lag after sample `k` and that sample: by fewer neighbours
    /// where others are lost, NaN where the nearest are lost, too, and close to the ends. It is as
    /// large as that of two samples if they are noise, which interpolation averages away.
    pub(crate) fn difference(&self, values: &[f64], k: usize) -> f64 {
        let near = self.near(values, k);
        near.map_or(f64::NAN, |near| self.difference_by(near, values[k]))
    }

    /// The differences of the samples from `first` on, as [`Lag::difference`] has them.
    pub(crate) fn differences(&self, values: &[f64], first: usize, differences: &mut [f64]) {
        let is_whole = first + differences.len() + self.first + self.taps.len() <= values.len() + 1;
        if is_whole {
            let values = &values[first + self.first..];
            Arch::new().dispatch(WeightedSums(&self.taps, values, differences));
        } else {
            differences.fill(f64::NAN);
        }
        for (k, difference) in (first..).zip(differences) {
            *difference = (*difference - values[k]) * self.gain;
            if difference.is_nan() {
                *difference = self.difference(values, k);
            }
        }
    }

    /// The samples around the place one lag after `k`.
    fn near<'a>(&self, values: &'a [f64], k: usize) -> Option<&'a [f64]> {
        values.get(k + self.first..)?.get(..self.taps.len())
    }

    /// The difference by as many of the samples `near` as can be.
    fn difference_by(&self, near: &[f64], now: f64) -> f64 {
        let difference = (weighted(&self.taps, near) - now) * self.gain;
        if difference.is_nan() && near.len() > 1 {
            self.difference_by_few(&near[HALF - 2..HALF + 2], now)
        } else {
            difference
        }
    }

    /// The difference by the nearest four samples, or by two.
    fn difference_by_few(&self, nearest: &[f64], now: f64) -> f64 {
        let by_four = difference(&self.cubic, nearest, now);
        if by_four.is_nan() {
            difference(&self.straight, nearest, now)
        } else {
            by_four
        }
    }
}

/// Weights, samples, and the sum of weighted samples from each of these on; there are enough of them.
struct WeightedSums<'s>(&'s [f64], &'s [f64], &'s mut [f64]);

impl WithSimd for WeightedSums<'_> {
    type Output = ();

    /// Weight by weight, so that many sums are made at once, each in the order of [`weighted`].
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self(taps, values, sums) = self;
        sums.fill(0.0);
        let n = sums.len();
        let (sums, sums_rest) = S::as_mut_simd_f64s(sums);
        for (place, &tap) in taps.iter().enumerate().filter(|(_, tap)| **tap != 0.0) {
            let (values, rest) = S::as_simd_f64s(&values[place..place + n]);
            let weight = simd.splat_f64s(tap);
            for (sum, x) in sums.iter_mut().zip(values) {
                *sum = simd.add_f64s(*sum, simd.mul_f64s(weight, *x));
            }
            for (sum, x) in sums_rest.iter_mut().zip(rest) {
                *sum += tap * x;
            }
        }
    }
}

fn difference(taps: &[f64], near: &[f64], now: f64) -> f64 {
    (weighted(taps, near) - now) * gain(taps)
}

/// The sum of weighted samples; those without a weight may be lost.
fn weighted(taps: &[f64], near: &[f64]) -> f64 {
    let terms = taps.iter().zip(near).filter(|(tap, _)| **tap != 0.0);
    terms.map(|(tap, x)| tap * x).sum()
}

/// Noise of two samples over that of one and an interpolated one.
fn gain(taps: &[f64]) -> f64 {
    (2.0 / (1.0 + taps.iter().map(|tap| tap * tap).sum::<f64>())).sqrt()
}

/// Weights of four samples for the value at `x` between the middle two, by a polynomial of third
/// degree through all of them.
fn cubic(x: f64) -> [f64; 4] {
    [
        -x * (x - 1.0) * (x - 2.0) / 6.0,
        (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
        -(x + 1.0) * x * (x - 2.0) / 2.0,
        (x + 1.0) * x * (x - 1.0) / 6.0,
    ]
}

/// Weights of the samples `-7 ..= 8` for the value at `fraction` after sample 0: a sinc under a
/// Hann window, which keeps a sine at three quarters of Nyquist to a thousandth of its power.
pub(crate) fn taps(fraction: f64) -> [f64; TAPS] {
    let taps = from_fn(|j| windowed_sinc(j as f64 + 1.0 - HALF as f64 - fraction));
    let sum: f64 = taps.iter().sum();
    taps.map(|tap| tap / sum)
}

/// A sinc under a Hann window of 16 samples.
fn windowed_sinc(away: f64) -> f64 {
    sinc(away) * (PI * away / TAPS as f64).cos().powi(2)
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 {
        1.0
    } else {
        (PI * x).sin() / (PI * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_side_by_side_are_those_one_by_one() {
        let mut values = Vec::from_iter((0..1003).map(|k| (0.37 * f64::from(k)).sin()));
        for lost in [0, 17, 500, 501, 502, 1002] {
            values[lost] = f64::NAN;
        }
        for lag in [0.0, 3.0, 20.25, 400.0, 612.7] {
            let lag = Lag::new(lag);
            let n = lag.n_pairs(values.len());
            for range in [0..n, 5..n - 30, n - 9..n] {
                let mut differences = vec![1.0; range.len()];
                lag.differences(&values, range.start, &mut differences);
                for (k, difference) in range.zip(differences) {
                    let one = lag.difference(&values, k);
                    assert!(
                        one == difference || one.is_nan() && difference.is_nan(),
                        "{k}"
                    );
                }
            }
        }
    }
}
