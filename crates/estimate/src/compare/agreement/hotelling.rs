//! Difference of two FRFs over the sum of their covariances as a probability, line by line.

use nalgebra::{DMatrix, DVector};
use ndarray::Axis;
use num_complex::Complex64;

use crate::compare::agreement::common_lines::CommonLines;
use crate::compare::measured::Measured;
use crate::frf::f_distribution::ln_f_tail;

/// Degrees of freedom that the test of a whole matrix needs beyond its entries: with fewer its
/// quantiles are so far out that single entries see more.
const SPARE: f64 = 4.0;
/// Rounding of estimates, relative to the response: no difference.
const ROUNDING: f64 = 1e-9;

/// Logarithm of the probability of as large a difference in one entry, for every common line; NaN
/// where it is not known.
pub(crate) fn entry_ln_p(lines: &CommonLines, entry: (usize, usize)) -> Vec<f64> {
    let ln_p = |places: (usize, usize)| {
        let (a, b) = (
            variance(lines.a, places.0, entry),
            variance(lines.b, places.1, entry),
        );
        let (difference, moved) = lines.difference(places, entry);
        let known = rounding(lines.b, places.1, entry) + moved.norm_sqr();
        let dof = (a.0 + b.0).powi(2) / (a.0 * a.0 / a.1 + b.0 * b.0 / b.1);
        let ratio = difference.norm_sqr() / (a.0 + b.0 + known);
        // without any noise of its own it is rounding
        let dof = if dof.is_nan() && a.0 + b.0 == 0.0 {
            a.1
        } else {
            dof
        };
        ln_f_tail(ratio, 1, dof)
    };
    lines.places().map(ln_p).collect()
}

/// Variance of an entry and its degrees of freedom.
fn variance(side: &Measured, line: usize, entry: (usize, usize)) -> (f64, f64) {
    let dof = side.degrees_of_freedom().unwrap_or(0.0);
    (side.variance_at(line, entry), dof)
}

fn rounding(side: &Measured, line: usize, (output, input): (usize, usize)) -> f64 {
    (ROUNDING * side.frf.response[[line, output, input]].norm()).powi(2)
}

/// The same of the whole matrix; `None` where the degrees of freedom, or a covariance that cannot
/// be inverted, do not allow it.
pub(crate) fn matrix_ln_p(lines: &CommonLines) -> Option<Vec<f64>> {
    lines
        .places()
        .map(|places| matrix_line(lines, places))
        .collect()
}

/// One line; NaN where a number of it is not known.
fn matrix_line(lines: &CommonLines, places: (usize, usize)) -> Option<f64> {
    let (a, a_dof) = covariance(lines.a, places.0)?;
    let (mut both, b_dof) = covariance(lines.b, places.1)?;
    let n_outputs = lines.a.frf.n_outputs();
    let n = both.nrows();
    both += &a;
    let mut difference = DVector::zeros(n);
    for column in 0..n {
        let entry = (column % n_outputs, column / n_outputs);
        let (apart, moved) = lines.difference(places, entry);
        difference[column] = apart;
        both[(column, column)] += rounding(lines.b, places.1, entry) + moved.norm_sqr();
    }
    if !(both
        .iter()
        .chain(&difference)
        .all(|value| value.is_finite()))
    {
        return Some(f64::NAN);
    }
    let factor = both.cholesky()?.unpack();
    // whitened share of A: its traces are the degrees of freedom of the sum
    let half = factor.solve_lower_triangular(&a)?;
    let share = factor.solve_lower_triangular(&half.adjoint())?;
    let dof = effective_dof(&share, a_dof, b_dof);
    let spare = dof - n as f64 + 1.0;
    if spare < SPARE {
        return None;
    }
    let squared = factor.solve_lower_triangular(&difference)?.norm_squared();
    Some(ln_f_tail(squared * spare / (dof * n as f64), n, spare))
}

/// `(m^2 + m) / sum_i (tr^2 X_i + tr X_i^2) / nu_i` with the whitened shares X_A and `1 - X_A`.
fn effective_dof(share: &DMatrix<Complex64>, a_dof: f64, b_dof: f64) -> f64 {
    let n = share.nrows() as f64;
    let (trace, square) = (share.trace().re, share.norm_squared());
    let of_a = (trace * trace + square) / a_dof;
    let of_b = ((n - trace).powi(2) + n - 2.0 * trace + square) / b_dof;
    (n * n + n) / (of_a + of_b)
}

/// Covariance of a line with the scatter beyond its noise, and its degrees of freedom.
fn covariance(side: &Measured, line: usize) -> Option<(DMatrix<Complex64>, f64)> {
    let known = side.known?.0;
    let values = known.covariance.index_axis(Axis(0), line);
    let n_outputs = side.frf.n_outputs();
    let mut matrix = DMatrix::from_fn(values.nrows(), values.ncols(), |i, j| values[[i, j]]);
    for k in 0..matrix.nrows() {
        let entry = (k % n_outputs, k / n_outputs);
        let size = side.frf.response[[line, entry.0, entry.1]].norm_sqr();
        matrix[(k, k)] += side.rough(entry) * size;
    }
    Some((matrix, known.degrees_of_freedom))
}
