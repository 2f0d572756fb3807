//! Sine and cosine in one formula without branches: the same digits for a number alone and in lanes.

use crate::scalar::Number;

/// A number that may be an angle of a joint.
pub(crate) trait Angle: Number {
    /// Size, lane by lane.
    #[must_use]
    fn abs(self) -> Self;

    /// Sine and cosine, lane by lane, by one formula whatever the width.
    #[must_use]
    fn sin_cos(self) -> (Self, Self);
}

/// Angles in rad up to which the whole quarter turns are taken off exactly.
pub(crate) const LARGEST_RAD: f64 = 1e6;

/// pi/2 in three parts (Cody and Waite): the first two have 33 digits each, so that their products
/// with fewer than 2^20 quarter turns are exact.
const QUARTER: [f64; 3] = [
    1.5707963267341256,
    6.077100506303966e-11,
    2.0222662487959506e-21,
];

/// 1.5 * 2^52: a number of a size below 2^51 added to it loses its fraction, by rounding.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Coefficients of x^3, x^5, ... in sin x for |x| <= pi/4: fdlibm, `k_sin.c` (Sun Microsystems 1993).
const SINE: [f64; 6] = [
    -0.16666666666666632,
    0.00833333333332249,
    -0.0001984126982985795,
    2.7557313707070068e-06,
    -2.5050760253406863e-08,
    1.58969099521155e-10,
];

/// Coefficients of x^4, x^6, ... in cos x for |x| <= pi/4: fdlibm, `k_cos.c`.
const COSINE: [f64; 6] = [
    0.0416666666666666,
    -0.001388888888887411,
    2.480158728947673e-05,
    -2.7557314351390663e-07,
    2.087572321298175e-09,
    -1.1359647557788195e-11,
];

/// Sine and cosine of angles in rad up to [`LARGEST_RAD`], to a unit in the last place up to 10 rad
/// and to two beyond: those of what is left of an angle without its whole quarter turns, turned by these.
#[inline(always)]
pub(crate) fn sin_cos<N: Angle>(angle: N) -> (N, N) {
    let turns = whole(angle * angle.like(std::f64::consts::FRAC_2_PI));
    let [high, middle, low] = QUARTER;
    let x = angle - turns * turns.like(high) - turns * turns.like(middle) - turns * turns.like(low);
    let (sin, cos) = (sine(x), cosine(x));
    // -2, ..., 2 quarter turns have the sine 0, -1, 0, 1, 0 and the cosine -1, 0, 1, 0, -1
    let quarters = turns - whole(turns * turns.like(0.25)) * turns.like(4.0);
    let turned_cos = turns.like(1.0) - quarters.abs();
    let turned_sin = quarters * (turns.like(1.0) + turned_cos);
    (
        sin * turned_cos + cos * turned_sin,
        cos * turned_cos - sin * turned_sin,
    )
}

/// The nearest whole number.
#[inline(always)]
fn whole<N: Angle>(x: N) -> N {
    (x + x.like(ROUNDING)) - x.like(ROUNDING)
}

/// sin x for |x| <= pi/4.
#[inline(always)]
fn sine<N: Angle>(x: N) -> N {
    let square = x * x;
    x + (x * square) * polynomial(&SINE, square)
}

/// cos x for |x| <= pi/4; what 1 - x^2/2 loses by rounding is added again.
#[inline(always)]
fn cosine<N: Angle>(x: N) -> N {
    let (square, one) = (x * x, x.like(1.0));
    let half = x.like(0.5) * square;
    let near = one - half;
    near + (((one - near) - half) + square * square * polynomial(&COSINE, square))
}

/// c_0 + c_1 x + c_2 x^2 + ...
#[inline(always)]
fn polynomial<N: Angle>(coefficients: &[f64; 6], x: N) -> N {
    let mut sum = x.like(coefficients[5]);
    for power in (0..5).rev() {
        sum = sum * x + x.like(coefficients[power]);
    }
    sum
}

impl Angle for f64 {
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        if self.abs() > LARGEST_RAD {
            self.sin_cos()
        } else {
            sin_cos(self)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use frfid_signals::random::stream;
    use rand::RngExt as _;

    use super::{LARGEST_RAD, sin_cos};

    /// Distance in units in the last place of the larger of two numbers.
    fn units(found: f64, expected: f64) -> f64 {
        let unit = expected.abs().next_up() - expected.abs();
        (found - expected).abs() / unit
    }

    /// Angles of every size up to the largest, and the floating-point neighbours of multiples of
    /// pi/4, where sine, cosine or the rounding of the turns change most.
    fn angles() -> Vec<f64> {
        let mut random = stream(1, "angles", &[]);
        let largest = LARGEST_RAD.ln();
        let sizes = (0..200_000).map(|_| random.random_range(-20.0..largest).exp());
        let multiples = (1..100_000).map(|k| f64::from(k) * FRAC_PI_4);
        let beside = multiples.flat_map(|x| [x.next_down(), x, x.next_up()]);
        sizes.chain(beside).flat_map(|x| [x, -x]).collect()
    }

    #[test]
    fn sines_and_cosines_are_those_of_the_library_to_a_unit_in_the_last_place_or_two() {
        for x in angles() {
            let ((sin, cos), expected) = (sin_cos(x), x.sin_cos());
            let error = units(sin, expected.0).max(units(cos, expected.1));
            let bound = if x.abs() <= 10.0 { 1.0 } else { 2.0 };
            assert!(error <= bound, "{error} units at {x}");
        }
    }
}
