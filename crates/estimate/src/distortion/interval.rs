//! Interval of a variance that is known as a difference: power of a level with noise, less the noise.
//!
//! With the mean squares S of 2 a and N of 2 b degrees of freedom that of `S - N` is the modified large-sample
//! interval of N. Ting, R. K. Burdick, F. A. Graybill, S. Jeyaratnam, T.-F. C. Lu, J. Stat. Comput. Simul. 35 (1990)
//! 135-143: exact where N is 0 and where the lower end is 0.

use std::sync::LazyLock;

use crate::frf::f_distribution::{f_quantile, f_tail};

/// Chance beyond each end.
const TAIL: f64 = 0.025;
/// Chance that noise alone stands out.
const SIGNIFICANCE: f64 = 1e-3;
/// Degrees of freedom of what is known.
const INFINITE: f64 = 1e9;
/// More complex degrees of freedom narrow no interval: it is within 0.3 dB.
const MOST: f64 = 1000.0;
/// [`shares`] of these, which most noise has: they take longest.
static OF_MOST: LazyLock<[f64; 2]> = LazyLock::new(|| shares(MOST as usize));

/// A mean square with its complex degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MeanSquare {
    pub(super) value: f64,
    pub(super) freedom: f64,
}

impl MeanSquare {
    /// The same with a relative variance besides that of its degrees of freedom.
    pub(super) fn with_variance(self, variance: f64) -> Self {
        let freedom = 1.0 / (1.0 / self.freedom + variance);
        Self { freedom, ..self }
    }

    fn whole_freedom(self) -> usize {
        self.freedom.clamp(1.0, MOST) as usize
    }

    /// [`shares`] of its degrees of freedom.
    fn shares(self) -> [f64; 2] {
        if self.freedom >= MOST {
            *OF_MOST
        } else {
            shares(self.whole_freedom())
        }
    }

    /// Whether it exceeds another by no chance.
    pub(super) fn stands_out_of(self, noise: Self) -> bool {
        let (a, b) = (self.whole_freedom(), noise.freedom.min(MOST));
        let is_silent = noise.value == 0.0 && self.value > 0.0;
        is_silent || f_tail(self.value / noise.value, a, b) < SIGNIFICANCE
    }
}

/// Factors that a mean square of so many complex degrees of freedom may have too much and too little, less 1:
/// exceeded in [`TAIL`] each.
fn shares(freedom: usize) -> [f64; 2] {
    [
        1.0 - 1.0 / f_quantile(TAIL, freedom, INFINITE),
        1.0 / f_quantile(1.0 - TAIL, freedom, INFINITE) - 1.0,
    ]
}

/// The 95 % interval of a mean square.
pub(super) fn interval(power: MeanSquare) -> [f64; 2] {
    let [down, up] = power.shares();
    [power.value * (1.0 - down), power.value * (1.0 + up)]
}

/// The 95 % interval of the difference of two mean squares, floored at 0.
pub(super) fn interval_of_difference(power: MeanSquare, noise: MeanSquare) -> [f64; 2] {
    let scale = power.value.max(noise.value).max(f64::MIN_POSITIVE); // squares of it need not be numbers
    let (s, n) = (power.value / scale, noise.value / scale);
    let (a, b) = (power.whole_freedom(), noise.whole_freedom());
    let ([s_down, s_up], [n_down, n_up]) = (power.shares(), noise.shares());
    let cross = |tail: f64, of_s: f64, of_n: f64| {
        let f = f_quantile(tail, a, b as f64);
        ((f - 1.0).powi(2) - (of_s * f).powi(2) - of_n * of_n) / f
    };
    let half = |tail: f64, of_s: f64, of_n: f64| {
        let squares = (of_s * s).powi(2) + (of_n * n).powi(2);
        (squares + cross(tail, of_s, of_n) * s * n).max(0.0).sqrt()
    };
    let low = s - n - half(TAIL, s_down, n_up);
    let high = s - n + half(1.0 - TAIL, s_up, n_down);
    [low, high].map(|end| scale * end.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{normal, stream};

    fn mean_square(value: f64, freedom: usize, mut gauss: impl FnMut() -> f64) -> MeanSquare {
        let sum: f64 = (0..2 * freedom).map(|_| gauss().powi(2)).sum();
        MeanSquare {
            value: value * sum / (2 * freedom) as f64,
            freedom: freedom as f64,
        }
    }

    #[test]
    fn intervals_hold_the_difference_in_95_of_100_cases() {
        let mut rng = stream(1, "interval", &[]);
        for (distortion, a, b) in [
            (0.0, 12, 12),
            (0.3, 12, 60),
            (1.0, 12, 12),
            (1.0, 3, 30),
            (20.0, 12, 12),
        ] {
            let n = 2000;
            let mut missed = [0, 0];
            for _ in 0..n {
                let power = mean_square(1.0 + distortion, a, || normal(&mut rng));
                let noise = mean_square(1.0, b, || normal(&mut rng));
                let [low, high] = interval_of_difference(power, noise);
                missed[0] += usize::from(low > distortion);
                missed[1] += usize::from(high < distortion);
            }
            let most = 0.025 + 4.0 * (0.025 * 0.975 / f64::from(n)).sqrt();
            for missed in missed {
                assert!(
                    (missed as f64) < most * f64::from(n),
                    "{distortion}, {a}, {b}: {missed} of {n}"
                );
            }
        }
    }

    #[test]
    fn intervals_do_not_depend_on_the_unit() {
        let ends = |unit: f64| {
            let of = |value: f64, freedom: f64| MeanSquare {
                value: value * unit,
                freedom,
            };
            interval_of_difference(of(3.0, 12.0), of(1.0, 40.0)).map(|end| end / unit)
        };
        for (found, expected) in [1e-300, 1e300]
            .into_iter()
            .flat_map(|unit| std::iter::zip(ends(unit), ends(1.0)))
        {
            assert!(
                (found / expected - 1.0).abs() < 1e-12,
                "{found} for {expected}"
            );
        }
    }

    /// scipy 1.17: `2 * a / scipy.stats.chi2.ppf([0.975, 0.025], 2 * a)`.
    #[test]
    fn without_noise_it_is_that_of_a_variance() {
        for (freedom, expected) in [(12.0, [0.6097, 1.9353]), (1.0, [0.27109, 39.498])] {
            let power = MeanSquare {
                value: 1.0,
                freedom,
            };
            let silence = MeanSquare {
                value: 0.0,
                freedom: 12.0,
            };
            for found in [interval(power), interval_of_difference(power, silence)] {
                for (found, expected) in found.iter().zip(expected) {
                    assert!(
                        (found / expected - 1.0).abs() < 1e-3,
                        "{found} for {expected}"
                    );
                }
            }
        }
    }
}
