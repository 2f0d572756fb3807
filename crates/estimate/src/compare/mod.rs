//! Comparison of two FRFs: whether they agree within their noise, what moved, what is damped, and
//! what that says about the machine.

pub(crate) mod agreement;
pub(crate) mod change;
pub(crate) mod curve;
pub(crate) mod entry;
/// Resonances and antiresonances of one curve, each with its errors.
pub(crate) mod feature {
    mod fitted_extremum;
    mod parabola;
    mod prominence;
    mod rational_fit;
    pub(crate) mod resonance;
    mod windows;
}
pub(crate) mod measured;
mod pairing;
mod scatter;
pub(crate) mod verdict;

use std::iter::zip;

use frfid_signals::{Frf, checks::require_shape};
use ndarray::{ArrayView2, indices};
use num_complex::Complex64;

use crate::compare::agreement::{Agreement, agreements};
use crate::compare::change::{Side, Sides};
use crate::compare::entry::{EntryComparison, compare_entry};
use crate::compare::measured::Measured;
use crate::compare::verdict::Judgement;
use crate::compare::verdict::judgement::judge;
use crate::error::EstimateError;

/// How two FRFs are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompareOptions {
    /// Which FRF was measured with the stronger excitation; `None` if that is not known.
    pub stronger: Option<Side>,
    /// Least height of a resonance, or depth of an antiresonance, in dB.
    pub prominence_db: f64,
    /// Largest ratio of frequencies at which two resonances can be the same one.
    pub largest_shift: f64,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            stronger: None,
            prominence_db: 3.0,
            largest_shift: 1.5,
        }
    }
}

/// Comparison of two FRFs.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Band they share in Hz.
    pub band_hz: (f64, f64),
    /// Lines within that band of which nothing is known (NaN): they are left out.
    pub unknown_lines: Sides<usize>,
    /// Whether they agree within their noise.
    pub agreement: Agreement,
    /// What all entries together say about the machine; `None` if the FRFs agree, or nothing stands
    /// out.
    pub judgement: Option<Judgement>,
    /// Every entry, outputs first.
    pub entries: Vec<EntryComparison>,
}

/// Compares `b` with `a` over the band they share: first whether they agree within their noise, then
/// the resonances and antiresonances of every entry, which may lie on other lines, then what all of
/// it says about the machine.
///
/// ```
/// use frfid_estimate::{CompareOptions, compare};
/// use frfid_signals::Frf;
/// use ndarray::Array3;
/// use num_complex::Complex64;
///
/// // two resonators, damping 5 %, at 10 Hz and at 13 Hz
/// let resonator = |resonance_hz: f64| {
///     let hz: Vec<f64> = (0..400).map(|k| 2.0 * 25f64.powf(f64::from(k) / 399.0)).collect();
///     let response = Array3::from_shape_fn((400, 1, 1), |(k, ..)| {
///         let ratio = hz[k] / resonance_hz;
///         Complex64::ONE / Complex64::new(1.0 - ratio * ratio, 0.1 * ratio)
///     });
///     Frf { frequency_hz: hz, response, noise: None, total: None, condition: None, relative_resolution: None }
/// };
/// let comparison = compare(&resonator(10.0), &resonator(13.0), &CompareOptions::default())?;
/// let shift_percent = comparison.entries[0].changes[0].shift_percent();
/// assert!(shift_percent.is_some_and(|shift| (shift - 30.0).abs() < 1.0));
/// # Ok::<(), frfid_estimate::EstimateError>(())
/// ```
///
/// # Errors
/// [`frfid_signals::SignalError::Shape`] for other numbers of channels,
/// [`EstimateError::NoCommonBand`] with fewer than three known frequencies of either in the common
/// band.
pub fn compare(a: &Frf, b: &Frf, options: &CompareOptions) -> Result<Comparison, EstimateError> {
    a.check()?;
    b.check()?;
    let (n_outputs, n_inputs) = (a.n_outputs(), a.n_inputs());
    let fits = (b.n_outputs(), b.n_inputs()) == (n_outputs, n_inputs);
    let needed = format_args!("(frequency, {n_outputs}, {n_inputs}), as a");
    require_shape("b", b.response.shape(), fits, needed)?;
    let band_hz = common_band(a, b)?;
    let (a, b) = (&Measured::of(a), &Measured::of(b));
    let (agreement, each) = agreements(a, b, band_hz);
    let places = indices((n_outputs, n_inputs)).into_iter();
    let entries = zip(places, each)
        .map(|(place, agreement)| compare_entry((a, b), place, agreement, band_hz, options));
    let entries: Vec<EntryComparison> = entries.collect();
    let judgement = judge(
        &entries,
        n_outputs == n_inputs,
        &agreement,
        options.stronger,
    );
    let unknown = |frf: &Frf| n_within(frf, band_hz) - n_known_within(frf, band_hz);
    Ok(Comparison {
        band_hz,
        unknown_lines: Sides {
            a: unknown(a.frf),
            b: unknown(b.frf),
        },
        agreement,
        judgement,
        entries,
    })
}

/// The band in which both have frequencies, at least three each.
fn common_band(a: &Frf, b: &Frf) -> Result<(f64, f64), EstimateError> {
    let (a_hz, b_hz) = (ends_hz(a), ends_hz(b));
    let band_hz = (a_hz.0.max(b_hz.0), a_hz.1.min(b_hz.1));
    let found = n_known_within(a, band_hz).min(n_known_within(b, band_hz));
    if found < 3 {
        return Err(EstimateError::NoCommonBand { a_hz, b_hz, found });
    }
    Ok(band_hz)
}

/// Number of frequencies in a band.
fn n_within(frf: &Frf, band_hz: (f64, f64)) -> usize {
    let inside = |hz: &&f64| is_within(band_hz, **hz);
    frf.frequency_hz.iter().filter(inside).count()
}

/// Number of frequencies in a band at which any entry is known.
fn n_known_within(frf: &Frf, band_hz: (f64, f64)) -> usize {
    let lines = zip(&frf.frequency_hz, frf.response.outer_iter());
    let is_known = |response: ArrayView2<Complex64>| response.iter().any(|value| value.is_finite());
    lines
        .filter(|(hz, response)| is_within(band_hz, **hz) && is_known(*response))
        .count()
}

/// Lowest and highest frequency in Hz; not a number without any.
fn ends_hz(frf: &Frf) -> (f64, f64) {
    let hz = &frf.frequency_hz;
    (
        hz.first().copied().unwrap_or(f64::NAN),
        hz.last().copied().unwrap_or(f64::NAN),
    )
}

pub(crate) fn is_within(band_hz: (f64, f64), hz: f64) -> bool {
    (band_hz.0..=band_hz.1).contains(&hz)
}
