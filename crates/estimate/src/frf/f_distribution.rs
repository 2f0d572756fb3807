//! F distribution with an even number of degrees of freedom above, as ratios of powers of complex numbers have.

/// Probability that an F variable with `2 a` and `2 b` degrees of freedom exceeds `ratio`.
pub(crate) fn f_tail(ratio: f64, a: usize, b: f64) -> f64 {
    ln_f_tail(ratio, a, b).exp()
}

/// Logarithm of [`f_tail`]: with `w = a ratio / (b + a ratio)` it is that of
/// `(1 - w)^b sum_(i < a) C(b + i - 1, i) w^i`. (M. Abramowitz, I. Stegun, Handbook of Mathematical
/// Functions, 26.5.6 and 26.6.2.)
pub(crate) fn ln_f_tail(ratio: f64, a: usize, b: f64) -> f64 {
    let scaled = a as f64 * ratio;
    let w = scaled / (b + scaled);
    // in parts of a scale that grows with them: with many terms the first of them underflows
    let (mut ln_scale, mut term, mut sum) = (-b * (scaled / b).ln_1p(), 1.0, 1.0);
    for i in 0..a.saturating_sub(1) {
        term *= w * (b + i as f64) / (i as f64 + 1.0);
        sum += term;
        if sum > LARGE {
            (term, sum) = (term / LARGE, sum / LARGE);
            ln_scale += LARGE.ln();
        }
    }
    ln_scale + sum.ln()
}

/// What a sum may reach before its scale grows.
const LARGE: f64 = 1e200;

/// The ratio that an F variable with `2 a` and `2 b` degrees of freedom exceeds with this probability, by bisection.
pub(crate) fn f_quantile(tail: f64, a: usize, b: f64) -> f64 {
    const WIDEST: f64 = 25.0; // logarithm of a ratio that is never reached
    let (mut low, mut high) = (-WIDEST, WIDEST);
    while high - low > 1e-10 {
        let middle = 0.5 * (low + high);
        if ln_f_tail(middle.exp(), a, b) > tail.ln() {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0.5 * (low + high)).exp()
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
        ] {
            let found = f_quantile(tail, a, b);
            assert!(
                (found / expected - 1.0).abs() < 1e-7,
                "{found} for {expected}"
            );
        }
    }
}
