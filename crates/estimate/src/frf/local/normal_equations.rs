//! Normal equations of least squares, factored row by row: what many systems have in common is factored once.

use std::iter::zip;

use num_complex::Complex64;

/// What is left of the square of a column once those before it are taken off, below which it says nothing new:
/// rounding leaves as much.
const NOTHING: f64 = 1e-14;

/// Factors of a Gram matrix, `X^H X = L L^H` (A.-L. Cholesky).
#[derive(Debug, Clone)]
pub(super) struct Factors {
    /// Row after row of L down to the diagonal, of which the inverse is kept: 0 for a column that says nothing new.
    rows: Vec<Complex64>,
    n: usize,
}

impl Factors {
    /// None yet, with room for so many rows.
    pub(super) fn with_capacity(n: usize) -> Self {
        Self {
            rows: Vec::with_capacity(n * (n + 1) / 2),
            n: 0,
        }
    }

    /// These, with room for so many further rows.
    pub(super) fn and(&self, further: usize) -> Self {
        let mut all = Self::with_capacity(self.n + further);
        all.rows.extend_from_slice(&self.rows);
        all.n = self.n;
        all
    }

    /// Appends a row of the Gram matrix, down to its diagonal.
    pub(super) fn push(&mut self, gram: impl Iterator<Item = Complex64>) {
        let first = self.rows.len();
        self.rows.extend(gram);
        let (before, row) = self.rows.split_at_mut(first);
        for column in 0..self.n {
            let (known, inverse) = row_of(before, column);
            let off: Complex64 = zip(&row[..], known).map(|(own, l)| own * l.conj()).sum();
            row[column] = (row[column] - off) * inverse;
        }
        let whole = row[self.n].re;
        let explained = row[..self.n].iter().map(Complex64::norm_sqr);
        let left = whole - explained.sum::<f64>();
        let is_new = left > NOTHING * whole;
        row[self.n] = Complex64::from(if is_new { left.sqrt().recip() } else { 0.0 });
        self.n += 1;
    }

    /// The unknowns of a right side `X^H y`; 0 for a column that says nothing new.
    pub(super) fn solve(&self, right: Vec<Complex64>) -> Vec<Complex64> {
        self.solve_last(self.n, right)
    }

    /// The same of which so many at the end are right.
    pub(super) fn solve_last(&self, n: usize, mut right: Vec<Complex64>) -> Vec<Complex64> {
        let first = right.iter().position(|value| *value != Complex64::ZERO);
        let first = first.unwrap_or(self.n);
        for row in first..self.n {
            let (known, inverse) = row_of(&self.rows, row);
            let known = zip(&known[first..], &right[first..]);
            let off: Complex64 = known.map(|(l, x)| l * x).sum();
            right[row] = (right[row] - off) * inverse;
        }
        for row in (self.n - n..self.n).rev() {
            let (known, inverse) = row_of(&self.rows, row);
            right[row] *= inverse;
            let unknown = right[row];
            zip(&mut right, known).for_each(|(rest, l)| *rest -= l.conj() * unknown);
        }
        right
    }

    /// A column of the inverse of the Gram matrix.
    pub(super) fn inverse_column(&self, column: usize) -> Vec<Complex64> {
        let mut unit = vec![Complex64::ZERO; self.n];
        unit[column] = Complex64::ONE;
        self.solve(unit)
    }
}

/// A row of L before its diagonal, and one over that.
fn row_of(rows: &[Complex64], row: usize) -> (&[Complex64], f64) {
    let first = row * (row + 1) / 2;
    (&rows[first..first + row], rows[first + row].re)
}
