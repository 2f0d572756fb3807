//! Right division Y U^+ for wide or square U: the equation every FRF estimate ends in.
//!
//! Solved as a least-squares problem U^H G^H = Y^H by Householder QR. QR does not care how large
//! each input is (rows of U); it does care about experiments of very different strength, unless the
//! strong ones come first (A. J. Cox, N. J. Higham, 1998): with experiments of size 1e-6, 1e-3, 1
//! the worst entry is wrong by 4e-9 unsorted and 1e-14 sorted. Column pivoting changes nothing
//! beyond that, so it is left out.

use nalgebra::linalg::QR;
use nalgebra::{DMatrix, Dyn};
use num_complex::Complex64;

use crate::error::deficient_line::{Deficiency, DeficientLine};
use crate::frf::matrices::Matrix;
use crate::frf::singular::condition_of_finite;

/// Largest condition number of U, rows scaled to equal size, at which a line is inverted by default.
pub(crate) const MAX_CONDITION: f64 = 1e10;

/// `G = Y U^+` with `U` (n_u x n_ex) and `Y` (n_y x n_ex), n_ex >= n_u: exact for n_ex = n_u, least
/// squares beyond.
///
/// `U` must have passed [`check_rank`]; a singular one gives NaN.
pub(crate) fn right_divide(y: &Matrix, u: &Matrix) -> Matrix {
    Divisor::of(u).divide(y)
}

/// A matrix that others are divided by, factorised once.
pub(crate) struct Divisor {
    order: Vec<usize>,
    qr: QR<Complex64, Dyn, Dyn>,
    upper: Matrix,
}

impl Divisor {
    /// `U` as [`right_divide`] takes it.
    pub(crate) fn of(u: &Matrix) -> Self {
        let order = strongest_first(u);
        let qr = adjoint_of(u, &order).qr();
        let upper = qr.r();
        Self { order, qr, upper }
    }

    /// `Y U^+`.
    pub(crate) fn divide(&self, y: &Matrix) -> Matrix {
        let mut right = adjoint_of(y, &self.order);
        self.qr.q_tr_mul(&mut right);
        let mut solution = right.rows(0, self.upper.ncols()).into_owned();
        if !self.upper.solve_upper_triangular_mut(&mut solution) {
            solution.fill(Complex64::new(f64::NAN, f64::NAN));
        }
        solution.adjoint()
    }
}

/// The experiments in order of their largest input.
fn strongest_first(u: &Matrix) -> Vec<usize> {
    let size = |experiment: usize| u.column(experiment).camax();
    let mut order: Vec<usize> = (0..u.ncols()).collect();
    order.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    order
}

/// The adjoint, experiments in this order.
fn adjoint_of(matrix: &Matrix, order: &[usize]) -> Matrix {
    DMatrix::from_fn(order.len(), matrix.nrows(), |m, l| {
        matrix[(l, order[m])].conj()
    })
}

/// 2-norm condition number of a finite `U`, or why `U` cannot be inverted.
///
/// The limit applies to `U` with rows scaled to equal size, so that it does not depend on the units
/// of the inputs; the number returned is that of `U` as it is.
pub(crate) fn check_rank(u: &Matrix, limit: f64, frequency_hz: f64) -> Result<f64, DeficientLine> {
    let condition = condition_of_finite(u);
    if condition <= limit {
        return Ok(condition); // scaling the rows would make it smaller still, but for a factor sqrt(n_u)
    }
    let scaled = with_rows_scaled(u);
    let scaled_condition = condition_of_finite(&scaled);
    if scaled_condition <= limit {
        return Ok(condition);
    }
    Err(DeficientLine {
        frequency_hz,
        condition: scaled_condition,
        limit,
        cause: cause_of(&scaled),
    })
}

/// Refuses a line of which it is known that an input is not excited.
pub(crate) fn check_excited(
    cause: Option<Deficiency>,
    limit: f64,
    frequency_hz: f64,
) -> Result<(), DeficientLine> {
    cause.map_or(Ok(()), |cause| {
        Err(DeficientLine {
            frequency_hz,
            condition: f64::INFINITY,
            limit,
            cause,
        })
    })
}

/// `U` with the largest part of every row 1, but of silent ones.
fn with_rows_scaled(u: &Matrix) -> Matrix {
    let mut scaled = u.clone();
    for mut row in scaled.row_iter_mut() {
        let size = row.camax();
        if size > 0.0 {
            row /= Complex64::from(size);
        }
    }
    scaled
}

/// The silent input, or the two experiments that are most alike.
fn cause_of(u: &Matrix) -> Deficiency {
    if let Some(input) = u.row_iter().position(|row| row.camax() == 0.0) {
        return Deficiency::InputSilent { input };
    }
    most_alike(u)
}

/// The two experiments with the highest correlation.
fn most_alike(u: &Matrix) -> Deficiency {
    let alike = pairs(u.ncols()).map(|(m, n)| ((m, n), correlation(u, m, n)));
    let most = alike.max_by(|a, b| a.1.total_cmp(&b.1));
    let (pair, correlation) = most.unwrap_or(((0, 0), 1.0));
    Deficiency::ExperimentsAlike { pair, correlation }
}

/// Pairs of so many experiments.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |m| (m + 1..count).map(move |n| (m, n)))
}

/// `|u_m^H u_n| / (|u_m| |u_n|)` of two columns; 1 if one of them is zero.
fn correlation(u: &Matrix, m: usize, n: usize) -> f64 {
    let [u_m, u_n] = [m, n].map(|experiment| u.column(experiment));
    let norms = u_m.norm() * u_n.norm();
    if norms > 0.0 {
        u_m.dotc(&u_n).norm() / norms
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::complex;

    fn worst(found: &DMatrix<Complex64>, truth: &DMatrix<Complex64>) -> f64 {
        found
            .iter()
            .zip(truth)
            .map(|(found, truth)| (found - truth).norm() / truth.norm())
            .fold(0.0, f64::max)
    }

    #[test]
    fn experiments_and_inputs_of_any_strength_cost_no_digits() {
        for seed in 0..200 {
            let (plain, truth) = (complex(3, 3, seed), complex(2, 3, seed + 1000));
            // inputs of 1, 1e-3, 1e-6; experiments of 1e-6, 1e-3, 1: the weak one first is the hard
            // case for QR
            let u = DMatrix::from_fn(3, 3, |l, m| {
                plain[(l, m)] * 10f64.powi(-3 * l as i32 + 3 * m as i32 - 6)
            });
            let scaled = DMatrix::from_fn(2, 3, |o, l| truth[(o, l)] * 10f64.powi(3 * l as i32));
            let found = right_divide(&(&scaled * &u), &u);
            assert!(
                worst(&found, &scaled) < 1e-11,
                "seed {seed}: {:e}",
                worst(&found, &scaled)
            );
        }
    }

    #[test]
    fn more_experiments_than_inputs_solve_the_normal_equations() {
        let (u, y) = (complex(3, 7, 1), complex(2, 7, 2));
        let found = right_divide(&y, &u);
        assert!(((&y - &found * &u) * u.adjoint()).norm() < 1e-13 * y.norm() * u.norm());
    }

    #[test]
    fn rank_does_not_depend_on_units_and_its_loss_is_explained() {
        let plain = complex(3, 3, 3);
        let units = DMatrix::from_fn(3, 3, |l, m| plain[(l, m)] * 10f64.powi(-8 * l as i32));
        assert!(check_rank(&units, 1e10, 1.0).is_ok_and(|condition| condition > 1e14));
        let alike = DMatrix::from_fn(3, 3, |l, m| plain[(l, if m == 2 { 0 } else { m })]);
        let cause = |u: &DMatrix<Complex64>| check_rank(u, 1e10, 1.0).map_err(|line| line.cause);
        assert!(
            matches!(cause(&alike), Err(Deficiency::ExperimentsAlike { pair: (0, 2), correlation }) if correlation > 0.999_999)
        );
        let silent = DMatrix::from_fn(3, 3, |l, m| {
            if l == 1 {
                Complex64::from(0.0)
            } else {
                plain[(l, m)]
            }
        });
        assert_eq!(cause(&silent), Err(Deficiency::InputSilent { input: 1 }));
    }
}
