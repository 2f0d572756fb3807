//! Change of a resonance or antiresonance from one FRF to the other.

use schemars::JsonSchema;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use crate::compare::resonance::{Feature, FeatureKind};

/// One of the two FRFs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The first.
    A,
    /// The second.
    B,
}

/// The same quantity of both FRFs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sides<T> {
    /// Of the first.
    pub a: T,
    /// Of the second.
    pub b: T,
}

/// A resonance or antiresonance of A and what became of it in B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// The feature in A.
    pub a: Feature,
    /// The same feature in B; `None` if B has none near it.
    pub b: Option<Feature>,
    /// Level of B over A in dB: feature against feature, or at A's frequency where B has none;
    /// `None` outside of B's band.
    pub level_db: Option<f64>,
}

/// By its numbers, those that follow included.
impl Serialize for Change {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_struct("Change", 7)?;
        map.serialize_field("a", &self.a)?;
        map.serialize_field("b", &self.b)?;
        map.serialize_field("shift_hz", &self.shift_hz())?;
        map.serialize_field("shift_percent", &self.shift_percent())?;
        map.serialize_field("damping_ratio", &self.damping_ratio())?;
        map.serialize_field("level_db", &self.level_db)?;
        map.serialize_field("has_moved", &self.has_moved())?;
        map.end()
    }
}

impl Change {
    /// Whether it is a resonance.
    #[must_use]
    pub fn is_resonance(&self) -> bool {
        self.a.kind == FeatureKind::Resonance
    }

    /// How far the frequency moved from A to B in Hz.
    #[must_use]
    pub fn shift_hz(&self) -> Option<f64> {
        self.b.map(|b| b.frequency_hz - self.a.frequency_hz)
    }

    /// How far the frequency moved from A to B in percent of A's.
    #[must_use]
    pub fn shift_percent(&self) -> Option<f64> {
        self.shift_hz()
            .map(|shift| 100.0 * shift / self.a.frequency_hz)
    }

    /// Ratio of the dampings, B over A.
    #[must_use]
    pub fn damping_ratio(&self) -> Option<f64> {
        Some(self.b?.damping? / self.a.damping?)
    }

    /// Whether the shift exceeds what the two frequency grids leave uncertain, and 1 %.
    #[must_use]
    pub fn has_moved(&self) -> bool {
        self.b.zip(self.shift_hz()).is_some_and(|(b, shift_hz)| {
            let uncertain_hz = self.a.resolution_hz + b.resolution_hz;
            shift_hz.abs() > uncertain_hz.max(0.01 * self.a.frequency_hz)
        })
    }
}
