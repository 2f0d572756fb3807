//! Least squares by orthogonal columns (modified Gram and Schmidt): unknowns, what they are made of, residual.
//! What many systems have in common is made orthogonal once.

use std::iter::zip;

use num_complex::Complex64;

use crate::frf::local::column::{Column, over};

/// What is left of a column of length 1 once those before it are taken off, below which it says nothing new.
const NOTHING: f64 = 1e-13;

/// Columns made orthogonal, `X = Q R` with the lengths of X's columns kept apart.
#[derive(Default)]
pub(super) struct Basis {
    q: Vec<Column>,
    /// Column by column, down to the diagonal, which is 0 for a column that says nothing new.
    r: Vec<Complex64>,
    lengths: Vec<f64>,
    /// Columns before the first of its own.
    n_before: usize,
}

/// A system of equations whose first columns are a basis.
pub(super) struct System<'b> {
    common: &'b Basis,
    own: Basis,
    /// `Q^H y`.
    turned: Vec<Complex64>,
    /// What no column explains.
    pub(super) residual: Column,
}

/// What an unknown is of the right side, `sum_k conj(values_k) y_k`, as far as the columns of a basis go.
pub(super) struct Functional {
    unknown: usize,
    /// A row of `R^-1`.
    row: Vec<Complex64>,
    values: Column,
}

impl Basis {
    /// The basis of some columns.
    pub(super) fn of(columns: impl Iterator<Item = Column>) -> Self {
        Self::behind(&Self::default(), columns)
    }

    /// The basis of columns behind those that are common.
    fn behind(common: &Self, columns: impl Iterator<Item = Column>) -> Self {
        let mut basis = Self {
            n_before: common.q.len(),
            ..Self::default()
        };
        for mut column in columns {
            basis.lengths.push(normalized(&mut column));
            column.take_off(common.q.iter().chain(&basis.q), &mut basis.r);
            let left = column.norm_squared().sqrt();
            let diagonal = if left > NOTHING { left } else { 0.0 };
            column.scale(inverse(diagonal));
            basis.r.push(diagonal.into());
            basis.q.push(column);
        }
        basis
    }

    /// The columns of R.
    fn r(&self) -> impl DoubleEndedIterator<Item = &[Complex64]> {
        let n = self.n_before;
        let before = move |column: usize| column * n + column * (column + 1) / 2;
        (0..self.q.len()).map(move |column| &self.r[before(column)..before(column + 1)])
    }

    /// What an unknown, one of this basis, is of the right side if no further columns follow.
    pub(super) fn functional(&self, unknown: usize) -> Functional {
        let nothing = Functional {
            unknown,
            row: Vec::new(),
            values: self.q.first().map(Column::zeros_like).unwrap_or_default(),
        };
        nothing.behind(self)
    }
}

impl Functional {
    /// With the columns of a basis behind those it goes through already.
    fn behind(&self, basis: &Basis) -> Self {
        let (mut row, mut values) = (self.row.clone(), self.values.clone());
        for (r, q) in zip(basis.r(), &basis.q) {
            let (column, known) = (row.len(), zip(&row, r).map(|(row, r)| row * r));
            let start = f64::from(u8::from(column == self.unknown));
            let share = over(start - known.sum::<Complex64>(), r[column]);
            values.add(share.conj(), q);
            row.push(share);
        }
        Self {
            unknown: self.unknown,
            row,
            values,
        }
    }
}

impl<'b> System<'b> {
    /// The system of these columns behind the common ones, and its right side.
    pub(super) fn of(
        common: &'b Basis,
        columns: impl Iterator<Item = Column>,
        right: Column,
    ) -> Self {
        let (own, mut residual) = (Basis::behind(common, columns), right);
        let mut turned = Vec::with_capacity(common.q.len() + own.q.len());
        residual.take_off(common.q.iter().chain(&own.q), &mut turned);
        Self {
            common,
            own,
            turned,
            residual,
        }
    }

    /// The unknowns.
    pub(super) fn unknowns(&self) -> Vec<Complex64> {
        let mut unknowns = self.turned.clone();
        let columns = self.own.r().rev().chain(self.common.r().rev());
        for r in columns {
            let column = r.len() - 1;
            let unknown = over(unknowns[column], r[column]);
            zip(&mut unknowns, r).for_each(|(rest, r)| *rest -= unknown * r);
            unknowns[column] = unknown;
        }
        let lengths = self.common.lengths.iter().chain(&self.own.lengths);
        zip(&mut unknowns, lengths).for_each(|(unknown, length)| *unknown /= *length);
        unknowns
    }

    /// What an unknown is of the right side, `sum_k conj(values_k) y_k`, from what it is by the common columns alone.
    pub(super) fn functional(&self, common: &Functional) -> Column {
        let mut values = common.behind(&self.own).values;
        values.scale(self.common.lengths[common.unknown].recip());
        values
    }
}

/// Scales a column to length 1; returns what the length was, 1 of nothing.
fn normalized(column: &mut Column) -> f64 {
    let length = column.norm_squared().sqrt();
    if length == 0.0 {
        return 1.0;
    }
    column.scale(length.recip());
    length
}

/// One over a number, 0 over 0.
fn inverse(number: f64) -> f64 {
    if number == 0.0 { 0.0 } else { number.recip() }
}
