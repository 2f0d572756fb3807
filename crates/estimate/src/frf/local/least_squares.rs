//! Least squares by orthogonal columns (modified Gram and Schmidt): unknowns, what they are made of, residual.

use std::iter::zip;

use num_complex::Complex64;

/// What is left of a column of length 1 once those before it are taken off, below which it says nothing new.
const NOTHING: f64 = 1e-13;

/// Columns made orthogonal: `X = Q R` with the lengths of X's columns kept apart.
pub(super) struct Orthogonal {
    q: Vec<Vec<Complex64>>,
    /// Row by row, from the diagonal on; a column that says nothing new has 0 on the diagonal.
    r: Vec<Vec<Complex64>>,
    lengths: Vec<f64>,
    /// `Q^H y`.
    turned: Vec<Complex64>,
    /// What no column explains.
    pub(super) residual: Vec<Complex64>,
}

impl Orthogonal {
    /// The columns of X and the right side y.
    pub(super) fn of(mut columns: Vec<Vec<Complex64>>, right: Vec<Complex64>) -> Self {
        let lengths: Vec<f64> = columns
            .iter_mut()
            .map(|column| normalized(column))
            .collect();
        let (n, mut residual) = (columns.len(), right);
        let (mut r, mut turned) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for place in 0..n {
            let (before, after) = columns.split_at_mut(place + 1);
            let column = &mut before[place];
            let length = norm(column);
            let is_new = length > NOTHING;
            let scale = if is_new { length.recip() } else { 0.0 };
            column.iter_mut().for_each(|value| *value *= scale);
            let mut row = vec![Complex64::from(if is_new { length } else { 0.0 })];
            row.extend(after.iter_mut().map(|other| taken_off(column, other)));
            r.push(row);
            turned.push(taken_off(column, &mut residual));
        }
        Self {
            q: columns,
            r,
            lengths,
            turned,
            residual,
        }
    }

    /// The unknowns.
    pub(super) fn unknowns(&self) -> Vec<Complex64> {
        let n = self.r.len();
        let mut unknowns = vec![Complex64::ZERO; n];
        for place in (0..n).rev() {
            let row = &self.r[place];
            let known: Complex64 = zip(&row[1..], &unknowns[place + 1..])
                .map(|(r, x)| r * x)
                .sum();
            unknowns[place] = over(self.turned[place] - known, row[0]);
        }
        zip(&mut unknowns, &self.lengths).for_each(|(unknown, length)| *unknown /= *length);
        unknowns
    }

    /// The factors of the right side's values of which an unknown is the sum.
    pub(super) fn functional(&self, unknown: usize) -> Vec<Complex64> {
        let n = self.r.len();
        let mut factors = vec![Complex64::ZERO; self.residual.len()];
        let mut row = vec![Complex64::ZERO; n]; // of R^-1
        for place in unknown..n {
            let start = if place == unknown {
                Complex64::ONE
            } else {
                Complex64::ZERO
            };
            let known: Complex64 = (unknown..place)
                .map(|k| row[k] * self.r[k][place - k])
                .sum();
            row[place] = over(start - known, self.r[place][0]);
            let scaled = row[place] / self.lengths[unknown];
            zip(&mut factors, &self.q[place]).for_each(|(factor, q)| *factor += scaled * q.conj());
        }
        factors
    }
}

/// A quotient; 0 where a column says nothing new.
fn over(value: Complex64, diagonal: Complex64) -> Complex64 {
    if diagonal == Complex64::ZERO {
        Complex64::ZERO
    } else {
        value / diagonal
    }
}

fn norm(column: &[Complex64]) -> f64 {
    column.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt()
}

/// Scales a column to length 1; returns what the length was, 1 of nothing.
fn normalized(column: &mut [Complex64]) -> f64 {
    let length = norm(column);
    if length == 0.0 {
        return 1.0;
    }
    column.iter_mut().for_each(|value| *value /= length);
    length
}

/// `a^H b`.
pub(super) fn dot(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    zip(a, b).map(|(a, b)| a.conj() * b).sum()
}

/// Takes off what another column has of a direction; returns how much it was.
fn taken_off(direction: &[Complex64], other: &mut [Complex64]) -> Complex64 {
    let share = dot(direction, other);
    zip(other, direction).for_each(|(value, q)| *value -= share * q);
    share
}
