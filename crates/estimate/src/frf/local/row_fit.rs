//! Fit of the rows of a local model: their response to every drive, what that is made of, and the noise.
//!
//! The equations are linear in their unknowns, their errors the noise times the denominator A of the row. A first
//! fit gives every row's A; a second one, with the equations over what all |A| are in the mean, weighs noise as it
//! is (one step of Sanathanan and Koerner: more of them let A follow the noise). Errors of the unknowns are then
//! linear in the noise V, `dtheta = X^+ diag(W A) V` with the weights W, which holds wherever the poles are.

use num_complex::Complex64;

use crate::frf::local::column::{Column, Reals};
use crate::frf::local::least_squares::{Basis, Functional, System};
use crate::frf::local::window::{N_TERMS, Window};

/// A weight is at most this times the smallest.
const MOST_WEIGHT: f64 = 1e6;

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

/// The equations of a window, each with its weight.
struct Equations<'w> {
    window: &'w Window,
    /// Order of the denominator.
    n_poles: usize,
    places: Reals,
    /// One over the weights.
    sizes: Reals,
    /// The weights times powers of the places.
    powers: [Reals; N_TERMS],
    /// The same with the other sign, for the side of the unknowns.
    minus_powers: [Reals; N_TERMS],
    /// The columns that all rows have in common: drives, then transients, times powers.
    common: Basis,
}

/// The fits of all answers of a window.
pub(crate) fn fit_rows(window: &Window) -> Vec<RowFit> {
    let even = Equations::even(window);
    if window.n_poles == 0 {
        even.rows()
    } else {
        even.weighted().rows()
    }
}

/// The same, and what they are without poles.
pub(super) fn fit_rows_of_both(window: &Window) -> [Vec<RowFit>; 2] {
    let even = Equations::even(window);
    [even.weighted().rows(), even.without_poles().rows()]
}

impl<'w> Equations<'w> {
    fn even(window: &'w Window) -> Self {
        Self::of(window, Reals::of(&window.places).map(|_| 1.0))
    }

    fn of(window: &'w Window, sizes: Reals) -> Self {
        let places = Reals::of(&window.places);
        let weights = sizes.map(f64::recip);
        let linear = weights.times(&places);
        let powers = [weights, linear.clone(), linear.times(&places)];
        let signals = window.drives.iter().chain(&window.transients);
        let columns = signals.flat_map(|signal| powers.iter().map(|power| signal.times(power)));
        Self {
            window,
            n_poles: window.n_poles,
            common: Basis::of(columns),
            places,
            sizes,
            minus_powers: powers.clone().map(|power| power.map(|value| -value)),
            powers,
        }
    }

    /// The same over what the denominators of all answers are in the mean.
    fn weighted(&self) -> Self {
        let answers = self.window.answers.iter();
        let denominators = answers.map(|answer| self.denominator(&self.system(answer)));
        Self::of(self.window, mean_sizes(&denominators.collect::<Vec<_>>()))
    }

    fn without_poles(self) -> Self {
        Self { n_poles: 0, ..self }
    }

    /// The fits of all answers.
    fn rows(&self) -> Vec<RowFit> {
        let drives = 0..self.window.drives.len();
        let drives = drives.map(|drive| self.common.functional(N_TERMS * drive));
        let drives: Vec<Functional> = drives.collect();
        let fit = |answer| self.row_fit(answer, &drives);
        self.window.answers.iter().map(fit).collect()
    }

    /// The equations of an answer: behind the common columns those of the denominator.
    fn system(&self, answer: &Column) -> System<'_> {
        let own = self.minus_powers[1..].iter().take(self.n_poles);
        let own = own.map(|power| answer.times(power));
        System::of(&self.common, own, answer.times(&self.powers[0]))
    }

    /// The denominator on every line, from the last unknowns.
    fn denominator(&self, fit: &System) -> Column {
        let unknowns = fit.unknowns();
        let own = &unknowns[unknowns.len() - self.n_poles..];
        Column::polynomial(&self.places, own)
    }

    /// The fit of an answer from what the common columns make of every drive's response.
    fn row_fit(&self, answer: &Column, drives: &[Functional]) -> RowFit {
        let fit = self.system(answer);
        let (a, unknowns) = (self.denominator(&fit), fit.unknowns());
        let of_equations = a.times(&self.powers[0]);
        let factors = |drive| fit.functional(drive).times_conjugate(&of_equations);
        let equation_error = fit.residual.times(&self.sizes);
        RowFit {
            response: unknowns
                .into_iter()
                .step_by(N_TERMS)
                .take(drives.len())
                .collect(),
            factors: drives.iter().map(factors).collect(),
            noise: equation_error.over(&a),
            equation_error,
        }
    }
}

/// What the sizes of the denominators are in the mean, geometrically, none much smaller than the largest; 1 where
/// that is not finite.
fn mean_sizes(denominators: &[Column]) -> Reals {
    let squares = denominators.iter().map(Reals::norms_squared);
    let product = squares.reduce(|product, square| product.times(&square));
    let exponent = 0.5 / denominators.len() as f64;
    let sizes = product.map_or_else(
        || Reals::of(&[]),
        |product| product.map(|square| square.powf(exponent)),
    );
    let largest = sizes.largest();
    if !(largest > 0.0 && largest.is_finite()) {
        return sizes.map(|_| 1.0);
    }
    sizes.map(|size| size.max(largest / MOST_WEIGHT))
}
