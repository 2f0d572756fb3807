//! Singular values and condition numbers of small complex matrices, by one-sided Jacobi rotations.
//!
//! Columns are rotated in pairs until all are orthogonal; their norms are then the singular values.
//! The method is right to the last digits for matrices with columns of very different size (J.
//! Demmel, K. Veselic, SIAM J. Matrix Anal. Appl. 13 (1992) 1204), as FRF matrices from wrist to
//! base are; nalgebra's bidiagonalisation loses the small values.

use frfid_signals::{SignalError, checks::all_finite};
use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::error::EstimateError;

/// Rotations converge quadratically: about six sweeps for a 6x6 matrix. This many are never needed.
const MAX_SWEEPS: usize = 60;

/// Singular values of a complex matrix, falling: `min(rows, columns)` of them.
///
/// # Errors
/// [`SignalError::NotFinite`] if an entry is NaN or infinite (channel and sample are its row and
/// column).
pub fn singular_values(matrix: &DMatrix<Complex64>) -> Result<Vec<f64>, EstimateError> {
    check_finite_entries(matrix)?;
    Ok(singular_values_of_finite(matrix))
}

/// 2-norm condition number, the largest singular value over the smallest; infinite if the smallest
/// is zero.
///
/// # Errors
/// As [`singular_values`].
pub fn condition_number(matrix: &DMatrix<Complex64>) -> Result<f64, EstimateError> {
    check_finite_entries(matrix)?;
    Ok(condition_of_finite(matrix))
}

/// [`condition_number`] with the rows, the channels, scaled to equal size: torques of different
/// size side by side then count for nothing, only whether the experiments differ.
///
/// # Errors
/// As [`condition_number`].
pub fn scaled_condition_number(matrix: &DMatrix<Complex64>) -> Result<f64, EstimateError> {
    check_finite_entries(matrix)?;
    Ok(condition_of_finite(&scaled_rows(matrix)))
}

/// A matrix with the rows scaled to equal size; those of zeros stay.
pub(crate) fn scaled_rows(matrix: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    let mut scaled = matrix.clone();
    for mut row in scaled.row_iter_mut() {
        let size = row.norm();
        if size > 0.0 {
            row.unscale_mut(size);
        }
    }
    scaled
}

/// [`condition_number`] of a matrix whose entries are known to be finite.
pub(crate) fn condition_of_finite(matrix: &DMatrix<Complex64>) -> f64 {
    let values = singular_values_of_finite(matrix);
    match (values.first(), values.last()) {
        (Some(&largest), Some(&smallest)) if smallest > 0.0 => largest / smallest,
        _ => f64::INFINITY,
    }
}

/// Refuses NaN and infinite entries, column by column; row and column are named as channel and
/// sample.
fn check_finite_entries(matrix: &DMatrix<Complex64>) -> Result<(), SignalError> {
    let entries = matrix.iter().enumerate();
    let bad = entries.filter(|(_, entry)| !entry.is_finite());
    all_finite(
        "matrix",
        bad.map(|(index, _)| matrix.vector_to_matrix_index(index)),
    )
}

fn singular_values_of_finite(matrix: &DMatrix<Complex64>) -> Vec<f64> {
    let mut columns = no_wider_than_high(matrix);
    let scale = largest_part(&columns);
    if scale == 0.0 {
        return vec![0.0; columns.ncols()];
    }
    // Squares neither overflow nor underflow once the largest part is 1.
    columns.apply(|entry| *entry /= scale);
    orthogonalise(&mut columns);
    let norms = columns.column_iter().map(|column| column.norm());
    let mut values: Vec<f64> = norms.map(|norm| scale * norm).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// The matrix or its adjoint, which has the same singular values.
fn no_wider_than_high(matrix: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    if matrix.nrows() < matrix.ncols() {
        matrix.adjoint()
    } else {
        matrix.clone()
    }
}

/// The largest real or imaginary part.
fn largest_part(matrix: &DMatrix<Complex64>) -> f64 {
    let parts = matrix.iter().flat_map(|entry| [entry.re, entry.im]);
    parts.map(f64::abs).fold(0.0, f64::max)
}

/// Rotates pairs of columns until every pair is orthogonal to rounding.
fn orthogonalise(columns: &mut DMatrix<Complex64>) {
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for p in 0..columns.ncols() {
            for q in p + 1..columns.ncols() {
                rotated |= rotate(columns, p, q);
            }
        }
        if !rotated {
            return;
        }
    }
}

/// One rotation that makes columns `p` and `q` orthogonal; false if they already are.
fn rotate(columns: &mut DMatrix<Complex64>, p: usize, q: usize) -> bool {
    let rotation = Rotation::of(columns, p, q);
    if let Some(rotation) = &rotation {
        rotation.turn(columns, p, q);
    }
    rotation.is_some()
}

/// A rotation of two columns.
struct Rotation {
    cosine: f64,
    sine: f64,
    /// What makes the inner product of the columns real.
    unturn: Complex64,
}

impl Rotation {
    /// The one that makes two columns orthogonal; `None` if they already are.
    fn of(columns: &DMatrix<Complex64>, p: usize, q: usize) -> Option<Self> {
        let (p, q) = (columns.column(p), columns.column(q));
        let (alpha, beta, gamma) = (p.norm_squared(), q.norm_squared(), p.dotc(&q));
        // plain squares: entries are at most 1, so that nothing overflows, and hypot would take half
        // of the time
        let size = gamma.norm_sqr().sqrt();
        if size <= f64::EPSILON * (alpha * beta).sqrt() {
            return None;
        }
        let tangent = small_tangent((beta - alpha) / (2.0 * size));
        let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
        Some(Self {
            cosine,
            sine: tangent * cosine,
            unturn: gamma.conj() / size,
        })
    }

    fn turn(&self, columns: &mut DMatrix<Complex64>, p: usize, q: usize) {
        for row in 0..columns.nrows() {
            let (a, b) = (columns[(row, p)], columns[(row, q)] * self.unturn);
            columns[(row, p)] = a * self.cosine - b * self.sine;
            columns[(row, q)] = a * self.sine + b * self.cosine;
        }
    }
}

/// The smaller tangent of the angle of which the cotangent of the double is `zeta`.
fn small_tangent(zeta: f64) -> f64 {
    zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{complex, unitary};

    fn spread(n_rows: usize, n_columns: usize, values: &[f64], seed: u64) -> DMatrix<Complex64> {
        let (left, right) = (unitary(n_rows, seed), unitary(n_columns, seed + 1));
        let middle = DMatrix::from_fn(n_rows, n_columns, |i, j| {
            Complex64::from(if i == j { values[i] } else { 0.0 })
        });
        left * middle * right
    }

    /// The case on which nalgebra 0.35 fails 1.7 % of the time. A value of 1e-6 in a matrix of size
    /// 1 is defined by the matrix's own rounding only to about 1e-10.
    #[test]
    fn values_of_1_1e_minus_3_1e_minus_6_are_found_in_every_matrix() {
        let truth = [1.0, 1e-3, 1e-6];
        for seed in 0..4000 {
            let found = singular_values(&spread(3, 3, &truth, 2 * seed)).expect("finite");
            for (found, truth) in found.iter().zip(truth) {
                assert!(
                    (found - truth).abs() < 4e-15 + 1e-14 * truth,
                    "seed {seed}: {found} for {truth}"
                );
            }
        }
    }

    /// Rows of very different size: here every digit of every value is defined by the matrix, and
    /// must be found.
    #[test]
    fn graded_rows_keep_full_relative_accuracy_at_any_scale() {
        for seed in 0..200 {
            let plain = complex(3, 5, seed);
            let grades = [1.0, 1e-6, 1e-12];
            let graded = DMatrix::from_fn(3, 5, |i, j| plain[(i, j)] * grades[i]);
            let reference = singular_values(&graded).expect("finite");
            for scale in [2f64.powi(-900), 2f64.powi(900)] {
                let scaled = singular_values(&graded.map(|entry| entry * scale)).expect("finite");
                for (scaled, reference) in scaled.iter().zip(&reference) {
                    assert!((scaled / scale / reference - 1.0).abs() < 1e-14);
                }
            }
            // The product of the values is |det| of the triangle, graded row by row: independent of
            // the rotations.
            let r = graded.adjoint().qr().r();
            let product: f64 = (0..3).map(|i| r[(i, i)].norm()).product();
            assert!((reference.iter().product::<f64>() / product - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn orthogonal_excitation_has_condition_1_and_sign_flip_2() {
        let shift =
            |l: usize, m: usize| Complex64::cis(std::f64::consts::TAU * (l * m) as f64 / 3.0);
        let flip = |l: usize, m: usize| Complex64::from(if l == m && l > 0 { -1.0 } else { 1.0 });
        let condition = |f: &dyn Fn(usize, usize) -> Complex64, n| {
            condition_number(&DMatrix::from_fn(n, n, f)).expect("finite")
        };
        assert!((condition(&shift, 3) - 1.0).abs() < 1e-14);
        for (n, expected) in [(2, 1.0), (3, 2.0), (4, 3.73), (6, 9.90)] {
            assert!((condition(&flip, n) - expected).abs() < 5e-3, "n = {n}");
        }
    }

    #[test]
    fn zero_is_infinitely_ill_conditioned_and_nan_is_refused() {
        assert_eq!(condition_number(&DMatrix::zeros(2, 2)), Ok(f64::INFINITY));
        let unequal = DMatrix::from_fn(2, 2, |i, j| {
            Complex64::from(if i == j { [400.0, 2.0][i] } else { 0.0 })
        });
        assert_eq!(scaled_condition_number(&unequal), Ok(1.0));
        assert_eq!(
            scaled_condition_number(&DMatrix::zeros(2, 2)),
            Ok(f64::INFINITY)
        );
        let mut bad = complex(2, 3, 0);
        bad[(1, 2)] = Complex64::new(0.0, f64::NAN);
        let expected = SignalError::NotFinite {
            name: "matrix",
            count: 1,
            channel: 1,
            sample: 2,
        };
        assert_eq!(singular_values(&bad), Err(expected.into()));
    }
}
