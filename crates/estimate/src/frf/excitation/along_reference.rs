//! Power of an input along the references, so much of it as follows them.

use std::iter::zip;

use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::frf::matrices::{Matrix, vector};
use crate::frf::right_division::MAX_CONDITION;
use crate::frf::singular::condition_of_finite;
use crate::spectra::spread::Spread;

/// Power of every channel of u along the references, `T M^-1 T^H`; empty where the references do not
/// span their space.
pub(super) fn power_along(u: &Spread, r: &Spread, line: usize) -> Vec<f64> {
    let (mut t, mut m) = (moment(r, u, line), moment(r, r, line));
    let sizes = m.diagonal().map(|power| Complex64::from(power.re.sqrt()));
    if sizes.iter().any(|size| size.re <= 0.0) {
        return Vec::new();
    }
    // channels to equal size first: they may have different units
    m.zip_apply(&(&sizes * sizes.transpose()), |m, size| *m /= size);
    t.column_iter_mut()
        .for_each(|mut t| t.component_div_assign(&sizes));
    quadratic_forms(&t, m).unwrap_or_default()
}

/// `t^H M^-1 t` of every column; `None` of a matrix that cannot be inverted.
fn quadratic_forms(t: &Matrix, m: Matrix) -> Option<Vec<f64>> {
    let is_invertible = condition_of_finite(&m) <= MAX_CONDITION;
    let solved = m.cholesky().filter(|_| is_invertible)?.solve(t);
    let pairs = zip(t.column_iter(), solved.column_iter());
    Some(pairs.map(|(t, solved)| t.dotc(&solved).re).collect())
}

/// `sum n_q A B^H` of the means of two signals on a line.
fn moment(a: &Spread, b: &Spread, line: usize) -> Matrix {
    let mut sum = DMatrix::zeros(a.squares.nrows(), b.squares.nrows());
    for ((a, n_periods), (b, _)) in zip(&a.means, &b.means) {
        let [a, b] = [a, b].map(|means| vector(means.column(line)));
        sum.gerc(Complex64::from(*n_periods as f64), &a, &b, Complex64::ONE);
    }
    sum
}
