//! Gaussian elimination with partial pivoting: A X = B in complex numbers, one pair of matrices after
//! the other in the same place.
//!
//! Every number comes out as by an LU decomposition, column by column, and two substitutions: nothing
//! is added up in another order, and products and sums are not fused.

use std::iter::zip;
use std::ops::Range;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};

/// The matrix [A | B], then [U | X], row by row: the real parts of a row, then its imaginary parts, for
/// the vector instructions of the machine.
pub(crate) struct Elimination {
    n: usize,
    width: usize,
    parts: Vec<f64>,
}

impl Elimination {
    /// Room for A (n, n) and B (n, m).
    pub(crate) fn new(n: usize, m: usize) -> Self {
        let width = n + m;
        Self {
            n,
            width,
            parts: vec![0.0; n * 2 * width],
        }
    }

    /// Puts a number into [A | B].
    pub(crate) fn set(&mut self, row: usize, column: usize, value: Complex64) {
        let place = row * 2 * self.width + column;
        self.parts[place] = value.re;
        self.parts[place + self.width] = value.im;
    }

    /// Puts X in the place of B; `false` where A is singular.
    pub(crate) fn solve(&mut self) -> bool {
        Arch::new().dispatch(Solve(self))
    }

    /// An entry of X.
    pub(crate) fn solution(&self, row: usize, column: usize) -> Complex64 {
        self.get(row, self.n + column)
    }

    #[inline(always)]
    fn get(&self, row: usize, column: usize) -> Complex64 {
        let place = row * 2 * self.width + column;
        Complex64::new(self.parts[place], self.parts[place + self.width])
    }

    /// Clears a column of A beneath its diagonal; `false` where nothing is left of it.
    #[inline(always)]
    fn eliminate(&mut self, column: usize) -> bool {
        let length = 2 * self.width;
        let pivot = self.pivot(column);
        let (above, beneath) = self.parts.split_at_mut((column + 1) * length);
        let row = &mut above[column * length..];
        if pivot > column {
            row.swap_with_slice(&mut beneath[(pivot - column - 1) * length..][..length]);
        }
        let diagonal = Complex64::new(row[column], row[self.width + column]);
        let inverse = 1.0 / diagonal;
        let rest = column + 1..self.width;
        for other in beneath.chunks_exact_mut(length) {
            let factor = Complex64::new(other[column], other[self.width + column]) * inverse;
            subtract(other, factor, row, rest.clone());
        }
        diagonal != Complex64::ZERO
    }

    /// The row from the diagonal on with the largest number of a column.
    #[inline(always)]
    fn pivot(&self, column: usize) -> usize {
        let size = |row| {
            let value: Complex64 = self.get(row, column);
            value.l1_norm()
        };
        (column + 1..self.n).fold(
            column,
            |best, row| {
                if size(row) > size(best) { row } else { best }
            },
        )
    }

    /// X from U, once everything beneath its diagonal is cleared: a row, then its share of those above.
    #[inline(always)]
    fn substitute(&mut self, row: usize) {
        let length = 2 * self.width;
        let diagonal = self.get(row, row);
        for column in self.n..self.width {
            let value = self.get(row, column) / diagonal;
            self.set(row, column, value);
        }
        let (above, from_here) = self.parts.split_at_mut(row * length);
        for other in above.chunks_exact_mut(length) {
            let factor = Complex64::new(other[row], other[self.width + row]);
            subtract(other, factor, from_here, self.n..self.width);
        }
    }
}

/// Subtracts a multiple of a row from another one.
#[inline(always)]
fn subtract(other: &mut [f64], factor: Complex64, row: &[f64], columns: Range<usize>) {
    let width = other.len() / 2;
    let (other_re, other_im) = other.split_at_mut(width);
    let (re, im) = row[..2 * width].split_at(width);
    let others = zip(
        &mut other_re[columns.clone()],
        &mut other_im[columns.clone()],
    );
    let numbers = zip(&re[columns.clone()], &im[columns]);
    for ((other_re, other_im), (re, im)) in zip(others, numbers) {
        *other_re -= re * factor.re - im * factor.im;
        *other_im -= re * factor.im + im * factor.re;
    }
}

struct Solve<'a>(&'a mut Elimination);

impl WithSimd for Solve<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self(system) = self;
        let is_regular = (0..system.n).all(|column| system.eliminate(column));
        if is_regular {
            (0..system.n).rev().for_each(|row| system.substitute(row));
        }
        is_regular
    }
}

#[cfg(test)]
mod tests {
    use frfid_signals::random::{normal, stream};
    use nalgebra::DMatrix;

    use super::*;

    fn solved(a: &DMatrix<Complex64>, b: &DMatrix<Complex64>) -> Option<DMatrix<Complex64>> {
        let (n, m) = b.shape();
        let mut system = Elimination::new(n, m);
        for row in 0..n {
            for column in 0..n {
                system.set(row, column, a[(row, column)]);
            }
            for column in 0..m {
                system.set(row, n + column, b[(row, column)]);
            }
        }
        let x = |system: Elimination| {
            DMatrix::from_fn(n, m, |row, column| system.solution(row, column))
        };
        system.solve().then(|| x(system))
    }

    #[test]
    fn it_is_what_an_lu_decomposition_finds() {
        let mut rng = stream(1, "systems", &[]);
        for (n, m) in [(1, 1), (2, 3), (4, 1), (12, 3), (24, 6), (5, 0)] {
            let mut number = |_, _| Complex64::new(normal(&mut rng), normal(&mut rng));
            let a = DMatrix::from_fn(n, n, &mut number);
            let b = DMatrix::from_fn(n, m, &mut number);
            let expected = a.clone().lu().solve(&b).expect("regular");
            let error = (solved(&a, &b).expect("regular") - expected).camax();
            assert!(error < 1e-12, "({n}, {m}): {error}");
        }
    }

    #[test]
    fn a_zero_on_the_diagonal_needs_another_row() {
        let real = |rows: &[f64]| DMatrix::from_row_slice(2, 2, rows).map(Complex64::from);
        let (a, b) = (real(&[0.0, 2.0, 4.0, 8.0]), real(&[2.0, 4.0, 8.0, 12.0]));
        assert_eq!(solved(&a, &b), Some(real(&[0.0, -1.0, 1.0, 2.0])));
        let singular = real(&[1.0, 2.0, 2.0, 4.0]);
        assert_eq!(solved(&singular, &b), None);
    }
}
