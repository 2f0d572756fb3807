//! Linear equations with a symmetric positive definite matrix of few rows.

use crate::arm::unrolled::unrolled;
use crate::scalar::Number;

/// Solves M x = b for a symmetric positive definite M, of which the lower triangle is read, by M =
/// L D L^T.
#[inline(always)]
pub(crate) fn solve<L: Number, const A: usize>(mass: &[[L; A]; A], mut x: [L; A]) -> [L; A] {
    let (mut lower, mut scaled, mut inverse) = (*mass, *mass, x); // scaled = L D
    unrolled!(for j in 0..A {
        unrolled!(for i in j..A {
            for k in 0..j {
                scaled[i][j] = scaled[i][j] - scaled[i][k] * lower[j][k];
            }
        });
        inverse[j] = x[j].like(1.0) / scaled[j][j];
        for i in j + 1..A {
            lower[i][j] = scaled[i][j] * inverse[j];
        }
    });
    unrolled!(for i in 0..A {
        for k in 0..i {
            x[i] = x[i] - lower[i][k] * x[k];
        }
    });
    unrolled!(for i in (0..A).rev() {
        x[i] = x[i] * inverse[i];
        for k in i + 1..A {
            x[i] = x[i] - lower[k][i] * x[k];
        }
    });
    x
}
