//! Local models: an FRF from records of any excitation, each frequency from the lines of whole records
//! around it, leakage and transients modelled with it.
//!
//! Over a narrow band every row i of the FRF is a rational function, and what a record of finite length
//! leaves at its ends (the transient T) has the same poles. With x, the distance from the frequency over
//! the half width of the band,
//!
//! ```text
//! Z_im (1 + a_1 x + a_2 x^2) = sum_j W_jm (b_j0 + b_j1 x + b_j2 x^2) + t_m0 + t_m1 x + t_m2 x^2
//! ```
//!
//! for every piece m of the records, W being the inputs or, where there is a reference, that: then Z holds
//! outputs and inputs, and G = Z_y Z_u^-1 is not biased by noise that goes round the loop. Exact where one
//! mode lies within the band, however little it is damped. The width of the band is chosen
//! ([`crate::frf::local::widths`]) or given.
//!
//! Sources: R. Pintelon, J. Schoukens, System Identification, 2nd ed., ch. 7; T. McKelvey, G. Guerin,
//! Non-parametric frequency response estimation using a local rational model, SYSID 2012;
//! E. Geerardyn, T. Oomen, Local rational modeling for closed loops, 2017.

pub(crate) mod fitted;
mod least_squares;
mod pieces;
mod row_fit;
#[cfg(test)]
mod tests;
mod widths;
pub(crate) mod window;

use frfid_signals::{Frf, Uncertainty, confidence_factor_95};
use ndarray::{Array3, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::error::deficient_line::DeficientLine;
use crate::frf::estimate::FrfEstimate;
use crate::frf::local::fitted::Fitted;
use crate::frf::local::pieces::Pieces;
use crate::frf::local::widths::{Choice, chosen};

/// A piece of a record without holes, as it was measured.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Plant input, `(channel, sample)`.
    pub u: ArrayView2<'a, f64>,
    /// Plant output.
    pub y: ArrayView2<'a, f64>,
    /// Reference; none in open loop.
    pub r: Option<ArrayView2<'a, f64>>,
}

/// How local models are fitted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LocalOptions {
    /// Lines of the longest piece to either side of a frequency; chosen frequency by frequency without.
    pub half_width: Option<usize>,
}

/// An FRF by local models.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalEstimate {
    /// The FRF and the frequencies at which nothing can be known; its total covariance holds noise and
    /// distortion, which within a band cannot be told apart.
    pub estimate: FrfEstimate,
    /// Half widths in lines of the longest piece.
    pub half_widths: Vec<usize>,
}

/// FRF at `frequency_hz`, rising, from pieces of records of any excitation.
///
/// # Errors
/// [`EstimateError`]: pieces of other shapes, too short for a model, samples that are not finite, frequencies
/// that do not rise or lie outside, no frequency at which the inputs can be told apart.
pub fn estimate_local(
    pieces: &[Piece],
    sample_time_s: f64,
    frequency_hz: &[f64],
    options: &LocalOptions,
) -> Result<LocalEstimate, EstimateError> {
    let pieces = Pieces::of(pieces, sample_time_s, frequency_hz)?;
    let choices = chosen(&pieces, frequency_hz, options.half_width)?;
    let most = choices
        .iter()
        .map(Choice::degrees_of_freedom)
        .fold(0.0, f64::max);
    let mut frf = empty(&pieces, frequency_hz, most)?;
    for (line, choice) in choices.iter().enumerate() {
        if let Some(fitted) = choice.fitted() {
            put(&mut frf, line, fitted, most);
        }
    }
    let left_out: Vec<DeficientLine> = choices.iter().filter_map(Choice::deficiency).collect();
    if left_out.len() == frequency_hz.len() {
        return Err(EstimateError::RankDeficient(left_out));
    }
    Ok(LocalEstimate {
        estimate: FrfEstimate::of(frf, left_out),
        half_widths: choices.iter().map(|choice| choice.half_width).collect(),
    })
}

/// An FRF of which nothing is known yet.
fn empty(pieces: &Pieces, frequency_hz: &[f64], freedom: f64) -> Result<Frf, EstimateError> {
    let unknown = Complex64::new(f64::NAN, f64::NAN);
    let (lines, [outputs, inputs]) = (frequency_hz.len(), pieces.size());
    let entries = outputs * inputs;
    let response = Array3::from_elem((lines, outputs, inputs), unknown);
    let mut frf = Frf::new(frequency_hz.to_vec(), response)?;
    frf.total = Some(Uncertainty {
        covariance: Array3::from_elem((lines, entries, entries), unknown),
        degrees_of_freedom: freedom,
    });
    Ok(frf)
}

/// Puts what was fitted at a line; its covariance such that the region is right with the degrees of freedom
/// of all.
fn put(frf: &mut Frf, line: usize, fitted: &Fitted, freedom: f64) {
    let n_outputs = fitted.response.nrows();
    let wider = confidence_factor_95(fitted.degrees_of_freedom) / confidence_factor_95(freedom);
    for (k, value) in fitted.response.iter().enumerate() {
        frf.response[[line, k % n_outputs, k / n_outputs]] = *value;
    }
    let n = fitted.covariance.nrows();
    for total in frf.total.iter_mut() {
        for (k, value) in fitted.covariance.iter().enumerate() {
            total.covariance[[line, k % n, k / n]] = value * wider;
        }
    }
}
