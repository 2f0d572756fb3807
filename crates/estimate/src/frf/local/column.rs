//! Columns of complex numbers, real parts beside imaginary parts, for the vector instructions of the machine.

use std::iter::zip;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use crate::frf::local::window::N_TERMS;

/// Columns are as long as a multiple of this, by zeros at their end: so many numbers or fewer go into one register.
const LANES: usize = 8;

/// A column of complex numbers: its real parts, then its imaginary parts.
#[derive(Debug, Clone, Default)]
pub(crate) struct Column(Vec<f64>);

/// A real number for each row of a column.
#[derive(Debug, Clone, Default)]
pub(super) struct Reals(Vec<f64>);

impl Column {
    /// A column of so many numbers, one after the other.
    pub(crate) fn of(n: usize, values: impl Iterator<Item = Complex64>) -> Self {
        let mut column = Self::zeros(n);
        let half = column.n_rows();
        for (row, value) in values.take(half).enumerate() {
            column.0[row] = value.re;
            column.0[half + row] = value.im;
        }
        column
    }

    /// Of so many zeros.
    pub(super) fn zeros(n: usize) -> Self {
        Self(vec![0.0; 2 * n.next_multiple_of(LANES)])
    }

    pub(super) fn is_zero(&self) -> bool {
        self.norm_squared() == 0.0
    }

    pub(crate) fn norm_squared(&self) -> f64 {
        self.dot(self).re
    }

    /// `self^H other`.
    pub(super) fn dot(&self, other: &Self) -> Complex64 {
        Arch::new().dispatch(Dot(self, other))
    }

    /// Adds another column, every number times a polynomial at its place.
    pub(super) fn add_polynomial(
        &mut self,
        coefficients: [Complex64; N_TERMS],
        places: &Reals,
        other: &Self,
    ) {
        Arch::new().dispatch(AddPolynomial(self, coefficients, places, other));
    }

    /// Every number less that of another column.
    pub(super) fn less(&self, other: &Self) -> Self {
        Self(zip(&self.0, &other.0).map(|(a, b)| a - b).collect())
    }

    /// Every number times the real one of its row.
    pub(super) fn times(&self, factors: &Reals) -> Self {
        let both = zip(&self.0, factors.0.iter().chain(&factors.0));
        Self(both.map(|(value, factor)| value * factor).collect())
    }

    /// Every number times the conjugate of that of another column.
    pub(super) fn times_conjugate(&self, other: &Self) -> Self {
        self.with(other, |a, b| a * b.conj())
    }

    /// Every number over that of another column, 0 over 0.
    pub(super) fn over(&self, other: &Self) -> Self {
        self.with(other, over)
    }

    fn with(&self, other: &Self, of: impl Fn(Complex64, Complex64) -> Complex64) -> Self {
        let rows = zip(self.values(), other.values()).map(|(a, b)| of(a, b));
        Self::of(self.n_rows(), rows)
    }

    fn n_rows(&self) -> usize {
        self.0.len() / 2
    }

    /// Real and imaginary parts.
    #[inline(always)]
    fn parts(&self) -> (&[f64], &[f64]) {
        self.0.split_at(self.n_rows())
    }

    fn values(&self) -> impl Iterator<Item = Complex64> {
        let (re, im) = self.parts();
        zip(re, im).map(|(re, im)| Complex64::new(*re, *im))
    }
}

impl Reals {
    /// Some numbers, and zeros behind them.
    pub(super) fn of(values: &[f64]) -> Self {
        let mut all = values.to_vec();
        all.resize(values.len().next_multiple_of(LANES), 0.0);
        Self(all)
    }

    pub(super) fn map(&self, of: impl Fn(f64) -> f64) -> Self {
        Self(self.0.iter().copied().map(of).collect())
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Product row by row.
    pub(super) fn times(&self, other: &Self) -> Self {
        Self(zip(&self.0, &other.0).map(|(a, b)| a * b).collect())
    }

    /// The squares of a column's sizes.
    pub(super) fn norms_squared(column: &Column) -> Self {
        Self(column.values().map(|value| value.norm_sqr()).collect())
    }

    pub(super) fn largest(&self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }

    /// The numbers, register by register.
    #[inline(always)]
    pub(super) fn registers<S: Simd>(&self) -> &[S::f64s] {
        S::as_simd_f64s(&self.0).0
    }
}

/// A quotient; 0 over a denominator that vanishes.
fn over(value: Complex64, divisor: Complex64) -> Complex64 {
    if divisor == Complex64::ZERO {
        Complex64::ZERO
    } else {
        value / divisor
    }
}

struct Dot<'c>(&'c Column, &'c Column);
struct AddPolynomial<'c>(&'c mut Column, [Complex64; N_TERMS], &'c Reals, &'c Column);

impl WithSimd for Dot<'_> {
    type Output = Complex64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Complex64 {
        let zero = simd.splat_f64s(0.0);
        let (mut re, mut im, mut less) = ([zero; 2], zero, zero);
        let (a, b) = (registers::<S>(self.0), registers::<S>(self.1));
        for ((a_re, a_im), (b_re, b_im)) in zip(a, b) {
            re[0] = simd.mul_add_f64s(*a_re, *b_re, re[0]);
            re[1] = simd.mul_add_f64s(*a_im, *b_im, re[1]);
            im = simd.mul_add_f64s(*a_re, *b_im, im);
            less = simd.mul_add_f64s(*a_im, *b_re, less);
        }
        Complex64::new(
            simd.reduce_sum_f64s(simd.add_f64s(re[0], re[1])),
            simd.reduce_sum_f64s(simd.sub_f64s(im, less)),
        )
    }
}

impl WithSimd for AddPolynomial<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self(sum, coefficients, places, other) = self;
        let re = coefficients.map(|c| simd.splat_f64s(c.re));
        let im = coefficients.map(|c| simd.splat_f64s(c.im));
        let at = |x, [c0, c1, c2]: [S::f64s; N_TERMS]| {
            simd.mul_add_f64s(x, simd.mul_add_f64s(x, c2, c1), c0)
        };
        let half = sum.n_rows();
        let (sum_re, sum_im) = sum.0.split_at_mut(half);
        let sums = zip(S::as_mut_simd_f64s(sum_re).0, S::as_mut_simd_f64s(sum_im).0);
        let signal = zip(places.registers::<S>(), registers::<S>(other));
        for ((sum_re, sum_im), (x, (x_re, x_im))) in zip(sums, signal) {
            let (re, im) = (at(*x, re), at(*x, im));
            let less = simd.mul_f64s(im, *x_im);
            *sum_re = simd.sub_f64s(simd.mul_add_f64s(re, *x_re, *sum_re), less);
            *sum_im = simd.mul_add_f64s(im, *x_re, simd.mul_add_f64s(re, *x_im, *sum_im));
        }
    }
}

/// The real and imaginary parts of a column, register by register.
#[inline(always)]
pub(super) fn registers<S: Simd>(column: &Column) -> impl Iterator<Item = (&S::f64s, &S::f64s)> {
    let (re, im) = column.parts();
    zip(S::as_simd_f64s(re).0, S::as_simd_f64s(im).0)
}
