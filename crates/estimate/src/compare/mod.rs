//! Comparison of two FRFs: what moved, what is damped, and what that says about stiffness and
//! friction.

pub(crate) mod bode;
pub(crate) mod change;
mod pairing;
pub(crate) mod resonance;
pub(crate) mod verdict;

use std::iter::zip;

use frfid_signals::{Frf, checks::require_shape, median};
use ndarray::{ArrayView2, indices};
use num_complex::Complex64;
use serde::Serialize;

use crate::compare::bode::Bode;
use crate::compare::change::{Change, Side, Sides};
use crate::compare::pairing::pair;
use crate::compare::resonance::{Feature, features_of};
use crate::compare::verdict::{Verdict, verdicts};
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

/// One entry of the two matrices compared, over the band they share.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EntryComparison {
    /// Output channel.
    pub output: usize,
    /// Input channel.
    pub input: usize,
    /// Resonances and antiresonances of A within the common band, and what became of them.
    pub changes: Vec<Change>,
    /// Features of B within the common band that A has not.
    pub only_in_b: Vec<Feature>,
    /// Median level of B over A in dB; NaN where they have no line in common.
    pub level_db: f64,
    /// Median size of the difference of levels in dB; NaN as well.
    pub difference_db: f64,
    /// Range of the phase (largest minus smallest, unwrapped) of A and of B in degrees; NaN where
    /// nothing is known of it.
    pub phase_range_deg: Sides<f64>,
    /// What it says about the machine; empty if nothing stands out.
    pub verdicts: Vec<Verdict>,
}

/// Comparison of two FRFs.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Band they share in Hz.
    pub band_hz: (f64, f64),
    /// Lines within that band of which nothing is known (NaN): they are left out.
    pub unknown_lines: Sides<usize>,
    /// Every entry, outputs first.
    pub entries: Vec<EntryComparison>,
}

/// Compares `b` with `a`, entry by entry, over the band they share; the frequency grids may differ.
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
    let entry = |entry| compare_entry(a, b, entry, band_hz, options);
    let entries = indices((n_outputs, n_inputs)).into_iter().map(entry);
    let unknown = |frf: &Frf| n_within(frf, band_hz) - n_known_within(frf, band_hz);
    Ok(Comparison {
        band_hz,
        unknown_lines: Sides {
            a: unknown(a),
            b: unknown(b),
        },
        entries: entries.collect(),
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

fn is_within(band_hz: (f64, f64), hz: f64) -> bool {
    (band_hz.0..=band_hz.1).contains(&hz)
}

fn compare_entry(
    a: &Frf,
    b: &Frf,
    (output, input): (usize, usize),
    band_hz: (f64, f64),
    options: &CompareOptions,
) -> EntryComparison {
    let (a, b) = (Bode::of(a, output, input), Bode::of(b, output, input));
    let features = |curve: &Bode| {
        let mut features = features_of(curve, options.prominence_db);
        features.retain(|feature| is_within(band_hz, feature.frequency_hz));
        features
    };
    let (changes, only_in_b) = pair(&features(&a), features(&b), &b, options.largest_shift);
    let levels = levels_db(&a, &b, band_hz);
    let phase_range_deg = phase_ranges_deg(&a, &b, band_hz);
    EntryComparison {
        output,
        input,
        verdicts: verdicts(&changes, phase_range_deg, options.stronger),
        changes,
        only_in_b,
        difference_db: median(levels.iter().map(|level| level.abs()).collect()).unwrap_or(f64::NAN),
        level_db: median(levels).unwrap_or(f64::NAN),
        phase_range_deg,
    }
}

/// Places of A's own frequencies in a band, on which both are compared.
fn places_in(a: &Bode, band_hz: (f64, f64)) -> impl Iterator<Item = usize> + Clone {
    (0..a.frequency_hz.len()).filter(move |&k| is_within(band_hz, a.frequency_hz[k]))
}

/// Levels of B over A in dB.
fn levels_db(a: &Bode, b: &Bode, band_hz: (f64, f64)) -> Vec<f64> {
    places_in(a, band_hz)
        .filter_map(|k| Some(b.magnitude_db_at(a.frequency_hz[k])? - a.magnitude_db[k]))
        .collect()
}

/// Ranges of the phase in degrees.
fn phase_ranges_deg(a: &Bode, b: &Bode, band_hz: (f64, f64)) -> Sides<f64> {
    let places = || places_in(a, band_hz);
    Sides {
        a: range(places().map(|k| a.phase_deg[k])),
        b: range(places().filter_map(|k| b.phase_deg_at(a.frequency_hz[k]))),
    }
}

/// The largest minus the smallest value; NaN of none.
fn range(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let high = values.clone().fold(f64::NEG_INFINITY, f64::max);
    let low = values.fold(f64::INFINITY, f64::min);
    if low <= high { high - low } else { f64::NAN }
}
