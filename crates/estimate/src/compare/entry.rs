//! Comparison of one entry of two FRFs: its features and what became of them, and what differs over
//! the whole band.

use frfid_signals::median;
use serde::Serialize;

use crate::compare::agreement::Agreement;
use crate::compare::change::{Change, Sides};
use crate::compare::curve::Curve;
use crate::compare::feature::resonance::{Feature, FeatureKind, features_of};
use crate::compare::measured::Measured;
use crate::compare::pairing::pair;
use crate::compare::verdict::damping::{DampingMarks, damping_marks, most_prominent};
use crate::compare::verdict::mass_lines::MassLines;
use crate::compare::{CompareOptions, is_within};

/// Prominence at which features are looked for, over that at which they are told: what stands out
/// of one curve is to find its own on the other.
const LESSER: f64 = 0.3;

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
    /// Whether this entry agrees within its noise.
    pub agreement: Agreement,
    /// Median level of B over A in dB; NaN where they have no line in common.
    pub level_db: f64,
    /// Median size of the difference of levels in dB; NaN as well.
    pub difference_db: f64,
    /// Range of the phase (largest minus smallest, unwrapped) of A and of B in degrees; NaN where
    /// nothing is known of it.
    pub phase_range_deg: Sides<f64>,
    /// Levels beside all resonances, which follow the inertias.
    pub mass_lines: MassLines,
    /// Marks of more damping in one of the two.
    #[serde(skip)]
    pub(crate) damping: Option<DampingMarks>,
}

/// Compares one entry; `agreement` is that of its lines.
pub(crate) fn compare_entry(
    (a, b): (&Measured, &Measured),
    (output, input): (usize, usize),
    agreement: Agreement,
    band_hz: (f64, f64),
    options: &CompareOptions,
) -> EntryComparison {
    let (a, b) = (Curve::of(a, output, input), Curve::of(b, output, input));
    let (changes, only_in_b) = paired(&a, &b, band_hz, options);
    let levels = levels_db(&a, &b, band_hz);
    let phase_range_deg = phase_ranges_deg(&a, &b, band_hz);
    EntryComparison {
        output,
        input,
        agreement,
        mass_lines: MassLines::of((&a, &b), band_hz, &changes, &only_in_b),
        damping: damping_marks(&changes, phase_range_deg, (&a, &b))
            .filter(|_| !may_have_moved(&changes, &only_in_b)),
        changes,
        only_in_b,
        difference_db: median(levels.iter().map(|level| level.abs()).collect()).unwrap_or(f64::NAN),
        level_db: median(levels).unwrap_or(f64::NAN),
        phase_range_deg,
    }
}

/// Whether the most prominent resonance of A is not buried but elsewhere: B has one that A has not.
fn may_have_moved(changes: &[Change], only_in_b: &[Feature]) -> bool {
    let resonances = changes.iter().filter(|change| change.is_resonance());
    let is_missing = most_prominent(resonances).is_some_and(|change| change.b.is_none());
    let is_resonance = |feature: &Feature| feature.kind == FeatureKind::Resonance;
    is_missing && only_in_b.iter().any(is_resonance)
}

/// The features within the band and what became of them: those that stand out on either curve, each
/// beside its own on the other though that may hardly stand out there.
fn paired(
    a: &Curve,
    b: &Curve,
    band_hz: (f64, f64),
    options: &CompareOptions,
) -> (Vec<Change>, Vec<Feature>) {
    let features = |curve: &Curve| {
        let mut features = features_of(curve, LESSER * options.prominence_db);
        features.retain(|feature| is_within(band_hz, feature.frequency_hz));
        features
    };
    let stands_out = |feature: &Feature| feature.prominence_db >= options.prominence_db;
    let (mut changes, mut only_in_b) = pair(&features(a), &features(b), b, options.largest_shift);
    changes.retain(|change| stands_out(&change.a) || change.b.as_ref().is_some_and(stands_out));
    only_in_b.retain(stands_out);
    (changes, only_in_b)
}

/// Places of A's own frequencies in a band, on which both are compared.
fn places_in(a: &Curve, band_hz: (f64, f64)) -> impl Iterator<Item = usize> + Clone {
    (0..a.frequency_hz.len()).filter(move |&k| is_within(band_hz, a.frequency_hz[k]))
}

/// Levels of B over A in dB.
fn levels_db(a: &Curve, b: &Curve, band_hz: (f64, f64)) -> Vec<f64> {
    places_in(a, band_hz)
        .filter_map(|k| Some(b.magnitude_db_at(a.frequency_hz[k])? - a.magnitude_db[k]))
        .collect()
}

/// Ranges of the phase in degrees.
fn phase_ranges_deg(a: &Curve, b: &Curve, band_hz: (f64, f64)) -> Sides<f64> {
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
