//! `frfid.compare`.

use frfid_estimate::{
    Change, CompareOptions, Comparison as Compared, EntryComparison, Feature, FeatureKind, Side,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;
use crate::frf::Frf;

/// Two FRFs side by side; made by ``frfid.compare``. Printed, it is its verdicts.
#[pyclass(frozen, module = "frfid")]
pub struct Comparison {
    compared: Compared,
}

#[pymethods]
impl Comparison {
    /// What the difference says about the machine, in sentences; empty if nothing stands out.
    #[getter]
    fn verdicts(&self) -> Vec<String> {
        self.compared
            .entries
            .iter()
            .flat_map(|entry| entry.verdicts.iter().map(ToString::to_string))
            .collect()
    }

    /// Band in Hz that both cover.
    #[getter]
    fn band_hz(&self) -> (f64, f64) {
        self.compared.band_hz
    }

    /// Every entry of the matrix, outputs first, as a dict: ``changes`` holds each resonance and
    /// antiresonance of ``a``, what became of it in ``b``, and its shift.
    #[getter]
    fn entries(&self) -> Vec<Entry> {
        self.compared.entries.iter().map(Entry::from).collect()
    }

    fn __str__(&self) -> String {
        let verdicts = self.verdicts();
        if verdicts.is_empty() {
            "nothing stands out".to_owned()
        } else {
            verdicts.join("\n")
        }
    }

    fn __repr__(&self) -> String {
        let (low, high) = self.compared.band_hz;
        format!(
            "<frfid.Comparison from {low:.4} Hz to {high:.4} Hz: {}>",
            self.__str__()
        )
    }
}

/// Compares two FRFs: shift of resonances and antiresonances, damping, and what it says about
/// stiffness and friction.
///
/// Parameters ---------- a, b : Frf Of the same machine; the frequencies may differ. stronger :
/// {"a", "b"}, optional Which of them was measured with the stronger excitation; without it a shift
/// does not tell growing from falling stiffness. prominence_db : float, optional Least height of a
/// resonance, or depth of an antiresonance, in dB. largest_shift : float, optional Largest ratio of
/// frequencies at which two resonances can be the same one.
///
/// Returns
/// -------
/// Comparison
///
/// Raises
/// ------
/// ValueError
///     For other numbers of channels, or fewer than three frequencies of either in the common band.
#[pyfunction]
#[pyo3(signature = (a, b, *, stronger = None, prominence_db = 3.0, largest_shift = 1.5))]
pub fn compare(
    py: Python<'_>,
    a: &Frf,
    b: &Frf,
    stronger: Option<&str>,
    prominence_db: f64,
    largest_shift: f64,
) -> PyResult<Comparison> {
    let stronger = match stronger {
        None => None,
        Some("a") => Some(Side::A),
        Some("b") => Some(Side::B),
        Some(name) => {
            return Err(PyValueError::new_err(format!(
                "stronger: unknown variant `{name}`, expected one of `a`, `b`"
            )));
        }
    };
    let options = CompareOptions {
        stronger,
        prominence_db,
        largest_shift,
    };
    let (a, b) = (&a.result.frf, &b.result.frf);
    let compared = py
        .detach(|| frfid_estimate::compare(a, b, &options))
        .map_err(error::estimate)?;
    Ok(Comparison { compared })
}

/// One entry of the two matrices, as a dict.
#[derive(IntoPyObject)]
struct Entry {
    output: usize,
    input: usize,
    changes: Vec<EntryChange>,
    only_in_b: Vec<EntryFeature>,
    level_db: f64,
    difference_db: f64,
    phase_range_deg: (f64, f64),
    verdicts: Vec<String>,
}

/// A resonance or antiresonance of A and what became of it, as a dict.
#[derive(IntoPyObject)]
struct EntryChange {
    a: EntryFeature,
    b: Option<EntryFeature>,
    shift_hz: Option<f64>,
    shift_percent: Option<f64>,
    damping_ratio: Option<f64>,
    level_db: Option<f64>,
    has_moved: bool,
}

/// A resonance or antiresonance, as a dict.
#[derive(IntoPyObject)]
struct EntryFeature {
    kind: &'static str,
    frequency_hz: f64,
    resolution_hz: f64,
    magnitude_db: f64,
    prominence_db: f64,
    damping: Option<f64>,
}

impl From<&EntryComparison> for Entry {
    fn from(entry: &EntryComparison) -> Self {
        Self {
            output: entry.output,
            input: entry.input,
            changes: entry.changes.iter().map(EntryChange::from).collect(),
            only_in_b: entry.only_in_b.iter().map(EntryFeature::from).collect(),
            level_db: entry.level_db,
            difference_db: entry.difference_db,
            phase_range_deg: entry.phase_range_deg,
            verdicts: entry.verdicts.iter().map(ToString::to_string).collect(),
        }
    }
}

impl From<&Change> for EntryChange {
    fn from(change: &Change) -> Self {
        Self {
            a: (&change.a).into(),
            b: change.b.as_ref().map(EntryFeature::from),
            shift_hz: change.shift_hz(),
            shift_percent: change.shift_percent(),
            damping_ratio: change.damping_ratio(),
            level_db: change.level_db,
            has_moved: change.has_moved(),
        }
    }
}

impl From<&Feature> for EntryFeature {
    fn from(feature: &Feature) -> Self {
        Self {
            kind: if feature.kind == FeatureKind::Resonance {
                "resonance"
            } else {
                "antiresonance"
            },
            frequency_hz: feature.frequency_hz,
            resolution_hz: feature.resolution_hz,
            magnitude_db: feature.magnitude_db,
            prominence_db: feature.prominence_db,
            damping: feature.damping,
        }
    }
}
