//! Lanes: a number of each of several machines side by side, for the vector instructions of the machine.
//!
//! Each lane is computed as an f64 alone would be, operation by operation (never fused), so that a
//! machine moves to the last digit as it does alone. What is inlined into a function that
//! `pulp::Arch` dispatches becomes vector instructions.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::scalar::{Number, Scalar, each};

/// Joints side by side, the most of any machines: two registers or more, so that one need not wait for the other; with
/// more a joint's state would not fit.
pub(crate) const LANES: usize = 8;

/// A number of each of `N` machines.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f64; N]);

impl<const N: usize> Lanes<N> {
    /// The number that a function of the lane gives.
    #[inline(always)]
    pub(crate) fn of(number: impl Fn(usize) -> f64) -> Self {
        Self(each(number))
    }
}

macro_rules! lane_by_lane {
    ($($operation:ident $name:ident),*) => {$(
        impl<const N: usize> $operation for Lanes<N> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self::of(|lane| self.0[lane].$name(other.0[lane]))
            }
        }
    )*};
}

lane_by_lane!(Add add, Sub sub, Mul mul, Div div);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::of(|lane| -self.0[lane])
    }
}

impl<const N: usize> Number for Lanes<N> {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self::splat(value)
    }
}

impl<const N: usize> Scalar for Lanes<N> {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; N])
    }

    #[inline(always)]
    fn sin(self) -> Self {
        Self::of(|lane| self.0[lane].sin())
    }
}
