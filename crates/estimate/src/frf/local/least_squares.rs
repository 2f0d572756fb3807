//! Least squares by orthogonal columns (modified Gram and Schmidt): unknowns, what they are made of, residual.
//! What many systems have in common is made orthogonal once.

use std::iter::zip;

use num_complex::Complex64;

use crate::frf::local::window::Signal;

/// What is left of a column of length 1 once those before it are taken off, below which it says nothing new.
const NOTHING: f64 = 1e-13;

/// Columns made orthogonal, `X = Q R` with the lengths of X's columns kept apart.
#[derive(Default)]
pub(super) struct Basis {
    q: Vec<Signal>,
    /// Column by column, down to the diagonal, which is 0 for a column that says nothing new.
    r: Vec<Signal>,
    lengths: Vec<f64>,
}

/// A system of equations whose first columns are a basis.
pub(super) struct System<'b> {
    common: &'b Basis,
    own: Basis,
    /// `Q^H y`.
    turned: Signal,
    /// What no column explains.
    pub(super) residual: Signal,
}

impl Basis {
    /// The basis of some columns.
    pub(super) fn of(columns: impl IntoIterator<Item = Signal>) -> Self {
        Self::default().extended(&Self::default(), columns)
    }

    /// With more columns, behind those that are common.
    fn extended(mut self, common: &Self, columns: impl IntoIterator<Item = Signal>) -> Self {
        for mut column in columns {
            self.lengths.push(normalized(&mut column));
            let shares = common
                .q
                .iter()
                .chain(&self.q)
                .map(|q| taken_off(q, &mut column));
            let mut shares: Signal = shares.collect();
            let left = norm(&column);
            let (diagonal, scale) = if left > NOTHING {
                (left, left.recip())
            } else {
                (0.0, 0.0)
            };
            column.iter_mut().for_each(|value| *value *= scale);
            shares.push(diagonal.into());
            self.r.push(shares);
            self.q.push(column);
        }
        self
    }
}

impl<'b> System<'b> {
    /// The system of these columns behind the common ones, and its right side.
    pub(super) fn of(
        common: &'b Basis,
        columns: impl IntoIterator<Item = Signal>,
        right: Signal,
    ) -> Self {
        let (own, mut residual) = (Basis::default().extended(common, columns), right);
        let all = common.q.iter().chain(&own.q);
        let turned = all.map(|q| taken_off(q, &mut residual)).collect();
        Self {
            common,
            own,
            turned,
            residual,
        }
    }

    fn n_columns(&self) -> usize {
        self.turned.len()
    }

    /// A column of R, down to the diagonal.
    fn r(&self, column: usize) -> &Signal {
        let n_common = self.common.r.len();
        match column.checked_sub(n_common) {
            None => &self.common.r[column],
            Some(own) => &self.own.r[own],
        }
    }

    fn q(&self) -> impl Iterator<Item = &Signal> {
        self.common.q.iter().chain(&self.own.q)
    }

    fn lengths(&self) -> impl Iterator<Item = &f64> {
        self.common.lengths.iter().chain(&self.own.lengths)
    }

    /// The unknowns.
    pub(super) fn unknowns(&self) -> Signal {
        let mut unknowns = self.turned.clone();
        for column in (0..self.n_columns()).rev() {
            let r = self.r(column);
            let unknown = over(unknowns[column], r[column]);
            zip(&mut unknowns, r).for_each(|(rest, r)| *rest -= unknown * r);
            unknowns[column] = unknown;
        }
        zip(&mut unknowns, self.lengths()).for_each(|(unknown, length)| *unknown /= *length);
        unknowns
    }

    /// The factors of the right side's values of which an unknown is the sum.
    pub(super) fn functional(&self, unknown: usize) -> Signal {
        let mut row: Signal = Vec::with_capacity(self.n_columns()); // of R^-1
        for column in 0..self.n_columns() {
            let r = self.r(column);
            let start = f64::from(u8::from(column == unknown));
            let known: Complex64 = zip(&row, r).map(|(row, r)| row * r).sum();
            row.push(over(start - known, r[column]));
        }
        let length = self.lengths().nth(unknown).copied().unwrap_or(1.0);
        let mut factors = vec![Complex64::ZERO; self.residual.len()];
        for (share, q) in zip(row, self.q()).skip(unknown) {
            let share = share / length;
            zip(&mut factors, q).for_each(|(factor, q)| *factor += share * q.conj());
        }
        factors
    }
}

/// A quotient; 0 over nothing: a column that says nothing new, a denominator that vanishes.
pub(super) fn over(value: Complex64, diagonal: Complex64) -> Complex64 {
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

/// Takes off what a column has of a direction; returns how much it was.
fn taken_off(direction: &[Complex64], column: &mut [Complex64]) -> Complex64 {
    let share = dot(direction, column);
    zip(column, direction).for_each(|(value, q)| *value -= share * q);
    share
}
