//! Fits of a local model at every frequency, of which the widest that agrees with all narrower ones is taken.
//!
//! A wide band averages more noise, a narrow one is less biased by what the model lacks. The fit of a width
//! is taken if it lies within the region of the fit of every narrower one (intersection of confidence
//! intervals: A. Goldenshluger, A. Nemirovski, On spatially adaptive estimation of nonparametric
//! regression, Math. Meth. Statist. 6 (1997) 135-170) and leaves no larger residual: without noise the
//! residuals are what the model lacks, and grow with the band. Among neighbouring frequencies the median of
//! the widths counts, since a noise of few degrees of freedom is at times too small by chance. What the fit
//! taken is off the one before it, beyond what noise of one degree of freedom is in the median, counts as
//! bias and is added to its covariance: regions hold 94 to 95 % (tests/peers/local_coverage.py).
//!
//! Noise on an answer biases the denominator of a rational function, the more the wider the band. Where a polynomial
//! agrees with the narrowest rational fit, poles explain no more than chance, and it is much surer, it is taken.

use std::iter::zip;

use frfid_signals::median;
use nalgebra::DVector;
use num_complex::Complex64;

use crate::frf::local::agreement::{agree, explains_more};
use crate::frf::local::fitted::Fitted;

/// Frequencies to either side among which the median counts.
const NEIGHBOURS: usize = 4;
/// What a difference of two fits typically is, squared, over its variance.
const TYPICAL: f64 = 0.5;
/// A polynomial is taken for a rational function where its variance is less than this share of the other's.
const SURER: f64 = 0.3;

/// The fits at one frequency, by width.
pub(super) type Fits = Vec<Option<Fitted>>;

/// The fits of one model at every frequency, and the widths that are taken.
pub(super) struct Fitting {
    fits: Vec<Fits>,
    widths: Vec<usize>,
}

impl Fitting {
    /// The widest of the fits that agree with the narrower ones, and with what else is asked.
    pub(super) fn of(fits: Vec<Fits>, agrees: impl Fn((usize, usize), &Fitted) -> bool) -> Self {
        let widths = smoothed(&widest(&fits, agrees));
        Self { fits, widths }
    }

    /// The width that is taken at a line, or the widest below it that is there, and its fit.
    fn taken(&self, line: usize) -> Option<(usize, Fitted)> {
        let mut widths = (0..=self.widths[line]).rev();
        widths.find_map(|width| Some((width, with_bias(&self.fits[line], width)?)))
    }

    /// Whether a fit of a simpler model agrees with the narrowest, the one that is least biased: by what the model lacks,
    /// and by noise on an answer, which stands in its denominator's equations. At its own width the poles of the other may
    /// explain no more than chance.
    pub(super) fn agrees(&self, (line, width): (usize, usize), simpler: &Fitted) -> bool {
        let fits = &self.fits[line];
        let same = fits[width].as_ref();
        let least_biased = fits.iter().flatten().next();
        least_biased.is_some_and(|fit| agree(fit, simpler, 1.0))
            && same.is_some_and(|fit| !explains_more(fit, simpler))
    }

    /// The fit that is taken at a line and its width: of a simpler model where that agrees and is much surer.
    pub(super) fn surest(&self, line: usize, simpler: &Self) -> Option<(usize, Fitted)> {
        let taken = self.taken(line)?;
        let is_surer = |(width, simple): &(usize, Fitted)| {
            trace(simple) < SURER * trace(&taken.1) && self.agrees((line, *width), simple)
        };
        simpler.taken(line).filter(is_surer).or(Some(taken))
    }
}

/// For each frequency the widest fit that agrees with all narrower ones.
fn widest(fits: &[Fits], also: impl Fn((usize, usize), &Fitted) -> bool) -> Vec<usize> {
    let n_widths = fits.first().map_or(0, Vec::len);
    let noise: Vec<Vec<f64>> = (0..n_widths)
        .map(|width| usual_noise(fits, width))
        .collect();
    let widest_at = |(line, fits): (usize, &Fits)| {
        let wider = |width: usize| noise[width][line];
        let agrees = |width: &usize| {
            let Some(fit) = &fits[*width] else {
                return false;
            };
            let agrees = |narrower: usize| {
                let narrow = fits[narrower].as_ref();
                narrow.is_none_or(|narrow| agree(narrow, fit, wider(narrower)))
            };
            also((line, *width), fit) && (0..*width).all(agrees)
        };
        (1..n_widths).take_while(agrees).last().unwrap_or(0)
    };
    fits.iter().enumerate().map(widest_at).collect()
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
