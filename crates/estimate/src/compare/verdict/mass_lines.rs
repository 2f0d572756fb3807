//! Levels below all resonances and above them, where an FRF follows the inertia that moves: all of
//! it below, the motor's above. A spring does not move them.

use frfid_signals::median;
use serde::Serialize;

use crate::compare::change::Change;
use crate::compare::curve::Curve;
use crate::compare::feature::resonance::Feature;

/// Distance from the outermost resonance or antiresonance, as a ratio of frequencies, from which on
/// the inertia alone is left: to a quarter of the shift of a spring.
const BEYOND: f64 = 2.0;
/// Lines that a level takes: a median of fewer is one of them.
const FEWEST_LINES: usize = 3;
/// Standard deviation of normal numbers over their median distance from the median.
const SIGMA_OVER_MAD: f64 = 1.4826;
/// Standard deviation of a median over that of a mean, for normal numbers: sqrt(pi / 2).
const MEDIAN_OVER_MEAN: f64 = 1.2533;

/// A level of B over A.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LevelChange {
    /// Median over the lines in dB.
    pub db: f64,
    /// Standard deviation of that median in dB, from the scatter of the lines.
    pub std_db: f64,
}

/// Levels of B over A beside all resonances; `None` where the band has not three lines there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MassLines {
    /// Below half the lowest resonance or antiresonance: the inertia of motor and arm.
    pub below: Option<LevelChange>,
    /// Above twice the highest one: the inertia of the motor.
    pub above: Option<LevelChange>,
}

impl MassLines {
    /// Of two curves over a band, with the features of both.
    pub(crate) fn of(
        curves: (&Curve, &Curve),
        band_hz: (f64, f64),
        changes: &[Change],
        only_in_b: &[Feature],
    ) -> Self {
        let of_both = changes.iter().flat_map(|change| [Some(change.a), change.b]);
        let features = || of_both.clone().flatten().chain(only_in_b.iter().copied());
        let hz = || features().map(|feature| feature.frequency_hz);
        let (lowest, highest) = (hz().fold(f64::INFINITY, f64::min), hz().fold(0.0, f64::max));
        if highest == 0.0 {
            return Self {
                below: None,
                above: None,
            };
        }
        Self {
            below: level(curves, (band_hz.0, lowest / BEYOND)),
            above: level(curves, (highest * BEYOND, band_hz.1)),
        }
    }
}

fn level((a, b): (&Curve, &Curve), (low_hz, high_hz): (f64, f64)) -> Option<LevelChange> {
    let hz = &a.frequency_hz;
    let places = hz.partition_point(|&f| f < low_hz)..hz.partition_point(|&f| f <= high_hz);
    let change = |k: usize| Some(b.magnitude_db_at(hz[k])? - a.magnitude_db[k]);
    let changes: Vec<f64> = places.filter_map(change).collect();
    let n = changes.len();
    if n < FEWEST_LINES {
        return None;
    }
    let db = median(changes.clone())?;
    let away = median(changes.iter().map(|change| (change - db).abs()).collect())?;
    Some(LevelChange {
        db,
        std_db: SIGMA_OVER_MAD * MEDIAN_OVER_MEAN * away / (n as f64).sqrt(),
    })
}
