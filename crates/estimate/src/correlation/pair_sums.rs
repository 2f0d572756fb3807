//! Sums over pairs of samples, of signals and of their differences, by the vector instructions of the machine.

use std::iter::zip;

use pulp::{Arch, Simd, WithSimd};

/// Number of pairs, and sums of the signal, its squares, the differences and theirs; pairs with a lost sample do not count.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct PairSums {
    pub(super) n: f64,
    x: f64,
    xx: f64,
    d: f64,
    dd: f64,
}

impl PairSums {
    /// Samples and what they differ by later.
    pub(super) fn of(pairs: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut sums = Self::default();
        for (now, difference) in pairs.filter(|pair| !pair.1.is_nan()) {
            sums.n += 1.0;
            sums.x += now;
            sums.xx += now * now;
            sums.d += difference;
            sums.dd += difference * difference;
        }
        sums
    }

    /// The same of samples beside what they are later.
    pub(super) fn of_later(now: &[f64], later: &[f64]) -> Self {
        let n = now.len().min(later.len());
        Arch::new().dispatch(Later(&now[..n], &later[..n]))
    }

    /// The same of as many differences.
    pub(super) fn of_differences(now: &[f64], differences: &[f64]) -> Self {
        let n = now.len().min(differences.len());
        Arch::new().dispatch(Differing(&now[..n], &differences[..n]))
    }

    /// All of these pairs.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            n: self.n + other.n,
            x: self.x + other.x,
            xx: self.xx + other.xx,
            d: self.d + other.d,
            dd: self.dd + other.dd,
        }
    }

    /// Variance of the differences times their number.
    pub(super) fn difference(&self) -> f64 {
        self.dd - self.d * self.d / self.n
    }

    /// Variance of the signal times the number of pairs.
    pub(super) fn power(&self) -> f64 {
        self.xx - self.x * self.x / self.n
    }
}

/// Samples, and what they are later.
struct Later<'s>(&'s [f64], &'s [f64]);
/// Samples, and what they differ by later.
struct Differing<'s>(&'s [f64], &'s [f64]);

impl WithSimd for Later<'_> {
    type Output = PairSums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> PairSums {
        let (now, now_rest) = S::as_simd_f64s(self.0);
        let (later, later_rest) = S::as_simd_f64s(self.1);
        let pairs = zip(now, later).map(|(now, later)| (*now, simd.sub_f64s(*later, *now)));
        let rest = zip(now_rest, later_rest).map(|(now, later)| (*now, later - now));
        sums(simd, pairs).plus(PairSums::of(rest))
    }
}

impl WithSimd for Differing<'_> {
    type Output = PairSums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> PairSums {
        let (now, now_rest) = S::as_simd_f64s(self.0);
        let (differences, rest) = S::as_simd_f64s(self.1);
        let pairs = zip(now, differences).map(|(now, difference)| (*now, *difference));
        let rest = zip(now_rest, rest).map(|(now, difference)| (*now, *difference));
        sums(simd, pairs).plus(PairSums::of(rest))
    }
}

/// The sums of samples and what they differ by later, register by register.
#[inline(always)]
fn sums<S: Simd>(simd: S, pairs: impl Iterator<Item = (S::f64s, S::f64s)>) -> PairSums {
    let (zero, one) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
    let mut sums = [zero; 5];
    for (now, difference) in pairs {
        let is_there = simd.equal_f64s(difference, difference);
        let [n, x, d] = [one, now, difference].map(|value| simd.select_f64s(is_there, value, zero));
        let terms = [n, x, simd.mul_f64s(x, x), d, simd.mul_f64s(d, d)];
        sums = std::array::from_fn(|sum| simd.add_f64s(sums[sum], terms[sum]));
    }
    let [n, x, xx, d, dd] = sums.map(|sum| simd.reduce_sum_f64s(sum));
    PairSums { n, x, xx, d, dd }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_side_by_side_have_the_sums_of_pairs_one_by_one() {
        let mut values = Vec::from_iter((0..1003).map(|k| (0.37 * f64::from(k)).sin()));
        for lost in [0, 17, 500, 501, 1002] {
            values[lost] = f64::NAN;
        }
        for lag in [0, 1, 7, 400, 1000, 1003] {
            let later = &values[lag..];
            let one_by_one = zip(&values, later).map(|(now, later)| (*now, later - now));
            let differences = Vec::from_iter(one_by_one.clone().map(|(_, difference)| difference));
            let a = PairSums::of(one_by_one);
            for b in [
                PairSums::of_later(&values, later),
                PairSums::of_differences(&values, &differences),
            ] {
                assert_eq!(a.n, b.n);
                for (a, b) in [(a.x, b.x), (a.xx, b.xx), (a.d, b.d), (a.dd, b.dd)] {
                    let allowed = 1e-12 * a.abs().max(1.0);
                    assert!((a - b).abs() < allowed, "{lag}: {a} and {b}");
                }
            }
        }
    }
}
