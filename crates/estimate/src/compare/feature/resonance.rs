//! Resonances and antiresonances of one FRF entry: where they lie, how far they stand out, how
//! damped they are, each with its standard deviation where the covariance of the FRF is known.

use frfid_signals::Frf;
use serde::Serialize;

use crate::compare::curve::{Curve, DB_PER_NEPER};
use crate::compare::feature::parabola::{half_power_bandwidth, parabola_top};
use crate::compare::feature::prominence::saddles;
use crate::compare::feature::windows::{Local, LocalFit, local_fit};
use crate::compare::measured::Measured;

/// Probability with which all lines of a curve lie within their regions at once: an extremum whose
/// region lies above those of its saddles is then no wiggle of the noise.
const NO_WIGGLE: f64 = 0.95;

/// Standard deviations within which two extrema are one.
const SIGMAS_OF_ONE: f64 = 2.0;
/// Radius of the 95 % region of a level in standard deviations of it: those of two numbers of which
/// the level is one, sqrt(-2 ln 0.05).
const REGION_SIGMAS: f64 = 2.45;

/// Peak or notch of the magnitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FeatureKind {
    /// A local maximum of the magnitude.
    Resonance,
    /// A local minimum of the magnitude.
    Antiresonance,
}

impl FeatureKind {
    /// The word for it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Resonance => "resonance",
            Self::Antiresonance => "antiresonance",
        }
    }
}

/// A resonance or antiresonance.
///
/// Where the lines' covariance is known, frequency, magnitude and damping are those of a local
/// rational fit (one pole, two zeros) to the lines around, weighted with their variances, and the
/// standard deviations those that the variances leave them, linearised; a misfit beyond the noise
/// enlarges them. Elsewhere they come from a parabola through three lines, and the standard
/// deviations are `None`: nothing was measured that would tell them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Feature {
    /// Peak or notch.
    pub kind: FeatureKind,
    /// Frequency in Hz at which the magnitude is extreme.
    pub frequency_hz: f64,
    /// Its standard deviation in Hz.
    pub frequency_std_hz: Option<f64>,
    /// Half the distance in Hz between the lines around it, or between those that may be the extreme
    /// one by their noise where no fit tells them apart, or what the estimate blurs if that is more.
    pub resolution_hz: f64,
    /// How far the estimate blurs there, in Hz; 0 for lines of a period, which do not.
    pub blur_hz: f64,
    /// Magnitude in dB.
    pub magnitude_db: f64,
    /// Its standard deviation in dB.
    pub magnitude_std_db: Option<f64>,
    /// Height in dB above the higher of the two saddles that part it from higher peaks or the ends
    /// (depth for a notch), as measured.
    pub prominence_db: f64,
    /// Damping ratio, half-power (3 dB) bandwidth over twice the frequency; `None` where a side
    /// does not fall by 3 dB.
    pub damping: Option<f64>,
    /// Its standard deviation.
    pub damping_std: Option<f64>,
}

/// Resonances and antiresonances of entry `(output, input)` that stand out by at least
/// `prominence_db`, frequencies rising; where a covariance is known, only those that stand out of
/// the noise as well.
///
/// ```
/// use frfid_estimate::{FeatureKind, find_features};
/// use frfid_signals::Frf;
/// use ndarray::Array3;
/// use num_complex::Complex64;
///
/// let hz: Vec<f64> = (20..=300).map(|k| 0.1 * f64::from(k)).collect();
/// let response = Array3::from_shape_fn((hz.len(), 1, 1), |(k, ..)| {
///     let ratio = hz[k] / 10.0; // a resonator at 10 Hz, damping 5 %
///     1.0 / Complex64::new(1.0 - ratio * ratio, 0.1 * ratio)
/// });
/// let found = find_features(&Frf::new(hz, response)?, 0, 0, 3.0);
/// assert_eq!((found.len(), found[0].kind), (1, FeatureKind::Resonance));
/// assert!((found[0].frequency_hz - 9.975).abs() < 0.01);
/// assert_eq!(found[0].frequency_std_hz, None); // no covariance, no standard deviation
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn find_features(frf: &Frf, output: usize, input: usize, prominence_db: f64) -> Vec<Feature> {
    features_of(&Curve::of(&Measured::of(frf), output, input), prominence_db)
}

/// As [`find_features`], on a curve.
pub(crate) fn features_of(curve: &Curve, prominence_db: f64) -> Vec<Feature> {
    let upright = Regions::of(curve);
    let mut features = peaks(curve, &upright, FeatureKind::Resonance, prominence_db);
    let upside_down = upright.upside_down();
    features.extend(peaks(
        curve,
        &upside_down,
        FeatureKind::Antiresonance,
        prominence_db,
    ));
    features.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    features.dedup_by(|next, before| is_the_same(before, next));
    features
}

/// Whether two neighbours are one extremum that two of its lines lead to.
fn is_the_same(before: &Feature, next: &Feature) -> bool {
    let stds = before.frequency_std_hz.zip(next.frequency_std_hz);
    let apart_hz = next.frequency_hz - before.frequency_hz;
    let is_within = |(a, b): (f64, f64)| apart_hz <= SIGMAS_OF_ONE * a.hypot(b);
    before.kind == next.kind && stds.is_some_and(is_within)
}

/// Levels in dB with the ends of their regions.
struct Regions {
    low: Vec<f64>,
    level: Vec<f64>,
    high: Vec<f64>,
}

impl Regions {
    fn of(curve: &Curve) -> Self {
        let radius = |k: usize| {
            let scatter = curve.scatter.as_ref();
            let radius = scatter.map_or(0.0, |scatter| scatter.radius(k, NO_WIGGLE));
            radius / curve.response[k].norm()
        };
        let ends = |sign: f64| {
            let moved = |(k, level): (usize, &f64)| {
                level + DB_PER_NEPER * (1.0 + sign * radius(k)).max(0.0).ln()
            };
            curve.magnitude_db.iter().enumerate().map(moved).collect()
        };
        Self {
            low: ends(-1.0),
            level: curve.magnitude_db.clone(),
            high: ends(1.0),
        }
    }

    /// Whether a local maximum stands out of its saddles with all regions `times` as wide.
    fn stand_out(&self, top: usize, times: f64) -> bool {
        let low = self.level[top] - times * (self.level[top] - self.low[top]);
        let high = |k: usize| self.level[k] + times * (self.high[k] - self.level[k]);
        let is_below = |k: &usize| self.level[*k] <= self.level[top];
        let left = (0..top).rev().take_while(is_below).map(high);
        let right = (top + 1..self.level.len()).take_while(is_below).map(high);
        let least = |ends: &mut dyn Iterator<Item = f64>| ends.fold(f64::INFINITY, f64::min);
        let (mut left, mut right) = (left, right);
        low > least(&mut left).max(least(&mut right))
    }

    fn upside_down(self) -> Self {
        let turned = |values: Vec<f64>| values.into_iter().map(|value| -value).collect();
        Self {
            low: turned(self.high),
            level: turned(self.level),
            high: turned(self.low),
        }
    }
}

/// Local maxima that stand out by at least `least`, and of the noise.
fn peaks(curve: &Curve, regions: &Regions, kind: FeatureKind, least: f64) -> Vec<Feature> {
    let level = &regions.level;
    let beside = saddles(level, level);
    let highest_beside = saddles(level, &regions.high);
    let inner = 1..level.len().saturating_sub(1);
    inner
        .filter(|&k| level[k - 1] < level[k] && level[k] >= level[k + 1])
        .filter(|&k| level[k] - beside[k] >= least && regions.low[k] > highest_beside[k])
        .filter_map(|k| feature(curve, regions, k, kind, level[k] - beside[k]))
        .collect()
}

/// The feature whose highest line is `top`; `None` where it stands out of the noise, but not of what
/// its own lines scatter besides.
fn feature(
    curve: &Curve,
    regions: &Regions,
    top: usize,
    kind: FeatureKind,
    prominence_db: f64,
) -> Option<Feature> {
    let LocalFit { extremum, excess } = local_fit(curve, top, kind);
    let feature = match &extremum {
        Some(local) => fitted(local, curve, top, kind),
        None => read_off(curve, regions, top, kind),
    };
    let region_db = feature
        .magnitude_std_db
        .map_or(0.0, |std_db| REGION_SIGMAS * std_db);
    let blur_hz = curve.blur_at_hz(feature.frequency_hz);
    let stands_out = prominence_db > region_db && regions.stand_out(top, excess.sqrt());
    stands_out.then_some(Feature {
        prominence_db,
        blur_hz,
        resolution_hz: feature.resolution_hz.max(blur_hz),
        ..feature
    })
}

/// By a local fit.
fn fitted(local: &Local, curve: &Curve, top: usize, kind: FeatureKind) -> Feature {
    Feature {
        kind,
        frequency_hz: local.frequency_hz,
        frequency_std_hz: Some(local.frequency_std_hz),
        resolution_hz: half_spacing_hz(curve, top),
        blur_hz: 0.0,
        magnitude_db: DB_PER_NEPER * local.level,
        magnitude_std_db: Some(DB_PER_NEPER * local.level_std),
        prominence_db: 0.0,
        damping: local.damping,
        damping_std: local.damping_std,
    }
}

/// By a parabola, without errors.
fn read_off(curve: &Curve, regions: &Regions, top: usize, kind: FeatureKind) -> Feature {
    let (hz, level) = (&curve.frequency_hz, &regions.level);
    let (frequency_hz, height) = parabola_top(hz, level, top);
    let width_hz = half_power_bandwidth(hz, level, top, height);
    Feature {
        kind,
        frequency_hz,
        frequency_std_hz: None,
        resolution_hz: as_high_hz(curve, regions, top).max(half_spacing_hz(curve, top)),
        blur_hz: 0.0,
        magnitude_db: if kind == FeatureKind::Resonance {
            height
        } else {
            -height
        },
        magnitude_std_db: None,
        prominence_db: 0.0,
        damping: width_hz.map(|width_hz| 0.5 * width_hz / frequency_hz),
        damping_std: None,
    }
}

/// Half the mean distance to the lines beside `top`.
fn half_spacing_hz(curve: &Curve, top: usize) -> f64 {
    0.25 * (curve.frequency_hz[top + 1] - curve.frequency_hz[top - 1])
}

/// Half the distance of the outermost lines around `top` that may be as high by their regions.
fn as_high_hz(curve: &Curve, regions: &Regions, top: usize) -> f64 {
    let hz = &curve.frequency_hz;
    let may_be_top = |k: &usize| regions.high[*k] >= regions.low[top];
    let left = (0..top).rev().take_while(may_be_top).last();
    let right = (top + 1..hz.len()).take_while(may_be_top).last();
    0.5 * (hz[right.unwrap_or(top)] - hz[left.unwrap_or(top)])
}
