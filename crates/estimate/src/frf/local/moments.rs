//! Moments of two signals over the lines of a window: sums of their products times powers of the places.

use std::iter::zip;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

use crate::frf::local::column::{Column, Reals, registers};
use crate::frf::local::window::N_TERMS;

/// Powers of the places that products of two polynomials have.
const N_POWERS: usize = 2 * N_TERMS - 1;

/// `sum_k w_k^2 x_k^n conj(a_k) b_k`, n = 0, 1, ...
pub(super) type Moments = [Complex64; N_POWERS];

/// The lines of a window: where they are, and what they weigh.
pub(super) struct Lines {
    pub(super) places: Reals,
    /// The squares of the weights.
    pub(super) weights: Reals,
}

impl Lines {
    /// A column of zeros.
    pub(super) fn zeros(&self) -> Column {
        Column::zeros(self.places.len())
    }

    /// The moments of two signals.
    pub(super) fn moments(&self, a: &Column, b: &Column) -> Moments {
        Arch::new().dispatch(Sums(self, a, b))
    }
}

struct Sums<'c>(&'c Lines, &'c Column, &'c Column);

impl WithSimd for Sums<'_> {
    type Output = Moments;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Moments {
        let Self(lines, a, b) = self;
        let mut sums = [[simd.splat_f64s(0.0); 2]; N_POWERS];
        let lines = zip(
            lines.places.registers::<S>(),
            lines.weights.registers::<S>(),
        );
        let pairs = zip(registers::<S>(a), registers::<S>(b));
        for ((x, w), ((a_re, a_im), (b_re, b_im))) in zip(lines, pairs) {
            let [a_re, a_im] = [a_re, a_im].map(|part| simd.mul_f64s(*w, *part));
            let re = simd.mul_add_f64s(a_re, *b_re, simd.mul_f64s(a_im, *b_im));
            let im = simd.sub_f64s(simd.mul_f64s(a_re, *b_im), simd.mul_f64s(a_im, *b_re));
            let mut product = [re, im];
            for sum in &mut sums {
                *sum = std::array::from_fn(|part| simd.add_f64s(sum[part], product[part]));
                product = product.map(|part| simd.mul_f64s(part, *x));
            }
        }
        sums.map(|[re, im]| Complex64::new(simd.reduce_sum_f64s(re), simd.reduce_sum_f64s(im)))
    }
}
