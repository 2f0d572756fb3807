//! Partial regression of torques on signs: what signs say of torques that no local model of the velocities does.
//!
//! In a narrow band, with x the distance from its middle over its half width,
//!
//! ```text
//! U_im = sum_j Y_jm (b_ij0 + b_ij1 x + b_ij2 x^2) + t_im0 + t_im1 x + t_im2 x^2 + F_i S_im
//! ```
//!
//! for every run m. With U_i' and S_i' what is left of U_i and S_i once all columns but the last are taken off, least
//! squares has `F_i = S_i'^H U_i' / |S_i'|^2` (Frisch, Waugh and Lovell), its variance from the residual.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{DMatrix, DVectorView};
use num_complex::Complex64;

use crate::friction::axes::run::FrictionSpectra;

/// Coefficients of a response, and of what the ends of a record leave.
pub(super) const N_TERMS: usize = 3;

/// What a narrow band says of the friction of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Answer {
    pub(super) rad_per_s: f64,
    /// F_i, turned by what the sign is late.
    pub(super) friction_nm: Complex64,
    /// Variance of its real part.
    pub(super) variance: f64,
}

/// What the band of so many Hz around a frequency says, axis by axis; `None` of an axis where it says nothing.
pub(super) fn answers(
    runs: &[FrictionSpectra],
    middle_hz: f64,
    half_hz: f64,
) -> Vec<Option<Answer>> {
    let blocks: Vec<Matrix> = runs
        .iter()
        .filter_map(|run| settled_block(run, middle_hz, half_hz))
        .collect();
    let n_axes = runs.first().map_or(0, FrictionSpectra::n_axes);
    let n_of_models = N_TERMS * n_axes;
    let n_rows: usize = blocks.iter().map(Matrix::nrows).sum();
    let n_unknowns = n_of_models + N_TERMS * blocks.len() + 1;
    if n_rows <= n_unknowns {
        return vec![None; n_axes];
    }
    let all = stacked(&blocks, n_rows);
    let models = all.columns(0, n_of_models).into_owned();
    let rest = without(models, all.columns(n_of_models, 2 * n_axes).into_owned());
    let answer = |axis: usize| {
        let (u, sign) = (rest.column(axis), rest.column(n_axes + axis));
        let (friction_nm, variance) = regression(u, sign, n_rows - n_unknowns)?;
        Some(Answer {
            rad_per_s: TAU * middle_hz,
            friction_nm,
            variance,
        })
    };
    (0..n_axes).map(answer).collect()
}

type Matrix = DMatrix<Complex64>;

/// Lines of a run in a band: velocities times powers of the place, torques, signs, without what its ends leave;
/// `None` where it has too few.
fn settled_block(run: &FrictionSpectra, middle_hz: f64, half_hz: f64) -> Option<Matrix> {
    let lines = lines_within(&run.line_hz, [middle_hz - half_hz, middle_hz + half_hz]);
    if lines.len() <= N_TERMS {
        return None;
    }
    let place = |row: usize| (run.line_hz[lines.start + row] - middle_hz) / half_hz;
    let power = |row: usize, power: usize| Complex64::from(place(row).powi(power as i32));
    let (n_axes, n_rows) = (run.n_axes(), lines.len());
    let block = Matrix::from_fn(n_rows, (N_TERMS + 2) * n_axes, |row, column| {
        let (kind, axis) = (column / n_axes, column % n_axes);
        let at = [axis, lines.start + row];
        match kind.checked_sub(N_TERMS) {
            None => run.y[at] * power(row, kind),
            Some(0) => run.u[at],
            Some(_) => run.signs[at],
        }
    });
    Some(without(Matrix::from_fn(n_rows, N_TERMS, power), block))
}

fn lines_within(line_hz: &[f64], [from_hz, to_hz]: [f64; 2]) -> Range<usize> {
    let below = |bound: f64| line_hz.partition_point(|line| *line < bound);
    below(from_hz)..below(to_hz)
}

fn stacked(blocks: &[Matrix], n_rows: usize) -> Matrix {
    let rows = blocks.iter().flat_map(Matrix::row_iter);
    let n_columns = blocks.first().map_or(0, Matrix::ncols);
    let mut all = Matrix::zeros(n_rows, n_columns);
    for (mut row, of_block) in all.row_iter_mut().zip(rows) {
        row.copy_from(&of_block);
    }
    all
}

/// What columns do not explain.
fn without(columns: Matrix, values: Matrix) -> Matrix {
    let q = columns.qr().q();
    let explained = &q * (q.adjoint() * &values);
    values - explained
}

/// Factor of the sign in the torque, and the variance of its real part.
fn regression(
    u: DVectorView<Complex64>,
    sign: DVectorView<Complex64>,
    n_free: usize,
) -> Option<(Complex64, f64)> {
    let power = sign.norm_squared();
    let factor = sign.dotc(&u) / Complex64::from(power);
    let residual = (u - sign * factor).norm_squared() / n_free as f64;
    let variance = 0.5 * residual / power;
    (factor.is_finite() && variance > 0.0 && variance.is_finite()).then_some((factor, variance))
}
