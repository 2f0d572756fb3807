//! Local rational method: an FRF at one frequency from the lines of whole records around it.
//!
//! Over a narrow band every row i of the FRF is a rational function, and what a record of finite
//! length leaves at its ends (the transient T) has the same poles. With x, the distance from the
//! frequency over the half width of the band,
//!
//! ```text
//! Y_im (1 + a_1 x + a_2 x^2) = sum_j U_jm (b_j0 + b_j1 x + b_j2 x^2) + t_m0 + t_m1 x + t_m2 x^2
//! ```
//!
//! for every experiment m is linear in its unknowns and solved by least squares; G_ij = b_j0. Exact
//! where one mode lies within the band, however little it is damped. Source: R. Pintelon,
//! J. Schoukens, System Identification, 2nd ed., ch. 7; T. McKelvey, G. Guerin, Non-parametric
//! frequency response estimation using a local rational model, SYSID 2012.

use std::iter::zip;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use crate::frf::matrices::Matrix;

/// Order of all polynomials: one mode needs a denominator of order two.
const ORDER: usize = 2;
/// Coefficients of numerators and transients.
const N_TERMS: usize = ORDER + 1;
/// Least number of equations for each unknown: with fewer the residual says little of the errors.
const EQUATIONS_PER_UNKNOWN: usize = 2;
/// Weight of a coefficient of 0 against the data, columns scaled to length 1: what the data do not
/// tell gets a large variance instead of a division by rounding errors.
const RIDGE: f64 = 1e-9;

/// One line of whole records: U and Y, channels in rows, experiments in columns.
pub(crate) struct WholeLine {
    /// Distance from the frequency over the half width of the band.
    pub(crate) place: f64,
    pub(crate) u: Matrix,
    pub(crate) y: Matrix,
}

/// An FRF at one frequency with the covariance of each row.
pub(crate) struct LocalFit {
    /// `(output, input)`.
    pub(crate) response: Matrix,
    /// For every output the covariance of its entries, `(input, input)`, from the residuals; beside
    /// a sharp mode too large rather than too small, since residuals grow with the denominator.
    pub(crate) covariances: Vec<Matrix>,
}

impl LocalFit {
    /// The fit to lines of one shape; `None` where they are too few.
    pub(crate) fn of(lines: &[WholeLine]) -> Option<Self> {
        let (first, n_unknowns) = (lines.first()?, n_unknowns(lines.first()?));
        let n_equations = lines.len() * first.u.ncols();
        if n_equations < EQUATIONS_PER_UNKNOWN * n_unknowns {
            return None;
        }
        let (n_outputs, n_inputs) = (first.y.nrows(), first.u.nrows());
        let rows = (0..n_outputs).map(|output| fit_row(lines, output));
        let rows: Vec<_> = rows.collect::<Option<_>>()?;
        Some(Self {
            response: DMatrix::from_fn(n_outputs, n_inputs, |output, input| rows[output].0[input]),
            covariances: rows.into_iter().map(|(_, covariance)| covariance).collect(),
        })
    }
}

fn n_unknowns(line: &WholeLine) -> usize {
    ORDER + N_TERMS * (line.u.nrows() + line.u.ncols())
}

/// Row `output` of the FRF and the covariance of its entries.
fn fit_row(lines: &[WholeLine], output: usize) -> Option<(DVector<Complex64>, Matrix)> {
    let first = lines.first()?;
    let (n_inputs, n_experiments) = first.u.shape();
    let equation = |row: usize| (&lines[row / n_experiments], row % n_experiments);
    let (n_rows, n_columns) = (lines.len() * n_experiments, n_unknowns(first));
    let mut regressors = DMatrix::from_fn(n_rows, n_columns, |row, column| {
        let (line, experiment) = equation(row);
        line.regressor([output, experiment], column)
    });
    let measured = DVector::from_fn(n_rows, |row, _| {
        let (line, experiment) = equation(row);
        line.y[(output, experiment)]
    });
    let lengths = normalize(&mut regressors);
    let solution = Ridge::solve(&regressors, &measured)?;
    let place = |input: usize| ORDER + N_TERMS * input;
    let response = DVector::from_fn(n_inputs, |input, _| {
        solution.unknowns[place(input)] / lengths[place(input)]
    });
    let covariance = DMatrix::from_fn(n_inputs, n_inputs, |i, j| {
        solution.covariance(place(i), place(j)) / (lengths[place(i)] * lengths[place(j)])
    });
    Some((response, covariance))
}

impl WholeLine {
    /// Factor of an unknown: denominator, numerators input by input, transients experiment by
    /// experiment.
    fn regressor(&self, [output, experiment]: [usize; 2], column: usize) -> Complex64 {
        let power = |order: usize| self.place.powi(order as i32);
        let Some(column) = column.checked_sub(ORDER) else {
            return -self.y[(output, experiment)] * power(column + 1);
        };
        let (signal, order) = (column / N_TERMS, column % N_TERMS);
        match signal.checked_sub(self.u.nrows()) {
            None => self.u[(signal, experiment)] * power(order),
            Some(transient) if transient == experiment => power(order).into(),
            Some(_) => 0.0.into(),
        }
    }
}

/// Scales every column to length 1; returns what the lengths were, 1 for columns of zeros.
fn normalize(matrix: &mut Matrix) -> Vec<f64> {
    let lengths = matrix.column_iter().map(|column| column.norm());
    let lengths: Vec<f64> = lengths.map(|n| if n > 0.0 { n } else { 1.0 }).collect();
    for (mut column, length) in zip(matrix.column_iter_mut(), &lengths) {
        column.unscale_mut(*length);
    }
    lengths
}

/// A least-squares solution that is a little drawn to zero.
struct Ridge {
    unknowns: DVector<Complex64>,
    /// `R^-1` of the QR decomposition.
    inverse: Matrix,
    /// Variance of a measured value, from the residuals.
    variance: f64,
}

impl Ridge {
    fn solve(regressors: &Matrix, measured: &DVector<Complex64>) -> Option<Self> {
        let (n_rows, n_columns) = regressors.shape();
        let mut matrix = regressors
            .clone()
            .resize_vertically(n_rows + n_columns, 0.0.into());
        matrix
            .rows_mut(n_rows, n_columns)
            .fill_diagonal(RIDGE.into());
        let mut turned = measured
            .clone()
            .resize_vertically(n_rows + n_columns, 0.0.into());
        let qr = matrix.qr();
        qr.q_tr_mul(&mut turned);
        let r = qr.r();
        let unknowns = r.solve_upper_triangular(&turned.rows(0, n_columns).into_owned())?;
        let residual = measured - regressors * &unknowns;
        Some(Self {
            inverse: r.solve_upper_triangular(&DMatrix::identity(n_columns, n_columns))?,
            variance: residual.norm_squared() / (n_rows - n_columns) as f64,
            unknowns,
        })
    }

    /// Covariance of two unknowns.
    fn covariance(&self, i: usize, j: usize) -> Complex64 {
        let rows = (self.inverse.row(i), self.inverse.row(j));
        let product = rows.1.dotc(&rows.0);
        product * self.variance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{normal, stream};

    /// A mode of half width `damping` in a 2x2 plant, and transients with the same poles: lines of
    /// three experiments.
    fn lines(damping: f64, noise: f64, seed: u64) -> (Vec<WholeLine>, Matrix) {
        let mut rng = stream(seed, "local rational", &[]);
        let mut random = |rows, columns| {
            DMatrix::from_fn(rows, columns, |_, _| {
                Complex64::new(normal(&mut rng), normal(&mut rng))
            })
        };
        let (constant, mode) = (random(2, 2), random(2, 2));
        let end = random(2, 3);
        let pole = |x: f64| Complex64::new(damping, 2.0 * (x - 0.1)).inv();
        let response = |x: f64| &constant + &mode * pole(x);
        let places = (0..21).map(|k| f64::from(k) / 10.0 - 1.0);
        let lines = places.map(|place| {
            let u = random(2, 3);
            let y = response(place) * &u + &end * pole(place);
            let y = y + random(2, 3) * Complex64::from(noise);
            WholeLine { place, u, y }
        });
        (lines.collect(), response(0.0))
    }

    #[test]
    fn a_sharp_mode_and_its_transient_are_exact() {
        let (lines, truth) = lines(1e-3, 0.0, 1);
        let fit = LocalFit::of(&lines).expect("enough lines");
        let error = (fit.response - &truth).norm() / truth.norm();
        assert!(error < 1e-9, "{error:e}");
    }

    /// Over a smooth mode: 95 % of |dG|^2 lie below `variance F_95(2, 2 dof)`, dof = 63 - 17.
    #[test]
    fn the_covariance_is_that_of_the_errors() {
        let (mut n_inside, mut n_all) = (0, 0);
        for seed in 0..150 {
            let (lines, truth) = lines(3.0, 1e-3, seed);
            let fit = LocalFit::of(&lines).expect("enough lines");
            for (output, covariance) in fit.covariances.iter().enumerate() {
                for input in 0..2 {
                    let error = fit.response[(output, input)] - truth[(output, input)];
                    n_all += 1;
                    n_inside +=
                        usize::from(error.norm_sqr() <= 3.095 * covariance[(input, input)].re);
                }
            }
        }
        let share = f64::from(n_inside as u32) / f64::from(n_all);
        assert!((0.92..0.98).contains(&share), "{share}");
    }

    #[test]
    fn too_few_lines_are_no_fit() {
        let (lines, _) = lines(1e-3, 0.0, 1);
        assert!(LocalFit::of(&lines[..11]).is_none());
        assert!(LocalFit::of(&[]).is_none());
    }
}
