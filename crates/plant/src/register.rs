//! Register: a number of each of as many machines as a vector register holds, computed as an f64 alone
//! would be, operation by operation (never fused).
//!
//! Formulas as long as those of an arm are compiled a register at a time: written lane by lane, they
//! would keep the compiler busy for minutes.

use std::iter::zip;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::slice::{from_mut, from_ref};

use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

use crate::lanes::Lanes;
use crate::scalar::Number;
use crate::sine::{Angle, LARGEST_RAD, sin_cos};

/// A number of each machine in a register, and the instructions there are for it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Register<S: Simd> {
    simd: S,
    numbers: S::f64s,
}

impl<S: Simd> Register<S> {
    /// The register of this index among those that lanes fill.
    #[inline(always)]
    pub(crate) fn load<const N: usize>(simd: S, lanes: &Lanes<N>, index: usize) -> Self {
        const {
            assert!(
                N.is_multiple_of(S::F64_LANES),
                "lanes beyond the last register"
            );
        };
        let numbers = S::as_simd_f64s(&lanes.0).0[index];
        Self { simd, numbers }
    }

    /// Puts the numbers into the lanes from which such a register is loaded.
    #[inline(always)]
    pub(crate) fn store<const N: usize>(self, lanes: &mut Lanes<N>, index: usize) {
        S::as_mut_simd_f64s(&mut lanes.0).0[index] = self.numbers;
    }

    #[inline(always)]
    fn with(self, numbers: S::f64s) -> Self {
        Self { numbers, ..self }
    }

    #[inline(always)]
    fn each(&self) -> &[f64] {
        cast_slice(from_ref(&self.numbers))
    }

    /// Sine and cosine of each number alone.
    #[cold]
    #[inline(never)]
    fn sin_cos_each(self) -> (Self, Self) {
        let (mut sin, mut cos) = (self.numbers, self.numbers);
        let both = zip(
            cast_slice_mut(from_mut(&mut sin)),
            cast_slice_mut(from_mut(&mut cos)),
        );
        for ((sin, cos), angle) in zip(both, self.each()) {
            (*sin, *cos) = Angle::sin_cos(*angle);
        }
        (self.with(sin), self.with(cos))
    }
}

macro_rules! by_instruction {
    ($($operation:ident $name:ident $instruction:ident),*) => {$(
        impl<S: Simd> $operation for Register<S> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(self.simd.$instruction(self.numbers, other.numbers))
            }
        }
    )*};
}

by_instruction!(Add add add_f64s, Sub sub sub_f64s, Mul mul mul_f64s, Div div div_f64s);

impl<S: Simd> Neg for Register<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let sign = self.simd.splat_f64s(-0.0);
        self.with(self.simd.xor_f64s(self.numbers, sign))
    }
}

impl<S: Simd> Number for Register<S> {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        self.with(self.simd.splat_f64s(value))
    }
}

impl<S: Simd> Angle for Register<S> {
    #[inline(always)]
    fn abs(self) -> Self {
        let size = self.simd.splat_f64s(f64::from_bits(u64::MAX >> 1));
        self.with(self.simd.and_f64s(self.numbers, size))
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let mut any_large = false;
        for angle in self.each() {
            any_large |= angle.abs() > LARGEST_RAD;
        }
        if any_large {
            self.sin_cos_each()
        } else {
            sin_cos(self)
        }
    }
}
