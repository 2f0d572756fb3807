//! Two FRFs side by side: what moved, what is damped, and what that says about stiffness and
//! friction.

pub(crate) mod bode;
pub(crate) mod change;
pub(crate) mod resonance;
pub(crate) mod verdict;

use frfid_signals::{Frf, SignalError, median};
use serde::Serialize;

use crate::compare::bode::Bode;
use crate::compare::change::{Change, Side, Sides};
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
    /// Median level of B over A in dB.
    pub level_db: f64,
    /// Median size of the difference of levels in dB.
    pub difference_db: f64,
    /// Range of the phase (largest minus smallest, unwrapped) of A and of B in degrees.
    pub phase_range_deg: Sides<f64>,
    /// What it says about the machine; empty if nothing stands out.
    pub verdicts: Vec<Verdict>,
}

/// Comparison of two FRFs.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Band they share in Hz.
    pub band_hz: (f64, f64),
    /// Every entry, outputs first.
    pub entries: Vec<EntryComparison>,
}

/// Compares `b` with `a`, entry by entry, over the band they share; the frequency grids may differ.
///
/// # Errors
/// [`SignalError::Shape`] for other numbers of channels, [`EstimateError::NoCommonBand`] with fewer
/// than three frequencies of either in the common band.
pub fn compare(a: &Frf, b: &Frf, options: &CompareOptions) -> Result<Comparison, EstimateError> {
    a.check()?;
    b.check()?;
    if (a.n_outputs(), a.n_inputs()) != (b.n_outputs(), b.n_inputs()) {
        let needed = format!("(frequency, {}, {}), as a", a.n_outputs(), a.n_inputs());
        return Err(SignalError::Shape {
            name: "b",
            found: b.response.shape().to_vec(),
            needed,
        }
        .into());
    }
    let band_hz = common_band(a, b)?;
    let places =
        (0..a.n_outputs()).flat_map(|output| (0..a.n_inputs()).map(move |input| (output, input)));
    let entries = places
        .map(|(output, input)| compare_entry(a, b, output, input, band_hz, options))
        .collect();
    Ok(Comparison { band_hz, entries })
}

/// The band in which both have frequencies, at least three each.
fn common_band(a: &Frf, b: &Frf) -> Result<(f64, f64), EstimateError> {
    let ends = |frf: &Frf| {
        (
            frf.frequency_hz.first().copied().unwrap_or(f64::NAN),
            frf.frequency_hz.last().copied().unwrap_or(f64::NAN),
        )
    };
    let ((a_low, a_high), (b_low, b_high)) = (ends(a), ends(b));
    let (low, high) = (a_low.max(b_low), a_high.min(b_high));
    let within = |frf: &Frf| {
        frf.frequency_hz
            .iter()
            .filter(|&&hz| (low..=high).contains(&hz))
            .count()
    };
    let found = within(a).min(within(b));
    if found < 3 {
        return Err(EstimateError::NoCommonBand {
            a_hz: (a_low, a_high),
            b_hz: (b_low, b_high),
            found,
        });
    }
    Ok((low, high))
}

fn compare_entry(
    a: &Frf,
    b: &Frf,
    output: usize,
    input: usize,
    band_hz: (f64, f64),
    options: &CompareOptions,
) -> EntryComparison {
    let (a, b) = (Bode::of(a, output, input), Bode::of(b, output, input));
    let inside = |feature: &Feature| (band_hz.0..=band_hz.1).contains(&feature.frequency_hz);
    let features = |curve: &Bode| {
        features_of(curve, options.prominence_db)
            .into_iter()
            .filter(inside)
            .collect::<Vec<_>>()
    };
    let (changes, only_in_b) = pair(&features(&a), features(&b), &b, options.largest_shift);
    // compared on A's own frequencies
    let shared: Vec<usize> = (0..a.frequency_hz.len())
        .filter(|&k| (band_hz.0..=band_hz.1).contains(&a.frequency_hz[k]))
        .collect();
    let levels: Vec<f64> = shared
        .iter()
        .filter_map(|&k| Some(b.magnitude_db_at(a.frequency_hz[k])? - a.magnitude_db[k]))
        .collect();
    let a_phase = shared.iter().map(|&k| a.phase_deg[k]);
    let b_phase = shared
        .iter()
        .filter_map(|&k| b.phase_deg_at(a.frequency_hz[k]));
    let phase_range_deg = Sides {
        a: range(a_phase),
        b: range(b_phase),
    };
    EntryComparison {
        output,
        input,
        verdicts: verdicts(&changes, phase_range_deg, options.stronger),
        changes,
        only_in_b,
        level_db: median(levels.clone()).unwrap_or(0.0),
        difference_db: median(levels.iter().map(|level| level.abs()).collect()).unwrap_or(0.0),
        phase_range_deg,
    }
}

/// Pairs features of the same kind, the nearest in log frequency first; returns what became of A's,
/// and what only B has.
fn pair(
    a: &[Feature],
    mut b: Vec<Feature>,
    curve_b: &Bode,
    largest_shift: f64,
) -> (Vec<Change>, Vec<Feature>) {
    let distance = |a: &Feature, b: &Feature| (b.frequency_hz / a.frequency_hz).ln().abs();
    let mut partners: Vec<Option<Feature>> = vec![None; a.len()];
    loop {
        let free = (0..a.len()).filter(|&i| partners[i].is_none());
        let candidates = free
            .flat_map(|i| (0..b.len()).map(move |j| (i, j)))
            .filter(|&(i, j)| a[i].kind == b[j].kind);
        let near = candidates
            .map(|(i, j)| (i, j, distance(&a[i], &b[j])))
            .filter(|pair| pair.2 <= largest_shift.ln());
        let Some((i, j, _)) = near.min_by(|x, y| x.2.total_cmp(&y.2)) else {
            break;
        };
        partners[i] = Some(b.remove(j));
    }
    let change = |(a, b): (&Feature, Option<Feature>)| {
        let level = b
            .map(|b| b.magnitude_db)
            .or_else(|| curve_b.magnitude_db_at(a.frequency_hz));
        Change {
            a: *a,
            b,
            level_db: level.map(|level| level - a.magnitude_db),
        }
    };
    (a.iter().zip(partners).map(change).collect(), b)
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    (high - low).max(0.0)
}
