//! Change of a resonance or antiresonance from one FRF to the other.

use schemars::JsonSchema;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use crate::compare::feature::resonance::{Feature, FeatureKind};

/// Standard deviations that a shift must exceed: by chance one in a hundred does.
const SIGMAS: f64 = 2.6;
/// Least shift that counts, relative.
const LEAST_SHIFT: f64 = 0.01;
/// Shift of a peak by a chirp alone, over the resolution that its excerpts state: a mode that is hardly
/// damped peaks late by 0.86 of it (F. M. Lewis, Trans. ASME 54, 1932).
const BLUR_SHIFT: f64 = 0.9;

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
    /// Standard deviation of that level in dB; `None` unless it is known of both.
    pub level_std_db: Option<f64>,
}

/// Natural logarithm of a ratio, with what is uncertain of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LogRatio {
    pub(crate) value: f64,
    /// Standard deviation by the noise, 0 where none is known.
    pub(crate) std: f64,
    /// What the lines or the blur leave uncertain besides.
    pub(crate) bound: f64,
}

impl LogRatio {
    /// What a shift must exceed to be one.
    pub(crate) fn uncertain(&self) -> f64 {
        SIGMAS * self.std + self.bound
    }
}

/// By its numbers, those that follow included.
impl Serialize for Change {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_struct("Change", 9)?;
        map.serialize_field("a", &self.a)?;
        map.serialize_field("b", &self.b)?;
        map.serialize_field("shift_hz", &self.shift_hz())?;
        map.serialize_field("shift_percent", &self.shift_percent())?;
        map.serialize_field("shift_std_percent", &self.shift_std_percent())?;
        map.serialize_field("damping_ratio", &self.damping_ratio())?;
        map.serialize_field("level_db", &self.level_db)?;
        map.serialize_field("level_std_db", &self.level_std_db)?;
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

    /// Standard deviation of that shift in percent of A's frequency; `None` unless it is known of
    /// both frequencies.
    #[must_use]
    pub fn shift_std_percent(&self) -> Option<f64> {
        let b = self.b?;
        let (a_std, b_std) = (self.a.frequency_std_hz?, b.frequency_std_hz?);
        let ratio = b.frequency_hz / self.a.frequency_hz;
        Some(100.0 * (a_std * ratio).hypot(b_std) / self.a.frequency_hz)
    }

    /// Ratio of the dampings, B over A.
    #[must_use]
    pub fn damping_ratio(&self) -> Option<f64> {
        Some(self.b?.damping? / self.a.damping?)
    }

    /// Whether the shift exceeds 2.6 of its standard deviations, what the frequency grids (where
    /// no standard deviation is known) and the blur of chirps leave uncertain, and 1 %.
    #[must_use]
    pub fn has_moved(&self) -> bool {
        let moved = |shift: LogRatio| shift.value.abs() > shift.uncertain().max(LEAST_SHIFT);
        self.log_ratio().is_some_and(moved)
    }

    /// Whether it moved by more than half its half-power width in either; one of unknown width, a flat
    /// top, did not.
    pub(crate) fn has_moved_beyond_width(&self) -> bool {
        let dampings = self.a.damping.zip(self.b.and_then(|b| b.damping));
        let is_beyond =
            |shift: LogRatio| dampings.is_some_and(|(a, b)| shift.value.abs() > a.max(b));
        self.has_moved() && self.log_ratio().is_some_and(is_beyond)
    }

    /// Logarithm of the frequency in B over that in A.
    pub(crate) fn log_ratio(&self) -> Option<LogRatio> {
        let b = self.b?;
        let relative_std =
            |feature: &Feature| feature.frequency_std_hz.unwrap_or(0.0) / feature.frequency_hz;
        Some(LogRatio {
            value: (b.frequency_hz / self.a.frequency_hz).ln(),
            std: relative_std(&self.a).hypot(relative_std(&b)),
            bound: bound(&self.a) + bound(&b),
        })
    }
}

/// Relative uncertainty of a frequency that is no noise.
fn bound(feature: &Feature) -> f64 {
    let blur_hz = BLUR_SHIFT * feature.blur_hz;
    let grid_hz = match feature.frequency_std_hz {
        Some(_) => 0.0,
        None if feature.blur_hz > 0.0 => 0.0,
        None => feature.resolution_hz,
    };
    (grid_hz + blur_hz) / feature.frequency_hz
}
