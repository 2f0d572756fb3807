//! Bias of the excerpts of a chirp, seen from the whole record, as part of what is uncertain.
//!
//! An excerpt holds what rings on from the frequencies passed before, the less of it the more the
//! plant is damped: the same in every repeat, so that no spread over repeats shows it. The spectra of
//! the whole record know of no excerpts. From them the FRF follows by the local rational method
//! ([`crate::frf::local`]), G_w with covariance C_w, and
//!
//! ```text
//! b = vec(G - G_w),   covariance = noise covariance + b b^H + C_w
//! ```
//!
//! so that the 95 % region about G, whose radius is at least 1.73 times its standard deviation,
//! reaches beyond G_w. Harmonics, which excerpts leave out and the whole record does not, widen it.

use frfid_signals::{Frf, Uncertainty};
use nalgebra::DVector;
use ndarray::{ArrayViewMut2, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::local::fits_of_width;
use crate::frf::local::fitted::Fitted;
use crate::frf::matrices::{Matrix, matrix};
use crate::spectra::campaign::Campaign;

/// Lines of the whole record to either side of a frequency that are fitted. Fewer leave too little beyond the
/// unknowns to average noise, more hold several modes: of 10, 15 and 20 the region of 10 held the truth
/// most often on 2x2 and 3x3 plants and the shortest sweep; 7 was compared on single joints alone.
const HALF_WIDTH: usize = 10;
/// Least number of equations for each unknown.
const EQUATIONS_PER_UNKNOWN: f64 = 2.0;

/// Adds the bias to the covariances of `frf`, the estimate by excerpts of the recordings whose
/// [whole spectra](crate::WholeRecord) are in `whole`; where it cannot be told they become NaN. What is `None`
/// remains so.
///
/// # Errors
/// [`EstimateError::EmptyList`] without recordings.
pub fn add_excerpt_bias(frf: &mut Frf, whole: &Campaign) -> Result<(), EstimateError> {
    if frf.noise.is_none() && frf.total.is_none() {
        return Ok(());
    }
    let hz = &frf.frequency_hz;
    let fits = fits_of_width(whole, hz, HALF_WIDTH, EQUATIONS_PER_UNKNOWN)?;
    for (k, fit) in fits.into_iter().enumerate() {
        let response = matrix(frf.response.index_axis(Axis(0), k));
        let bias = fit.map(|fit| uncertain(&response, fit));
        for known in [&mut frf.noise, &mut frf.total].into_iter().flatten() {
            add_to(known, k, bias.as_ref());
        }
    }
    Ok(())
}

/// `b b^H + C_w` of the formula at the head of this file.
fn uncertain(response: &Matrix, fit: Fitted) -> Matrix {
    let bias = DVector::from_column_slice((response - &fit.response).as_slice());
    &bias * bias.adjoint() + fit.covariance
}

/// The entries of a matrix with their places.
fn indexed(matrix: &Matrix) -> impl Iterator<Item = ((usize, usize), Complex64)> {
    let (n_rows, entries) = (matrix.nrows(), matrix.iter().enumerate());
    entries.map(move |(k, &value)| ((k % n_rows, k / n_rows), value))
}

/// Adds to the covariance at one frequency; unknown where there is nothing to add.
fn add_to(known: &mut Uncertainty, frequency: usize, bias: Option<&Matrix>) {
    let mut covariance: ArrayViewMut2<Complex64> =
        known.covariance.index_axis_mut(Axis(0), frequency);
    match bias {
        None => covariance.fill(Complex64::new(f64::NAN, f64::NAN)),
        Some(bias) => indexed(bias).for_each(|((i, j), value)| covariance[[i, j]] += value),
    }
}
