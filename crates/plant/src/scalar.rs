//! Number type of the dynamics: one f64, or the numbers of several machines side by side.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the dynamics ask of a number. Nothing branches on it: within a mode (stuck or slipping, on
/// one branch of the spring) the right-hand side is one formula, and what differs from mode to mode
/// is a lane value too (`Regime`).
pub(crate) trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The same value in every lane.
    fn splat(value: f64) -> Self;

    /// Sine, lane by lane (torque ripple).
    #[must_use]
    fn sin(self) -> Self;

    /// Sine and cosine, lane by lane (joint angles).
    #[must_use]
    fn sin_cos(self) -> (Self, Self);
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

impl Scalar for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    fn sin(self) -> Self {
        self.sin()
    }

    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }
}
