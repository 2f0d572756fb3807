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
//! ([`crate::frf::local::fitting`]) or given, and so is whether there is a denominator.
//!
//! Sources: R. Pintelon, J. Schoukens, System Identification, 2nd ed., ch. 7; T. McKelvey, G. Guerin,
//! Non-parametric frequency response estimation using a local rational model, SYSID 2012;
//! E. Geerardyn, T. Oomen, Local rational modeling for closed loops, 2017.

mod agreement;
pub(crate) mod column;
mod equations;
pub(crate) mod fitted;
mod fitting;
mod moments;
mod normal_equations;
mod pieces;
mod repeats;
pub(crate) mod row_fit;
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
use crate::frf::local::window::Window;
use crate::frf::matrices::{Matrix, room_for_covariances};
use crate::spectra::campaign::Campaign;

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

/// What an FRF is over a narrow band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LocalModel {
    /// A rational function: sharp resonances, too.
    #[default]
    Rational,
    /// A polynomial (LPM): fewer unknowns, right where the FRF is smooth from line to line.
    Polynomial,
}

impl LocalModel {
    /// Order of the denominator: one mode needs two.
    fn n_poles(self) -> usize {
        match self {
            Self::Rational => 2,
            Self::Polynomial => 0,
        }
    }
}

/// How local models are fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalOptions {
    /// What the FRF is over a narrow band.
    pub model: LocalModel,
    /// Lines of the longest piece to either side of a frequency; chosen frequency by frequency without.
    pub half_width: Option<usize>,
    /// Largest condition number of the inputs in a window, rows scaled to equal size.
    pub max_condition: f64,
}

impl Default for LocalOptions {
    fn default() -> Self {
        Self {
            model: LocalModel::Rational,
            half_width: None,
            max_condition: 1e6,
        }
    }
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
    of_pieces(&pieces, frequency_hz, options)
}

/// FRF of a campaign at `frequency_hz`, rising: a piece of every realization and experiment, the mean of its
/// periods, whose differences are its noise.
///
/// # Errors
/// As [`estimate_local`].
pub(crate) fn estimate_campaign(
    campaign: &Campaign,
    frequency_hz: &[f64],
    options: &LocalOptions,
) -> Result<LocalEstimate, EstimateError> {
    of_pieces(&Pieces::of_campaign(campaign)?, frequency_hz, options)
}

/// The fits of one width to a campaign, frequency by frequency; `None` where its lines are fewer than so many
/// equations for each unknown.
///
/// # Errors
/// [`EstimateError::EmptyList`] without runs.
pub(crate) fn fits_of_width(
    campaign: &Campaign,
    frequency_hz: &[f64],
    half_width: usize,
    equations_per_unknown: f64,
) -> Result<Vec<Option<Fitted>>, EstimateError> {
    let pieces = Pieces::of_campaign(campaign)?;
    let fit = |hz: &f64| {
        let window = Window::around(&pieces, *hz, half_width, LocalModel::default());
        let is_enough = window.has_equations(equations_per_unknown);
        is_enough.then(|| Fitted::of(&window))?
    };
    Ok(frequency_hz.iter().map(fit).collect())
}

fn of_pieces(
    pieces: &Pieces,
    frequency_hz: &[f64],
    options: &LocalOptions,
) -> Result<LocalEstimate, EstimateError> {
    let [n_outputs, n_inputs] = pieces.size();
    room_for_covariances(frequency_hz.len(), n_outputs, n_inputs)?;
    let choices = chosen(pieces, frequency_hz, options)?;
    let mut frf = empty(pieces, frequency_hz, &choices)?;
    for (line, choice) in choices.iter().enumerate() {
        if let Some(fitted) = choice.fitted() {
            put(&mut frf, line, fitted);
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

/// An FRF of which nothing is known yet, with the largest degrees of freedom of all fits.
fn empty(pieces: &Pieces, frequency_hz: &[f64], choices: &[Choice]) -> Result<Frf, EstimateError> {
    let unknown = Complex64::new(f64::NAN, f64::NAN);
    let (lines, [outputs, inputs]) = (frequency_hz.len(), pieces.size());
    let entries = outputs * inputs;
    let response = Array3::from_elem((lines, outputs, inputs), unknown);
    let uncertainty = |degrees_of_freedom: f64| Uncertainty {
        covariance: Array3::from_elem((lines, entries, entries), unknown),
        degrees_of_freedom,
    };
    let fits = || choices.iter().filter_map(Choice::fitted);
    let of_noise = fits().filter_map(|fitted| fitted.of_noise.as_ref());
    let of_noise = of_noise.map(|noise| noise.degrees_of_freedom);
    let total = fits().map(|fitted| fitted.degrees_of_freedom);
    let mut frf = Frf::new(frequency_hz.to_vec(), response)?;
    frf.noise = of_noise.reduce(f64::max).map(uncertainty);
    frf.total = Some(uncertainty(total.fold(0.0, f64::max)));
    frf.condition = Some(vec![f64::NAN; lines]);
    Ok(frf)
}

/// Puts what was fitted at a line.
fn put(frf: &mut Frf, line: usize, fitted: &Fitted) {
    let n_outputs = fitted.response.nrows();
    for (k, value) in fitted.response.iter().enumerate() {
        frf.response[[line, k % n_outputs, k / n_outputs]] = *value;
    }
    if let Some(total) = &mut frf.total {
        let own = (&fitted.covariance, fitted.degrees_of_freedom);
        put_covariance(total, line, own);
    }
    if let Some((noise, own)) = frf.noise.as_mut().zip(fitted.of_noise.as_ref()) {
        put_covariance(noise, line, (&own.covariance, own.degrees_of_freedom));
    }
    for condition in frf.condition.iter_mut() {
        condition[line] = fitted.condition;
    }
}

/// Puts a covariance with its degrees of freedom such that the region is right with those of all.
fn put_covariance(all: &mut Uncertainty, line: usize, (covariance, freedom): (&Matrix, f64)) {
    let wider = confidence_factor_95(freedom) / confidence_factor_95(all.degrees_of_freedom);
    let n = covariance.nrows();
    for (k, value) in covariance.iter().enumerate() {
        all.covariance[[line, k % n, k / n]] = value * wider;
    }
}
