//! Widths of local models: at every frequency the widest that agrees with all narrower ones.
//!
//! A wide band averages more noise, a narrow one is less biased by what the model lacks. The fit of a width
//! is taken if it lies within the region of the fit of every narrower one (intersection of confidence
//! intervals: A. Goldenshluger, A. Nemirovski, On spatially adaptive estimation of nonparametric
//! regression, Math. Meth. Statist. 6 (1997) 135-170) and leaves no larger residual: without noise the
//! residuals are what the model lacks, and grow with the band. Among neighbouring frequencies the median of
//! the widths counts, since a noise of few degrees of freedom is at times too small by chance. What the fit
//! taken is off the one before it, beyond what noise of one degree of freedom is in the median, counts as
//! bias and is added to its covariance: regions hold 93 to 95 % (tests/peers/local_coverage.py).

use std::iter::zip;

use frfid_signals::median;
use nalgebra::DVector;
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::EstimateError;
use crate::error::deficient_line::{Deficiency, DeficientLine};
use crate::frf::f_distribution::f_tail;
use crate::frf::local::LocalOptions;
use crate::frf::local::column::Column;
use crate::frf::local::fitted::Fitted;
use crate::frf::local::pieces::{PieceSpectra, Pieces};
use crate::frf::local::window::Window;

/// One width over the one before it.
const STEP: f64 = 1.35;
/// Widths that are tried.
const N_WIDTHS: usize = 7;
/// Half widths over the frequency: the dynamics of machines change from octave to octave.
const WIDEST: f64 = 0.6;
/// Frequencies to either side among which the median counts.
const NEIGHBOURS: usize = 4;
/// Probability by which a fit may be as far off as it is: of many that are compared.
const AGREEMENT: f64 = 0.005;
/// Standard deviations of its logarithm by which a residual may grow.
const MOST_GROWTH: f64 = 2.5;
/// A residual that grows by less than this factor is noise still.
const LEAST_GROWTH: f64 = 2.0;
/// What a difference of two fits typically is, squared, over its variance.
const TYPICAL: f64 = 0.5;

/// What was chosen at one frequency.
pub(super) struct Choice {
    pub(super) half_width: usize,
    fitted: Result<Fitted, DeficientLine>,
}

impl Choice {
    /// The fit; `None` where nothing can be known.
    pub(super) fn fitted(&self) -> Option<&Fitted> {
        self.fitted.as_ref().ok()
    }

    /// Why nothing can be known.
    pub(super) fn deficiency(&self) -> Option<DeficientLine> {
        self.fitted.as_ref().err().cloned()
    }
}

/// The fits at one frequency, by width.
type Fits = Vec<Option<Fitted>>;

/// The fit at every frequency, of the width that is given or chosen.
///
/// # Errors
/// [`EstimateError`] of pieces too short for a window, and of a width that leaves no freedom.
pub(super) fn chosen(
    pieces: &Pieces,
    frequency_hz: &[f64],
    options: &LocalOptions,
) -> Result<Vec<Choice>, EstimateError> {
    let middle_hz = frequency_hz[frequency_hz.len() / 2];
    let half_widths = half_widths(pieces, middle_hz, options)?;
    let fits_at = |hz: &f64| -> Fits {
        let at = |half_width: &usize| {
            let window = Window::around(pieces, *hz, *half_width, options.model);
            let is_local = window.half_hz <= WIDEST * hz || *half_width == half_widths[0];
            is_local.then(|| fit(&window, options.max_condition))?
        };
        half_widths.iter().map(at).collect()
    };
    let fits: Vec<Fits> = frequency_hz.par_iter().map(fits_at).collect();
    let widths = smoothed(&widest(&fits));
    let choice = |(line, most): (usize, &usize)| {
        let is_there = |width: &usize| fits[line][*width].is_some();
        let width = (0..=*most).rev().find(is_there).unwrap_or(0);
        let hz = frequency_hz[line];
        let deficiency = || {
            let window = Window::around(pieces, hz, half_widths[0], options.model);
            deficiency(&window, hz, options.max_condition)
        };
        Choice {
            half_width: half_widths[width],
            fitted: with_bias(&fits[line], width).ok_or_else(deficiency),
        }
    };
    Ok(widths.iter().enumerate().map(choice).collect())
}

/// The fit to a window in which the inputs can be told apart.
fn fit(window: &Window, max_condition: f64) -> Option<Fitted> {
    let fitted = window.is_determined().then(|| Fitted::of(window))??;
    (fitted.condition <= max_condition).then_some(fitted)
}

/// The half widths that are tried: from the narrowest that determines a model to where the pieces end.
fn half_widths(
    pieces: &Pieces,
    hz: f64,
    options: &LocalOptions,
) -> Result<Vec<usize>, EstimateError> {
    let longest = pieces
        .all
        .iter()
        .map(PieceSpectra::n_lines)
        .max()
        .unwrap_or(0);
    let window = |half_width: usize| Window::around(pieces, hz, half_width, options.model);
    let is_enough = |half_width: &usize| window(*half_width).is_determined();
    if let Some(half_width) = options.half_width {
        return match half_width > 0 && is_enough(&half_width) {
            true => Ok(vec![half_width]),
            false => Err(EstimateError::NarrowWindow {
                half_width,
                needed: (1..=longest / 2).find(is_enough),
            }),
        };
    }
    let narrowest = (1..=longest / 2).find(is_enough);
    let narrowest = narrowest.ok_or(EstimateError::ShortRecord { n_lines: longest })?;
    let widths = (0..N_WIDTHS).map(|k| (narrowest as f64 * STEP.powi(k as i32)).round() as usize);
    Ok(widths
        .filter(|half_width| 2 * half_width < longest || *half_width == narrowest)
        .collect())
}

/// For each frequency the widest fit that agrees with all narrower ones.
fn widest(fits: &[Fits]) -> Vec<usize> {
    let n_widths = fits.first().map_or(0, Vec::len);
    let noise: Vec<Vec<f64>> = (0..n_widths)
        .map(|width| usual_noise(fits, width))
        .collect();
    let widest_at = |(line, fits): (usize, &Fits)| {
        let wider = |width: usize| noise[width][line];
        let agrees = |width: &usize| {
            (0..*width).all(|narrower| agree(&fits[narrower], &fits[*width], wider(narrower)))
        };
        (1..n_widths).take_while(agrees).last().unwrap_or(0)
    };
    fits.iter().enumerate().map(widest_at).collect()
}

/// Whether a fit agrees with a narrower one, whose noise is usually `wider` times as large.
fn agree(narrow: &Option<Fitted>, wide: &Option<Fitted>, wider: f64) -> bool {
    let (Some(narrow), Some(wide)) = (narrow, wide) else {
        return wide.is_some();
    };
    let distance = narrow.distance(wide) / wider;
    let is_near = f_tail(distance, narrow.response.len(), narrow.degrees_of_freedom) >= AGREEMENT;
    is_near && !grows(narrow, wide, wider)
}

/// Whether the residual of a wider fit is larger beyond chance.
fn grows(narrow: &Fitted, wide: &Fitted, wider: f64) -> bool {
    let rows = narrow.n_rows as f64;
    let variance = |fitted: &Fitted| 1.0 / (rows * fitted.degrees_of_freedom);
    let chance = (variance(narrow) + variance(wide)).sqrt();
    let growth = zip(wide.noise, narrow.noise).map(|(wide, narrow)| wide / narrow / wider);
    let growth = growth.fold(f64::INFINITY, f64::min).ln();
    growth > LEAST_GROWTH.ln().max(MOST_GROWTH * chance)
}

/// At each frequency the noise that neighbours see over that of the fit itself, at least 1.
fn usual_noise(fits: &[Fits], width: usize) -> Vec<f64> {
    let noise = |fits: &Fits| {
        fits[width]
            .as_ref()
            .map_or(f64::NAN, |fitted| fitted.noise[0])
    };
    let all: Vec<f64> = fits.iter().map(noise).collect();
    let usual = medians(&all);
    zip(usual, all)
        .map(|(usual, own)| (usual / own).max(1.0))
        .collect()
}

fn smoothed(widths: &[usize]) -> Vec<usize> {
    let all: Vec<f64> = widths.iter().map(|width| *width as f64).collect();
    medians(&all)
        .into_iter()
        .map(|width| width as usize)
        .collect()
}

/// Medians of what neighbours have, at the ends those to one side.
fn medians(all: &[f64]) -> Vec<f64> {
    let at = |place: usize| {
        let near = place.saturating_sub(NEIGHBOURS)..(place + NEIGHBOURS + 1).min(all.len());
        median(all[near].to_vec()).unwrap_or(f64::NAN)
    };
    (0..all.len()).map(at).collect()
}

/// The fit of a width with its bias in the covariance.
fn with_bias(fits: &Fits, width: usize) -> Option<Fitted> {
    let mut fitted = fits[width].clone()?;
    let beside = if width > 0 { width - 1 } else { 1 };
    if let Some(Some(other)) = fits.get(beside) {
        let difference = &fitted.response - &other.response;
        let bias = DVector::from_column_slice(difference.as_slice());
        let by_noise = TYPICAL * (trace(&fitted) - trace(other)).abs();
        let share = 1.0 - by_noise / bias.norm_squared().max(f64::MIN_POSITIVE);
        fitted.covariance += &bias * bias.adjoint() * Complex64::from(share.max(0.0));
    }
    Some(fitted)
}

fn trace(fitted: &Fitted) -> f64 {
    fitted
        .covariance
        .diagonal()
        .iter()
        .map(|variance| variance.re)
        .sum()
}

/// Why nothing is known at a frequency.
fn deficiency(window: &Window, frequency_hz: f64, limit: f64) -> DeficientLine {
    DeficientLine {
        frequency_hz,
        condition: window.condition(),
        limit,
        cause: cause(window.inputs()),
    }
}

fn cause(inputs: &[Column]) -> Deficiency {
    let silent = inputs.iter().position(Column::is_zero);
    silent.map_or(Deficiency::InputsAlike, |input| Deficiency::InputSilent {
        input,
    })
}
