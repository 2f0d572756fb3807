//! Ramp from 0 to 1 with continuous jerk: the step of degree 7 with its derivatives and its integral.

/// Largest slope of [`Ramp`], times its duration.
pub(crate) const STEEPEST: f64 = 35.0 / 16.0;
/// Largest second derivative, times the duration squared.
pub(crate) const MOST_BENT: f64 = 7.5132;
/// Largest third derivative, times the duration cubed.
pub(crate) const MOST_JERKED: f64 = 52.5;

/// `s(x) = x^4 (35 - 84 x + 70 x^2 - 20 x^3)` with `x = t/duration`, 0 before and 1 after; its first
/// three derivatives are zero at both ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ramp {
    /// Duration in s; 0 for a step.
    pub(crate) duration_s: f64,
}

impl Ramp {
    /// s and its first three derivatives by time at `time_s` after its begin.
    pub(crate) fn at(self, time_s: f64) -> [f64; 4] {
        let t = self.duration_s;
        if time_s <= 0.0 {
            return [0.0; 4];
        }
        if time_s >= t {
            return [1.0, 0.0, 0.0, 0.0];
        }
        let x = time_s / t;
        let z = 1.0 - x;
        let value = x.powi(4) * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x)));
        let slope = 140.0 * (x * z).powi(3);
        let bend = 420.0 * (x * z).powi(2) * (z - x);
        let jerk = 840.0 * x * z * (1.0 - 5.0 * x * z);
        [value, slope / t, bend / t.powi(2), jerk / t.powi(3)]
    }

    /// Integral of s in s from its begin to `time_s`, past the end at slope 1.
    pub(crate) fn integral(self, time_s: f64) -> f64 {
        let t = self.duration_s;
        if time_s <= 0.0 {
            return 0.0;
        }
        if time_s >= t {
            return time_s - 0.5 * t;
        }
        t * area(time_s / t)
    }
}

/// Integral of the step from 0 to x.
fn area(x: f64) -> f64 {
    x.powi(5) * (7.0 + x * (-14.0 + x * (10.0 - 2.5 * x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_derivative_is_the_slope_of_the_one_before() {
        let ramp = Ramp { duration_s: 0.7 };
        let h = 1e-5;
        for k in 1..70 {
            let time_s = 0.01 * f64::from(k);
            let [before, here, after] = [-h, 0.0, h].map(|shift| ramp.at(time_s + shift));
            for order in 0..3 {
                let slope = (after[order] - before[order]) / (2.0 * h);
                assert!((slope - here[order + 1]).abs() < 1e-4 * 153.0);
            }
            let area = ramp.integral(time_s + h) - ramp.integral(time_s - h);
            assert!((area / (2.0 * h) - here[0]).abs() < 1e-8);
        }
    }

    #[test]
    fn the_largest_derivatives_are_those_stated() {
        let ramp = Ramp { duration_s: 1.0 };
        let largest = |order: usize| {
            let instants = (0..=10_000).map(|k| ramp.at(f64::from(k) * 1e-4)[order].abs());
            instants.fold(0.0, f64::max)
        };
        for (order, stated) in [(1, STEEPEST), (2, MOST_BENT), (3, MOST_JERKED)] {
            assert!((largest(order) / stated - 1.0).abs() < 1e-4);
        }
        assert_eq!(
            (ramp.at(1.0), ramp.integral(2.0)),
            ([1.0, 0.0, 0.0, 0.0], 1.5)
        );
    }
}
