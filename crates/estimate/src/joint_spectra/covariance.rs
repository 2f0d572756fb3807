//! Covariances of the spectra of input and output, as fits with noise on both need them.
//!
//! ```text
//! noise            C_Z = sum_pmq d d^H / sum_pm (n_q - 1),   d = Z_pmq - mean_q Z,   Z = [U; Y]    of one period
//! equation error   C_E = sum_pm E E^H / (n_p n_ex - n_u),   E = mean_q (Y - G U)    the fit of G takes n_u columns
//! its noise        C_N = [-G, I] C_Z [-G, I]^H / n_q
//! ```
//!
//! `C_E - C_N` is the covariance of the stochastic nonlinear distortion of one realization, signed: by chance
//! the noise alone may exceed the total. (R. Pintelon, J. Schoukens, System Identification, 2nd ed., sections
//! 2.5 and 4.3.)

use frfid_signals::Frf;
use frfid_signals::checks::require_shape;
use nalgebra::DMatrix;
use ndarray::{Array3, s};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::blocks::{mean, squares_about};
use crate::frf::matrices::{Matrix, matrices, matrix, stacked};
use crate::spectra::campaign::{Block, Campaign};
use crate::spectra::run_spectra::RunSpectra;

/// Covariances of the spectra, line by line, in squared units of the DFT.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectraCovariance {
    /// Noise of `[u; y]` in one period, `(line, n_u + n_y, n_u + n_y)`; `None` with one period.
    pub noise: Option<Array3<Complex64>>,
    /// Equation error `Y - G U` of the mean over the periods of a realization, `(line, n_y, n_y)`; `None` with
    /// one realization.
    pub equation_error: Option<Array3<Complex64>>,
    /// Its part by noise; `None` with one period.
    pub equation_noise: Option<Array3<Complex64>>,
}

impl SpectraCovariance {
    /// Stochastic nonlinear distortion of one realization, `equation_error - equation_noise`, signed; `None`
    /// unless both are known.
    #[must_use]
    pub fn nonlinear(&self) -> Option<Array3<Complex64>> {
        Some(self.equation_error.as_ref()? - self.equation_noise.as_ref()?)
    }
}

impl Campaign {
    /// Covariances of the spectra given so far, with the FRF that was estimated from them.
    ///
    /// # Errors
    /// [`EstimateError::Incomplete`], [`EstimateError::TooFewExperiments`]; [`frfid_signals::SignalError::Shape`] for an
    /// FRF of other lines or channels.
    pub fn spectra_covariance(&self, frf: &Frf) -> Result<SpectraCovariance, EstimateError> {
        let realizations = self.realizations()?;
        let first = realizations[0][0][0];
        let (n_u, n_lines) = first.u.dim();
        let needed = (n_lines, first.y.nrows(), n_u);
        let shape = frf.response.shape();
        require_shape(
            "frf",
            shape,
            frf.response.dim() == needed,
            format_args!("{needed:?}"),
        )?;
        let responses = matrices(frf);
        let lines = responses.iter().enumerate();
        let residuals = |(line, response)| equation_error(&realizations, line, response);
        let equation_error: Option<Vec<Matrix>> = lines.map(residuals).collect();
        let noise: Option<Vec<Matrix>> = (0..n_lines)
            .map(|line| noise(&realizations, line))
            .collect();
        let noise = noise.map(|noise| stacked(&noise));
        let n_q = fewest_periods(&realizations) as f64;
        Ok(SpectraCovariance {
            equation_noise: noise
                .as_ref()
                .map(|noise| of_equation(noise, &responses, n_q)),
            noise,
            equation_error: equation_error.map(|lines| stacked(&lines)),
        })
    }
}

fn fewest_periods(realizations: &[Vec<Block>]) -> usize {
    realizations.iter().map(Vec::len).min().unwrap_or(1)
}

/// `[u; y]` of every period of an experiment of a realization.
fn joint(periods: &[Block], experiment: usize, line: usize) -> Vec<Matrix> {
    let runs = periods.iter().map(|block| block[experiment]);
    let column = |run: &RunSpectra| {
        let channels = run.u.column(line).into_iter().chain(run.y.column(line));
        DMatrix::from_iterator(run.u.nrows() + run.y.nrows(), 1, channels.copied())
    };
    runs.map(column).collect()
}

/// `C_Z` of a line; `None` with one period.
fn noise(realizations: &[Vec<Block>], line: usize) -> Option<Matrix> {
    let experiments = 0..realizations[0][0].len();
    let all = experiments.flat_map(|m| realizations.iter().map(move |periods| (m, periods)));
    let scatter = |(experiment, periods): (usize, &Vec<Block>)| {
        let spectra = joint(periods, experiment, line);
        squares_about(&mean(&spectra), &spectra)
    };
    let sum: Matrix = all.map(scatter).sum();
    let n_experiments = realizations[0][0].len();
    let freedom: usize = realizations.iter().map(|periods| periods.len() - 1).sum();
    let freedom = n_experiments * freedom;
    (freedom > 0).then(|| sum / Complex64::from(freedom as f64))
}

/// `C_E` of a line; `None` with one realization.
fn equation_error(realizations: &[Vec<Block>], line: usize, response: &Matrix) -> Option<Matrix> {
    let n_experiments = realizations[0][0].len();
    let turn = residual_of(response);
    let error = |periods: &Vec<Block>, experiment| &turn * mean(&joint(periods, experiment, line));
    let places = (0..n_experiments).flat_map(|m| realizations.iter().map(move |p| (p, m)));
    let errors = places.map(|(periods, experiment)| error(periods, experiment));
    let sum: Matrix = errors.map(|error| &error * error.adjoint()).sum();
    let freedom = (realizations.len() * n_experiments).saturating_sub(response.ncols());
    let is_known = realizations.len() > 1 && freedom > 0;
    is_known.then(|| sum / Complex64::from(freedom as f64))
}

/// `[-G, I]`.
fn residual_of(response: &Matrix) -> Matrix {
    let (n_y, n_u) = response.shape();
    let mut turn = DMatrix::zeros(n_y, n_u + n_y);
    turn.columns_mut(0, n_u).copy_from(&-response);
    turn.columns_mut(n_u, n_y).fill_with_identity();
    turn
}

/// `C_N` of every line.
fn of_equation(
    noise: &Array3<Complex64>,
    responses: &[Matrix],
    n_periods: f64,
) -> Array3<Complex64> {
    let lines = responses.iter().enumerate().map(|(line, response)| {
        let turn = residual_of(response);
        let noise = matrix(noise.slice(s![line, .., ..]));
        &turn * noise * turn.adjoint() / Complex64::from(n_periods)
    });
    stacked(&lines.collect::<Vec<Matrix>>())
}
