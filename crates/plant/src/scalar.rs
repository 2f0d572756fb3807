//! Number type of the dynamics: one f64, or the numbers of several machines side by side.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What formulas ask of a number. Nothing branches on it: within a mode (stuck or slipping, on one
/// branch of the spring) the right-hand side is one formula, and what differs from mode to mode is
/// a lane value too (`Regime`).
pub(crate) trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The same value in every lane of a number as wide as this one.
    #[must_use]
    fn like(self, value: f64) -> Self;
}

/// A number of a width that its type tells.
pub(crate) trait Scalar: Number {
    /// The same value in every lane.
    fn splat(value: f64) -> Self;

    /// Sine, lane by lane (torque ripple).
    #[must_use]
    fn sin(self) -> Self;
}

/// A number of each axis or lane; `array::from_fn` is not always inlined.
#[inline(always)]
pub(crate) fn each<L: Scalar, const N: usize>(number: impl Fn(usize) -> L) -> [L; N] {
    let mut numbers = [L::splat(0.0); N];
    for (index, slot) in numbers.iter_mut().enumerate() {
        *slot = number(index);
    }
    numbers
}

impl Number for f64 {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        value
    }
}

impl Scalar for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    fn sin(self) -> Self {
        self.sin()
    }
}
