//! Linear equations with a symmetric positive definite matrix of few rows.

use crate::scalar::Scalar;

/// Solves M x = b for a symmetric positive definite M, of which the lower triangle is read, by M =
/// L D L^T.
#[inline(always)]
pub(crate) fn solve<L: Scalar, const A: usize>(mass: &[[L; A]; A], mut x: [L; A]) -> [L; A] {
    let (mut lower, mut scaled, mut inverse) = (*mass, *mass, [L::splat(0.0); A]); // scaled = L D
    for j in 0..A {
        for i in j..A {
            scaled[i][j] = (0..j).fold(mass[i][j], |sum, k| sum - scaled[i][k] * lower[j][k]);
        }
        inverse[j] = L::splat(1.0) / scaled[j][j];
        for i in j + 1..A {
            lower[i][j] = scaled[i][j] * inverse[j];
        }
    }
    for i in 0..A {
        x[i] = (0..i).fold(x[i], |sum, k| sum - lower[i][k] * x[k]);
    }
    for i in (0..A).rev() {
        x[i] = (i + 1..A).fold(x[i] * inverse[i], |sum, k| sum - lower[k][i] * x[k]);
    }
    x
}
