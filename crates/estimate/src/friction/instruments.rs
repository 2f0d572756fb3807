//! Instrumental variables: linear equations solved behind instruments that their noise does not reach.
//!
//! ```text
//! theta = (Z' X)^-1 Z' b,    var theta_i = sum over k of (w_k e_k)^2,    w = Z (X' Z)^-1 e_i,    e = b - X theta
//! ```
//!
//! so that noise of another size at every line, and what the model does not explain, are counted as they are found.
//!
//! Sources: P. C. Young, Recursive estimation and time-series analysis, 2nd ed., 2011, ch. 7; H. White, Econometrica 48
//! (1980) 817-838, for the variance.

use std::iter::zip;

use nalgebra::{DMatrix, DVector};

/// Equations `X theta = b` with instruments Z, columns of the same lengths.
pub(super) struct Equations {
    left: DMatrix<f64>,
    instruments: DMatrix<f64>,
    right: DVector<f64>,
    /// Of the columns of X as they were given.
    lengths: DVector<f64>,
}

impl Equations {
    /// Of columns as they are.
    pub(super) fn new(
        mut left: DMatrix<f64>,
        mut instruments: DMatrix<f64>,
        right: DVector<f64>,
    ) -> Self {
        let lengths =
            DVector::from_iterator(left.ncols(), left.column_iter().map(|column| column.norm()));
        for columns in [&mut left, &mut instruments] {
            zip(columns.column_iter_mut(), &lengths)
                .for_each(|(mut column, length)| column /= *length);
        }
        Self {
            left,
            instruments,
            right,
            lengths,
        }
    }

    /// theta; `None` where the columns do not tell the unknowns apart.
    pub(super) fn solution(&self) -> Option<DVector<f64>> {
        let system = self.instruments.tr_mul(&self.left).lu();
        let solution = system.solve(&self.instruments.tr_mul(&self.right))?;
        Some(solution.component_div(&self.lengths))
    }

    /// Standard error of an unknown of the solution; `None` as there.
    pub(super) fn standard_error(&self, solution: &DVector<f64>, unknown: usize) -> Option<f64> {
        let residual = &self.right - &self.left * solution.component_mul(&self.lengths);
        let mut chosen = DVector::zeros(self.lengths.len());
        chosen[unknown] = 1.0 / self.lengths[unknown];
        let weights =
            &self.instruments * self.left.tr_mul(&self.instruments).lu().solve(&chosen)?;
        Some(weights.component_mul(&residual).norm())
    }
}
