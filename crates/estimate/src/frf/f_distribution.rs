//! F distribution with an even number of degrees of freedom above, as ratios of powers of complex numbers have.

/// Probability that an F variable with `2 a` and `2 b` degrees of freedom exceeds `ratio`.
pub(crate) fn f_tail(ratio: f64, a: usize, b: f64) -> f64 {
    ln_f_tail(ratio, a, b).exp()
}

/// Logarithm of [`f_tail`].
pub(crate) fn ln_f_tail(ratio: f64, a: usize, b: f64) -> f64 {
    Tail::of(ratio, a, b).ln_probability
}

/// The ratio that an F variable with `2 a` and `2 b` degrees of freedom, 2 at least of each, exceeds with
/// this probability, above 0 and below 1: Halley's steps in the logarithm of the ratio, of which that of
/// the probability is a concave function; none is longer than two of Newton's.
pub(crate) fn f_quantile(tail: f64, a: usize, b: f64) -> f64 {
    const MOST_STEPS: usize = 100;
    let mut ln_ratio = 0.0;
    for _ in 0..MOST_STEPS {
        let here = Tail::of(f64::exp(ln_ratio), a, b);
        let newton = (tail.ln() - here.ln_probability) / here.slope;
        let step = newton / (1.0 + 0.5 * newton * here.bend).max(0.5);
        ln_ratio += step;
        if step.abs() < 1e-6 {
            break; // the next step would be of its cube
        }
    }
    ln_ratio.exp()
}

/// What is above a ratio.
struct Tail {
    ln_probability: f64,
    /// Change of the same with the logarithm of the ratio.
    slope: f64,
    /// Change of the slope over the slope.
    bend: f64,
}

impl Tail {
    /// With `w = a ratio / (b + a ratio)` the probability is `(1 - w)^b sum_(i < a) t_i`,
    /// `t_i = C(b + i - 1, i) w^i`, and its logarithm has the slope `h = -(a + b - 1) w t_(a-1) / sum_(i < a) t_i`,
    /// which is minus density times ratio over probability: `h' / h = a - (a + b) w - h`.
    /// (M. Abramowitz, I. Stegun, Handbook of Mathematical Functions, 26.5.1, 26.5.6 and 26.6.2.)
    fn of(ratio: f64, a: usize, b: f64) -> Self {
        /// What a sum may reach before its scale grows.
        const LARGE: f64 = 1e200;
        /// Terms between two looks at the scale, each at most 1e9 times the one before.
        const TERMS: usize = 8;
        let scaled = a as f64 * ratio;
        let w = 1.0 / (1.0 + b / scaled); // 1 where the ratio is infinite
        let n_factors = a.saturating_sub(1);
        // in parts of a scale that grows with them: with many terms the first of them underflows
        let (mut ln_scale, mut term, mut sum) = (-b * (scaled / b).ln_1p(), 1.0, 1.0);
        for first in (0..n_factors).step_by(TERMS) {
            for i in first..n_factors.min(first + TERMS) {
                term *= w * (b + i as f64) / (i as f64 + 1.0);
                sum += term;
            }
            if sum > LARGE {
                (term, sum) = (term / LARGE, sum / LARGE);
                ln_scale += LARGE.ln();
            }
        }
        let (a, ln_probability) = (a as f64, ln_scale + sum.ln());
        let slope = -(a + b - 1.0) * w * term / sum;
        Self {
            ln_probability,
            slope,
            bend: a - (a + b) * w - slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy 1.17: `scipy.stats.f.sf(ratio, 2 * a, 2 * b)`.
    #[test]
    fn tails_are_those_of_scipy() {
        for (ratio, a, b, expected) in [
            (1.0, 1, 1.0, 0.5),
            (9.3, 1, 12.0, 0.00102239734095827),
            (0.0, 3, 4.0, 1.0),
            (2.27, 10, 990.0, 0.0010726129797984517),
            (2.6, 10, 90.0, 0.00044019540348577257),
            (1.05, 1000, 9000.0, 0.06915877921632729),
            (0.9, 1000, 99000.0, 0.9994199322550574),
            (50.0, 2, 5.0, 1.4108134842661235e-06),
            (3.0, 100, 11.0, 0.0018483978747967714),
            (2.0, 3, 2.5, 0.23197281538689354),
            (f64::INFINITY, 3, 2.5, 0.0),
        ] {
            let found = f_tail(ratio, a, b);
            assert!(
                (found - expected).abs() <= 1e-10 * expected,
                "{ratio}, {a}, {b}: {found} for {expected}"
            );
        }
    }

    /// scipy 1.17: `scipy.stats.f.isf(tail, 2 * a, 2 * b)`.
    #[test]
    fn quantiles_are_those_of_scipy() {
        for (tail, a, b, expected) in [
            (0.001, 12, 12.0, 3.735380458318059),
            (0.025, 3, 40.0, 2.5707705128340694),
            (0.975, 12, 1e9, 0.5167145911535518),
            (0.975, 1, 1.0, 0.025641025641025664),
            (0.001, 1000, 3.5, 11.708892808334411),
            (1e-6, 1000, 1000.0, 1.2371451332635424),
            (0.999, 2, 1.5, 0.0178008196367385),
        ] {
            let found = f_quantile(tail, a, b);
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{found} for {expected}"
            );
        }
    }

    #[test]
    fn a_quantile_is_exceeded_as_often_as_was_asked() {
        let freedoms = [1.0, 1.5, 2.0, 7.0, 30.0, 300.0, 1e3, 1e5, 1e9];
        for tail in [1e-12, 1e-6, 1e-3, 0.025, 0.3, 0.7, 0.975, 1.0 - 1e-9] {
            for (a, b) in [1, 2, 3, 12, 48, 200, 1000]
                .into_iter()
                .flat_map(|a| freedoms.map(|b| (a, b)))
            {
                let found = f_tail(f_quantile(tail, a, b), a, b);
                assert!(
                    (found / tail - 1.0).abs() < 1e-8,
                    "{tail}, {a}, {b}: {found}"
                );
            }
        }
    }
}
