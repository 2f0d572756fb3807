//! Root of a scalar function between two points of opposite sign.

/// Finds a root of `f` between `a` and `b`, where `f(a) = fa` and `f(b) = fb` have opposite signs,
/// to rounding level: inverse quadratic steps where three points promise a good one, else bisection
/// (Chandrupatla, Adv. Eng. Softw. 28 (1997) 145). At most about 100 evaluations, usually 6 to 10.
/// Returns the point with the smaller |f| of the last bracket.
pub(crate) fn root(
    mut f: impl FnMut(f64) -> f64,
    (mut a, mut fa): (f64, f64),
    (mut b, mut fb): (f64, f64),
) -> f64 {
    let mut share = 0.5; // where in the bracket, from a, to look next
    for _ in 0..100 {
        let x = a + share * (b - a);
        let fx = f(x);
        // c is the point that leaves: the old end of the side on which x lies
        let (c, fc);
        if (fx > 0.0) == (fa > 0.0) {
            (c, fc) = (a, fa);
        } else {
            (c, fc) = (b, fb);
            (b, fb) = (a, fa);
        }
        (a, fa) = (x, fx);
        let (best, f_best) = if fa.abs() < fb.abs() {
            (a, fa)
        } else {
            (b, fb)
        };
        let tolerance = 2.0 * f64::EPSILON * best.abs() + f64::MIN_POSITIVE;
        let smallest_share = tolerance / (b - a).abs();
        if f_best == 0.0 || smallest_share > 0.5 {
            return best;
        }
        let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
        share = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        } else {
            0.5
        };
        share = share.clamp(smallest_share, 1.0 - smallest_share);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::root;

    type Function = fn(f64) -> f64;

    /// Root and number of evaluations.
    fn count(f: impl Fn(f64) -> f64, a: f64, b: f64) -> (f64, usize) {
        let mut calls = 0;
        let counted = |x| {
            calls += 1;
            f(x)
        };
        (root(counted, (a, f(a)), (b, f(b))), calls)
    }

    #[test]
    fn roots_are_found_to_rounding_in_few_evaluations() {
        let cases: [(Function, f64); 5] = [
            (|x| 0.3 - x, 0.3),
            (|x| x * x - 0.5, 0.5_f64.sqrt()),
            (|x| f64::exp(-30.0 * x) - 0.5, 2.0_f64.ln() / 30.0),
            (|x| x - 1e-9, 1e-9),
            (|x| (x - 0.7).powi(3), 0.7),
        ];
        for (f, truth) in cases {
            let (found, calls) = count(f, 0.0, 1.0);
            let tolerance = if truth == 0.7 {
                1e-5
            } else {
                4.0 * f64::EPSILON * truth
            }; // a triple root is flat
            assert!(
                (found - truth).abs() <= tolerance && calls < 60,
                "{found} for {truth} in {calls} calls"
            );
        }
    }

    #[test]
    fn a_step_function_ends_by_bisection() {
        let (found, calls) = count(|x| if x < 0.123 { 1.0 } else { -1.0 }, 0.0, 1.0);
        assert!((found - 0.123).abs() < 1e-15 && calls < 100);
    }
}
