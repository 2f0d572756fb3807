//! Fit of one order at one frequency: the lines around it as a local model with an input for each order.

use ndarray::{Array2, s};
use num_complex::Complex64;

use crate::frf::local::LocalModel;
use crate::frf::local::column::Column;
use crate::frf::local::row_fit::{RowFit, fit_rows};
use crate::frf::local::window::Window;
use crate::harmonics::UNKNOWN;
use crate::harmonics::sweep_orders::SweepOrders;

/// Equations for each unknown, at least.
const EQUATIONS_PER_UNKNOWN: f64 = 1.5;
/// Largest condition number of the orders in a window.
const MOST_CONDITION: f64 = 1e4;

/// An order in one signal, at one frequency.
pub(super) struct OrderFit {
    pub(super) value: Complex64,
    /// Of what no order explains.
    pub(super) variance: f64,
    /// The fundamental's response at the frequency of the harmonic; NaN where it does not pass.
    pub(super) fundamental: Complex64,
}

impl SweepOrders {
    /// Order `order` where the fundamental passes `hz`, signal by signal; `None` where it cannot be told.
    pub(super) fn fit(
        &self,
        signals: &Array2<Complex64>,
        order: usize,
        hz: f64,
    ) -> Option<Vec<OrderFit>> {
        let (orders, window) = self.window(signals, order as f64 * hz)?;
        let drive = drive_of(&orders, order)?;
        let fundamental = drive_of(&orders, 1);
        let is_enough = window.has_equations(EQUATIONS_PER_UNKNOWN);
        let is_told = is_enough && window.condition() <= MOST_CONDITION;
        let rows = is_told.then(|| fit_rows(&window))?;
        let n_free = window.n_free() as f64;
        let fits = rows
            .iter()
            .map(|row| OrderFit::of(row, drive, fundamental, n_free));
        Some(fits.collect())
    }

    /// The window around a frequency, and the orders that drive there.
    fn window(&self, signals: &Array2<Complex64>, hz: f64) -> Option<(Vec<usize>, Window)> {
        let lines = self.lines_around(hz)?;
        let (orders, drives): (Vec<usize>, Vec<_>) = self.passing(&lines).into_iter().unzip();
        let rows = signals.slice(s![.., lines.clone()]);
        let column = |values: &[Complex64]| Column::of(values.len(), values.iter().copied());
        let window = Window::of(
            places(self.line_hz(lines.clone()), hz),
            std::iter::once(0..lines.len()).collect(),
            drives.iter().map(|drive: &Vec<_>| column(drive)).collect(),
            rows.rows()
                .into_iter()
                .map(|row| column(&row.to_vec()))
                .collect(),
            LocalModel::Rational,
        );
        Some((orders, window))
    }
}

fn drive_of(orders: &[usize], order: usize) -> Option<usize> {
    orders.iter().position(|driving| *driving == order)
}

/// Distances of lines from a frequency over the largest.
fn places(line_hz: &[f64], hz: f64) -> Vec<f64> {
    let distances = line_hz.iter().map(|line| line - hz);
    let most = largest(distances.clone());
    distances.map(|distance| distance / most).collect()
}

fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(f64::abs).fold(0.0, f64::max)
}

impl OrderFit {
    fn of(row: &RowFit, drive: usize, fundamental: Option<usize>, n_free: f64) -> Self {
        Self {
            value: row.response[drive],
            variance: row.factors[drive].norm_squared() * row.noise.norm_squared() / n_free,
            fundamental: fundamental.map_or(UNKNOWN, |drive| row.response[drive]),
        }
    }
}
