//! Propagation of the covariance of an FRF through an equation, to first order.
//!
//! An equation X(J) with `dX = A dJ B` turns errors by `vec(dX) = (B^T kron A) vec(dJ)`, so that
//! `C_X = K C_J K^H` with `K = B^T kron A`. (R. Pintelon, J. Schoukens, System Identification, 2nd ed.,
//! section 2.7.)

use std::iter::zip;

use frfid_signals::{Frf, Uncertainty};
use ndarray::{Array3, Axis};

use crate::frf::matrices::{Matrix, matrices, matrix, stacked};

/// An equation on one line: the value, and the factors of `dX = A dJ B`.
pub(super) struct Equation {
    pub(super) value: Matrix,
    pub(super) left: Matrix,
    pub(super) right: Matrix,
}

/// The FRF that follows from another line by line, with its covariances.
pub(super) fn propagated(frf: &Frf, equation: impl Fn(&Matrix) -> Equation) -> Frf {
    let lines: Vec<Equation> = matrices(frf).iter().map(equation).collect();
    let turns: Vec<Matrix> = lines
        .iter()
        .map(|line| line.right.transpose().kronecker(&line.left))
        .collect();
    let turned = |known: &Uncertainty| Uncertainty {
        covariance: turned(&known.covariance, &turns),
        ..known.clone()
    };
    let values: Vec<&Matrix> = lines.iter().map(|line| &line.value).collect();
    Frf {
        response: stacked(&values),
        noise: frf.noise.as_ref().map(turned),
        total: frf.total.as_ref().map(turned),
        ..frf.clone()
    }
}

/// `K C K^H` on every line.
fn turned(
    covariance: &Array3<num_complex::Complex64>,
    turns: &[Matrix],
) -> Array3<num_complex::Complex64> {
    let lines = zip(covariance.axis_iter(Axis(0)), turns);
    let turned: Vec<Matrix> = lines
        .map(|(covariance, k)| k * matrix(covariance) * k.adjoint())
        .collect();
    stacked(&turned)
}
