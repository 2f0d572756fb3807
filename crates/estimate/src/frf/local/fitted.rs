//! Local fit of an FRF at one frequency with the covariance of its entries.
//!
//! With S = 1 and c_i = e_i in open loop, S = Z_u^-1 and c_i = (e_i, -G_i) through a reference, an error of
//! the rows z of the fit is one of the FRF by
//!
//! ```text
//! dG_ij = sum_z c_iz sum_l S_lj dZ_zl,   dZ_zl = sum_k F_zl,k V_z,k
//! Cov(dG_ij, dG_pq) = sum_zw c_iz conj(c_pw) sigma_zw (S^T F_z F_w^H conj(S))_jq
//! ```
//!
//! F from [`RowFit`], sigma the covariance of the noise V, from the residuals.

use std::iter::zip;

use num_complex::Complex64;

use crate::frf::local::column::Column;
use crate::frf::local::repeats::Scatter;
use crate::frf::local::row_fit::{RowFit, fit_rows, fit_rows_of_both};
use crate::frf::local::window::Window;
use crate::frf::matrices::Matrix;

/// An FRF at one frequency.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// `(output, input)`.
    pub(crate) response: Matrix,
    /// Of vec(G), from what the fit leaves: noise and distortion.
    pub(crate) covariance: Matrix,
    pub(super) degrees_of_freedom: f64,
    /// Of vec(G), from what repeats differ by: noise alone; `None` without repeats.
    pub(super) of_noise: Option<Scatter>,
    /// Condition number of the inputs in the window.
    pub(super) condition: f64,
    /// Noise of the answers, the geometric mean of their variances; as it is, and before it passed through the
    /// poles of the fit.
    pub(super) noise: [f64; 2],
    /// How many answers.
    pub(super) n_rows: usize,
}

impl Fitted {
    /// The fit to a window; `None` where it does not determine the FRF.
    pub(crate) fn of(window: &Window) -> Option<Self> {
        Self::of_rows(window, fit_rows(window), window.n_free())
    }

    /// The same, and what it is without poles.
    pub(super) fn of_both(window: &Window) -> [Option<Self>; 2] {
        let [rational, polynomial] = fit_rows_of_both(window);
        [
            Self::of_rows(window, rational, window.n_free()),
            Self::of_rows(window, polynomial, window.n_free() + window.n_poles),
        ]
    }

    fn of_rows(window: &Window, rows: Vec<RowFit>, n_free: usize) -> Option<Self> {
        let n_free = n_free as f64;
        let sigma = noise_covariance(&rows, n_free);
        let through = Through::of(&rows, window.n_outputs)?;
        let of_noise = |scatter: &Scatter| Scatter {
            covariance: through.covariance(&rows, &through.of_answers(&scatter.covariance)),
            degrees_of_freedom: scatter.degrees_of_freedom,
        };
        Some(Self {
            covariance: through.covariance(&rows, &sigma),
            of_noise: window.scatter.as_ref().map(of_noise),
            condition: window.condition(),
            response: through.response,
            degrees_of_freedom: n_free,
            noise: [
                level(&rows, |row| &row.noise, n_free),
                level(&rows, |row| &row.equation_error, n_free),
            ],
            n_rows: rows.len(),
        })
    }

    /// How far another fit is off, in variances of this one, mean of the entries.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let differences = zip(&self.response, &other.response).map(|(a, b)| (a - b).norm_sqr());
        let variances = self.covariance.diagonal();
        let ratios =
            zip(differences, &variances).map(|(square, variance)| ratio(square, variance.re));
        ratios.sum::<f64>() / self.response.len() as f64
    }
}

/// Geometric mean of the variances of signals.
fn level(rows: &[RowFit], of: fn(&RowFit) -> &Column, n_free: f64) -> f64 {
    let power = |row: &RowFit| of(row).norm_squared() / n_free;
    let logs = rows
        .iter()
        .map(|row| power(row).max(f64::MIN_POSITIVE).ln());
    (logs.sum::<f64>() / rows.len() as f64).exp()
}

/// A square over a variance; nothing is never off.
fn ratio(square: f64, variance: f64) -> f64 {
    if square == 0.0 {
        0.0
    } else {
        square / variance
    }
}

/// Covariance of the noise of the answers.
fn noise_covariance(rows: &[RowFit], n_free: f64) -> Matrix {
    Matrix::from_fn(rows.len(), rows.len(), |z, w| {
        rows[w].noise.dot(&rows[z].noise) / n_free
    })
}

/// The way from the rows of a fit to the FRF.
struct Through {
    response: Matrix,
    /// S; `None` in open loop, where it is one.
    inverse: Option<Matrix>,
    /// c, `(output, row)`.
    shares: Matrix,
}

impl Through {
    /// Of rows of which the first are outputs; the others, if there are any, inputs. `None` where the drives do
    /// not move the inputs apart.
    fn of(rows: &[RowFit], n_outputs: usize) -> Option<Self> {
        let n_drives = rows.first()?.response.len();
        let all = Matrix::from_fn(rows.len(), n_drives, |row, drive| rows[row].response[drive]);
        let mut shares = Matrix::identity(n_outputs, rows.len());
        if rows.len() == n_outputs {
            return Some(Self {
                response: all,
                inverse: None,
                shares,
            });
        }
        let inverse = all.rows(n_outputs, n_drives).into_owned().try_inverse()?;
        let response = all.rows(0, n_outputs) * &inverse;
        shares
            .columns_mut(n_outputs, n_drives)
            .copy_from(&-&response);
        Some(Self {
            response,
            inverse: Some(inverse),
            shares,
        })
    }

    /// Covariance of the noise of the answers, of that of outputs and inputs: in open loop that of Y - G U.
    fn of_answers(&self, signals: &Matrix) -> Matrix {
        let (n_outputs, n_answers) = self.shares.shape();
        if n_answers == signals.nrows() {
            return signals.clone();
        }
        let mut left = Matrix::identity(n_outputs, signals.nrows());
        let n_inputs = self.response.ncols();
        left.columns_mut(n_outputs, n_inputs)
            .copy_from(&-&self.response);
        &left * signals * left.adjoint()
    }

    /// Covariance of vec(G): the pairs of rows below the diagonal are what those above it are, transposed.
    fn covariance(&self, rows: &[RowFit], sigma: &Matrix) -> Matrix {
        let n = self.response.len();
        let mut half = Matrix::zeros(n, n);
        for z in 0..rows.len() {
            for w in z..rows.len() {
                let weight = if w == z { 0.5 } else { 1.0 };
                self.add_pair(&mut half, (rows, z, w), sigma[(z, w)] * weight);
            }
        }
        let whole = &half + half.adjoint();
        let Some(inverse) = &self.inverse else {
            return whole;
        };
        let outputs = Matrix::identity(self.response.nrows(), self.response.nrows());
        let through = inverse.transpose().kronecker(&outputs);
        &through * whole * through.adjoint()
    }

    /// Adds `sigma_zw c_iz conj(c_pw) (F_z F_w^H)_jq` of a pair of rows to all entries.
    fn add_pair(
        &self,
        all: &mut Matrix,
        (rows, z, w): (&[RowFit], usize, usize),
        sigma: Complex64,
    ) {
        let n_outputs = self.response.nrows();
        for (j, left) in rows[z].factors.iter().enumerate() {
            for (q, right) in rows[w].factors.iter().enumerate() {
                let product = left.dot(right) * sigma;
                for (i, p) in self.sharing(z, w) {
                    let share = self.shares[(i, z)] * self.shares[(p, w)].conj();
                    all[(i + n_outputs * j, p + n_outputs * q)] += product * share;
                }
            }
        }
    }

    /// Pairs of outputs that have a share of a pair of rows.
    fn sharing(&self, z: usize, w: usize) -> impl Iterator<Item = (usize, usize)> {
        let of = move |row: usize| {
            let outputs = 0..self.response.nrows();
            outputs.filter(move |output| self.shares[(*output, row)] != Complex64::ZERO)
        };
        of(z).flat_map(move |i| of(w).map(move |p| (i, p)))
    }
}
