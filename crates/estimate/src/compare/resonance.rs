//! Resonances and antiresonances of one FRF entry: where they lie, how far they stand out, how
//! damped they are.

use frfid_signals::Frf;
use serde::Serialize;

use crate::compare::bode::Bode;

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
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Feature {
    /// Peak or notch.
    pub kind: FeatureKind,
    /// Frequency in Hz, by a parabola through three points of the magnitude in dB over log
    /// frequency.
    pub frequency_hz: f64,
    /// Half the distance between the points around it in Hz, or what the estimate blurs if that is
    /// more: what is uncertain.
    pub resolution_hz: f64,
    /// Magnitude of that parabola in dB.
    pub magnitude_db: f64,
    /// Height in dB above the higher of the two saddles that part it from higher peaks or the ends
    /// (depth for a notch).
    pub prominence_db: f64,
    /// Damping ratio, half-power (3 dB) bandwidth over twice the frequency; `None` where a side
    /// does not fall by 3 dB.
    pub damping: Option<f64>,
}

/// Resonances and antiresonances of entry `(output, input)` that stand out by at least
/// `prominence_db`, frequencies rising.
#[must_use]
pub fn find_features(frf: &Frf, output: usize, input: usize, prominence_db: f64) -> Vec<Feature> {
    features_of(&Bode::of(frf, output, input), prominence_db)
}

/// As [`find_features`], on a curve.
pub(crate) fn features_of(curve: &Bode, prominence_db: f64) -> Vec<Feature> {
    let upside_down: Vec<f64> = curve.magnitude_db.iter().map(|value| -value).collect();
    let found = |level: &[f64], kind| peaks(&curve.frequency_hz, level, kind, prominence_db);
    let mut features = found(&curve.magnitude_db, FeatureKind::Resonance);
    let notches = found(&upside_down, FeatureKind::Antiresonance).into_iter();
    features.extend(notches.map(|notch| Feature {
        magnitude_db: -notch.magnitude_db,
        ..notch
    }));
    for feature in &mut features {
        let blurred_hz = curve.relative_resolution * feature.frequency_hz;
        feature.resolution_hz = feature.resolution_hz.max(blurred_hz);
    }
    features.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    features
}

/// Local maxima of `level` (dB) that stand out by at least `least`.
fn peaks(hz: &[f64], level: &[f64], kind: FeatureKind, least: f64) -> Vec<Feature> {
    let inner = 1..level.len().saturating_sub(1);
    let tops = inner.filter(|&k| level[k - 1] < level[k] && level[k] >= level[k + 1]);
    tops.filter_map(|top| {
        let prominence_db = prominence(level, top);
        let (frequency_hz, magnitude_db) = parabola_top(hz, level, top);
        (prominence_db >= least).then(|| Feature {
            kind,
            frequency_hz,
            resolution_hz: 0.25 * (hz[top + 1] - hz[top - 1]),
            magnitude_db,
            prominence_db,
            damping: half_power_bandwidth(hz, level, top, magnitude_db)
                .map(|width| 0.5 * width / frequency_hz),
        })
    })
    .collect()
}

/// Height above the higher of the two lowest points on the way to something higher, or to the ends.
fn prominence(level: &[f64], top: usize) -> f64 {
    let height = level[top];
    let left = saddle(level[..top].iter().rev(), height);
    let right = saddle(level[top + 1..].iter(), height);
    // a side without any lower point cannot be: the neighbours are not higher
    height - left.max(right).min(height)
}

/// The lowest level on the way to something higher, or to the end.
fn saddle<'a>(way: impl Iterator<Item = &'a f64>, height: f64) -> f64 {
    way.take_while(|&&level| level <= height)
        .copied()
        .fold(f64::INFINITY, f64::min)
}

/// Top of the parabola through a point and its neighbours, over log frequency: frequency in Hz,
/// level in dB.
fn parabola_top(hz: &[f64], level: &[f64], top: usize) -> (f64, f64) {
    let (left, right) = ((hz[top - 1] / hz[top]).ln(), (hz[top + 1] / hz[top]).ln());
    let (below, above) = (
        (level[top - 1] - level[top]) / left,
        (level[top + 1] - level[top]) / right,
    );
    let curvature = (above - below) / (right - left);
    let slope = below - curvature * left;
    if curvature >= 0.0 {
        return (hz[top], level[top]);
    }
    let shift = (-0.5 * slope / curvature).clamp(left, right);
    (
        hz[top] * shift.exp(),
        level[top] + shift * (slope + curvature * shift),
    )
}

/// Distance in Hz of the two places where the level has fallen to half the power of `magnitude_db`.
fn half_power_bandwidth(hz: &[f64], level: &[f64], top: usize, magnitude_db: f64) -> Option<f64> {
    let half = magnitude_db - 10.0 * 2f64.log10();
    let crossing = |inside: usize, outside: usize| {
        let share = (half - level[inside]) / (level[outside] - level[inside]);
        (level[inside] >= half && level[outside] < half)
            .then(|| hz[inside] + share * (hz[outside] - hz[inside]))
    };
    let rises = |from: usize, to: usize| level[to] > level[from] && level[from] < half + 3.0;
    let low = (0..top)
        .rev()
        .take_while(|&k| !rises(k + 1, k))
        .find_map(|k| crossing(k + 1, k))?;
    let high = (top + 1..level.len())
        .take_while(|&k| !rises(k - 1, k))
        .find_map(|k| crossing(k - 1, k))?;
    Some(high - low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array3;
    use num_complex::Complex64;
    use std::f64::consts::TAU;

    /// The paper's joint, METHOD table: notch 5.0289 Hz, -95.0507 dB; peak 11.6211 Hz, -55.6669 dB.
    fn joint(points: usize) -> Frf {
        let (motor, arm, damping, stiffness) = (35.0, 150.0, 400.0, 1.5e5);
        let hz: Vec<f64> = (0..points)
            .map(|k| 60f64.powf(k as f64 / (points - 1) as f64))
            .collect();
        let at = |hz: f64| {
            let s = Complex64::new(0.0, TAU * hz);
            (s * s * arm + s * damping + stiffness)
                / (s * (s * s * motor * arm + (s * damping + stiffness) * (motor + arm)))
        };
        let response = Array3::from_shape_fn((points, 1, 1), |(k, _, _)| at(hz[k]));
        Frf::new(hz, response).expect("shapes agree")
    }

    #[test]
    fn notch_and_peak_of_the_joint_are_the_tabled_ones() {
        for (points, slack_hz, slack_db) in [(2000, 1e-3, 1e-3), (150, 0.03, 0.2)] {
            let found = find_features(&joint(points), 0, 0, 3.0);
            assert_eq!(found.len(), 2, "{found:?}");
            for (feature, kind, hz, db) in [
                (found[0], FeatureKind::Antiresonance, 5.0289, -95.0507),
                (found[1], FeatureKind::Resonance, 11.6211, -55.6669),
            ] {
                assert_eq!(feature.kind, kind);
                assert!(
                    (feature.frequency_hz - hz).abs() < slack_hz
                        && (feature.magnitude_db - db).abs() < slack_db,
                    "{feature:?}"
                );
            }
        }
    }

    /// zeta = d/2 sqrt(1/(k J)) with J the arm for the notch and both in series for the peak:
    /// 0.0422 and 0.0974 - the half-power rule is exact only for small damping.
    #[test]
    fn damping_follows_from_the_half_power_bandwidth() {
        let found = find_features(&joint(2000), 0, 0, 3.0);
        let zeta = |inertia: f64| 0.5 * 400.0 / (1.5e5 * inertia).sqrt();
        let series: f64 = 35.0 * 150.0 / 185.0;
        for (feature, expected) in [(found[0], zeta(150.0)), (found[1], zeta(series))] {
            let damping = feature.damping.expect("falls by 3 dB on both sides");
            assert!(
                (damping / expected - 1.0).abs() < 0.15,
                "{damping} for {expected}"
            );
        }
    }

    #[test]
    fn short_and_flat_curves_have_no_features() {
        for points in [1, 2, 3, 10] {
            let hz = (1..=points).map(f64::from).collect();
            let flat = Frf::new(
                hz,
                Array3::from_elem((points as usize, 1, 1), Complex64::from(1.0)),
            )
            .expect("shapes agree");
            assert_eq!(find_features(&flat, 0, 0, 0.0), []);
        }
    }
}
