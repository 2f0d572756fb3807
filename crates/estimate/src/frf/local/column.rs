//! Columns of complex numbers, real parts beside imaginary parts, for the vector instructions of the machine.

use std::iter::zip;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

/// Columns are as long as a multiple of this, by zeros at their end: so many numbers or fewer go into one register.
const LANES: usize = 8;

/// A column of complex numbers: its real parts, then its imaginary parts.
#[derive(Debug, Clone, Default)]
pub(crate) struct Column(Vec<f64>);

/// A real number for each row of a column.
#[derive(Debug, Clone)]
pub(super) struct Reals(Vec<f64>);

impl Column {
    /// A column of so many numbers, one after the other.
    pub(crate) fn of(n: usize, values: impl Iterator<Item = Complex64>) -> Self {
        let half = n.next_multiple_of(LANES);
        let mut column = Self(vec![0.0; 2 * half]);
        for (row, value) in values.take(half).enumerate() {
            column.0[row] = value.re;
            column.0[half + row] = value.im;
        }
        column
    }

    pub(super) fn zeros_like(&self) -> Self {
        Self(vec![0.0; self.0.len()])
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

    /// Adds another column times a number.
    pub(super) fn add(&mut self, factor: Complex64, other: &Self) {
        Arch::new().dispatch(Add(self, factor, other));
    }

    /// Takes off what it has of directions, one after the other, and writes down how much that was.
    pub(super) fn take_off<'q>(
        &mut self,
        directions: impl Iterator<Item = &'q Self>,
        shares: &mut Vec<Complex64>,
    ) {
        Arch::new().dispatch(TakeOff(self, directions, shares));
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.0.iter_mut().for_each(|value| *value *= factor);
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

    fn with(&self, other: &Self, of: fn(Complex64, Complex64) -> Complex64) -> Self {
        let rows = zip(self.values(), other.values()).map(|(a, b)| of(a, b));
        Self::of(self.n_rows(), rows)
    }

    /// `1 + c_1 x + c_2 x^2 ...`
    pub(super) fn polynomial(x: &Reals, coefficients: &[Complex64]) -> Self {
        let at = |x: &f64| {
            let powers = coefficients.iter().rev();
            Complex64::ONE + powers.fold(Complex64::ZERO, |sum, c| (sum + c) * x)
        };
        Self::of(x.0.len(), x.0.iter().map(at))
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
}

/// A quotient; 0 over nothing: a column that says nothing new, a denominator that vanishes.
pub(super) fn over(value: Complex64, divisor: Complex64) -> Complex64 {
    if divisor == Complex64::ZERO {
        Complex64::ZERO
    } else {
        value / divisor
    }
}

struct Dot<'c>(&'c Column, &'c Column);
struct Add<'c>(&'c mut Column, Complex64, &'c Column);
struct TakeOff<'c, I>(&'c mut Column, I, &'c mut Vec<Complex64>);

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

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self(sum, factor, other) = self;
        let [re, im, minus_im] = [factor.re, factor.im, -factor.im].map(|x| simd.splat_f64s(x));
        let half = sum.n_rows();
        let (sum_re, sum_im) = sum.0.split_at_mut(half);
        let sums = zip(S::as_mut_simd_f64s(sum_re).0, S::as_mut_simd_f64s(sum_im).0);
        for ((sum_re, sum_im), (x_re, x_im)) in zip(sums, registers::<S>(other)) {
            *sum_re = simd.mul_add_f64s(minus_im, *x_im, simd.mul_add_f64s(re, *x_re, *sum_re));
            *sum_im = simd.mul_add_f64s(im, *x_re, simd.mul_add_f64s(re, *x_im, *sum_im));
        }
    }
}

impl<'q, I: Iterator<Item = &'q Column>> WithSimd for TakeOff<'_, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for direction in self.1 {
            let share = Dot(direction, self.0).with_simd(simd);
            Add(self.0, -share, direction).with_simd(simd);
            self.2.push(share);
        }
    }
}

/// The real and imaginary parts of a column, register by register.
#[inline(always)]
fn registers<S: Simd>(column: &Column) -> impl Iterator<Item = (&S::f64s, &S::f64s)> {
    let (re, im) = column.parts();
    zip(S::as_simd_f64s(re).0, S::as_simd_f64s(im).0)
}
