//! Fit of the rows of a local model: their response to every drive, what that is made of, and the noise.
//!
//! The equations are linear in their unknowns, their errors the noise times the denominator A of the row. A first
//! fit gives every row's A; a second one, with the equations over what all |A| are in the mean, weighs noise as it
//! is (one step of Sanathanan and Koerner: more of them let A follow the noise). Errors of the unknowns are then
//! linear in the noise V, `dtheta = (X^H W^2 X)^-1 X^H W^2 diag(A) V` with the weights W, which holds wherever the
//! poles are.

use num_complex::Complex64;

use crate::frf::local::column::{Column, Reals};
use crate::frf::local::equations::{Equations, System};
use crate::frf::local::window::{N_TERMS, Window};

/// The square of a weight is at most this times the smallest.
const MOST_WEIGHT: f64 = 1e12;

/// The fit of one answer.
pub(crate) struct RowFit {
    /// Response to each drive.
    pub(crate) response: Vec<Complex64>,
    /// For each drive the conjugate factors of the answer's noise, line by line, in the error of the response.
    pub(crate) factors: Vec<Column>,
    /// The noise of the answer on each line.
    pub(crate) noise: Column,
    /// The same times the denominator: even where the noise has passed through the plant.
    pub(super) equation_error: Column,
}

/// The fits of all answers of a window.
pub(crate) fn fit_rows(window: &Window) -> Vec<RowFit> {
    let even = Equations::even(window);
    if window.n_poles == 0 {
        rows(&even)
    } else {
        rows(&over_denominators(&even))
    }
}

/// The same, and what they are without poles.
pub(super) fn fit_rows_of_both(window: &Window) -> [Vec<RowFit>; 2] {
    let even = Equations::even(window);
    [rows(&over_denominators(&even)), rows(&even.without_poles())]
}

/// The same equations over what the denominators of all answers are in the mean.
fn over_denominators<'w>(even: &Equations<'w>) -> Equations<'w> {
    let answers = even.window.answers.iter();
    let denominators = answers.map(|answer| System::of(even, answer).denominator());
    even.weighted(weights(&denominators.collect::<Vec<_>>()))
}

fn rows(equations: &Equations) -> Vec<RowFit> {
    let answers = equations.window.answers.iter();
    answers
        .map(|answer| RowFit::of(equations, answer))
        .collect()
}

impl RowFit {
    fn of(equations: &Equations, answer: &Column) -> Self {
        let system = System::of(equations, answer);
        let (unknowns, equation_error) = system.solved();
        let denominator = equations.denominator(&unknowns);
        let of_equations = denominator.times(&equations.lines.weights);
        let drives = (0..equations.window.drives.len()).map(|drive| N_TERMS * drive);
        let factors = |unknown| system.functional(unknown).times_conjugate(&of_equations);
        Self {
            response: drives.clone().map(|unknown| unknowns[unknown]).collect(),
            factors: drives.map(factors).collect(),
            noise: equation_error.over(&denominator),
            equation_error,
        }
    }
}

/// The squares of the weights of equations over what their denominators are in the mean, geometrically, none much smaller
/// than the largest; 1 where that is not finite.
fn weights(denominators: &[Column]) -> Reals {
    let squares = denominators.iter().map(Reals::norms_squared);
    let product = squares.reduce(|product, square| product.times(&square));
    let exponent = 1.0 / denominators.len() as f64;
    let means = match product {
        Some(square) if denominators.len() == 1 => square,
        Some(product) => product.map(|product| product.powf(exponent)),
        None => Reals::of(&[]),
    };
    let largest = means.largest();
    if !(largest > 0.0 && largest.is_finite()) {
        return means.map(|_| 1.0);
    }
    means.map(|square| square.max(largest / MOST_WEIGHT).recip())
}
