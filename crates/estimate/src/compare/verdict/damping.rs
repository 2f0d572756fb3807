//! Marks of more damping in one of two FRFs: a lower resonance, a shallower antiresonance, a phase
//! pushed together.

use crate::compare::change::{Change, Side, Sides};
use crate::compare::curve::Curve;

/// A level difference of a resonance or antiresonance that counts, in dB.
const LEVEL_DB: f64 = 2.0;
/// Standard deviations that it must exceed: by chance one in a hundred does.
const SIGMAS: f64 = 2.6;
/// A resonance that damping lowers by this much, in dB, is buried: what is left in its place says
/// nothing about the spring.
const BURIED_DB: f64 = 10.0;
/// Ratio of two dampings that counts: 2 dB of level are a quarter more.
const MORE_DAMPING: f64 = 1.15;
/// Standard deviation of a line, in dB, in which a resonance may be hidden: that there is none says
/// nothing.
const HIDING_DB: f64 = 0.5;
/// A difference of phase ranges that counts, in degrees.
const PHASE_DEG: f64 = 5.0;

/// The marks in one entry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampingMarks {
    /// The FRF that shows them.
    pub side: Side,
    /// How far its resonance lies below in dB.
    pub resonance_down_db: f64,
    /// Standard deviation of that; `None` where it is not known.
    pub resonance_down_std_db: Option<f64>,
    /// How much its antiresonance is filled up in dB, where there is one.
    pub antiresonance_up_db: Option<f64>,
    /// How much smaller its range of phase is in degrees.
    pub phase_range_smaller_deg: f64,
}

impl DampingMarks {
    pub(crate) fn buries_resonance(&self) -> bool {
        self.resonance_down_db >= BURIED_DB
    }
}

/// The marks by the most prominent resonance and antiresonance of A; `None` where they are no more
/// than noise or the blur of a chirp explain.
pub(crate) fn damping_marks(
    changes: &[Change],
    phase_range_deg: Sides<f64>,
    curves: (&Curve, &Curve),
) -> Option<DampingMarks> {
    let resonance = most_prominent(changes.iter().filter(|change| change.is_resonance()))?;
    let antiresonance = most_prominent(changes.iter().filter(|change| !change.is_resonance()));
    let level_db = resonance.level_db?;
    let (side, sign) = if level_db < 0.0 {
        (Side::B, 1.0)
    } else {
        (Side::A, -1.0)
    };
    let resonance_down_std_db = resonance.level_std_db;
    if !is_known(resonance, curves) || !has_more_damping(resonance, side) {
        return None;
    }
    let uncertain_db = SIGMAS * resonance_down_std_db.unwrap_or(0.0);
    let blur_db = down_by_blur_db(resonance, curves, side);
    let marks = DampingMarks {
        side,
        resonance_down_db: -sign * level_db,
        resonance_down_std_db,
        antiresonance_up_db: antiresonance.and_then(|change| Some(sign * change.level_db?)),
        phase_range_smaller_deg: sign * (phase_range_deg.a - phase_range_deg.b),
    };
    let antiresonance_std_db = antiresonance.and_then(|change| change.level_std_db);
    let least_up_db = LEVEL_DB.max(SIGMAS * antiresonance_std_db.unwrap_or(0.0));
    let is_told = antiresonance.is_some_and(|change| is_known(change, curves));
    let is_shallower = marks
        .antiresonance_up_db
        .is_some_and(|up| up >= least_up_db);
    let second_mark = is_told && is_shallower || marks.phase_range_smaller_deg >= PHASE_DEG;
    let is_lower = marks.resonance_down_db >= LEVEL_DB.max(uncertain_db).max(blur_db);
    (is_lower && second_mark).then_some(marks)
}

/// Whether a change of level, as far as there is noise, is known in spite of it.
fn is_known(change: &Change, (a, b): (&Curve, &Curve)) -> bool {
    let has_noise = a.scatter.is_some() && b.scatter.is_some();
    let is_precise = |std: f64| change.b.is_some() || std <= HIDING_DB;
    !has_noise || change.level_std_db.is_some_and(is_precise)
}

/// Whether the damping of that side is the larger, where both are known.
fn has_more_damping(resonance: &Change, side: Side) -> bool {
    let ratio = resonance.damping_ratio();
    ratio.is_none_or(|ratio| match side {
        Side::A => ratio * MORE_DAMPING <= 1.0,
        Side::B => ratio >= MORE_DAMPING,
    })
}

/// How much lower a resonance would be by the blur of that side alone, in dB: the other's curve,
/// blurred as far.
fn down_by_blur_db(resonance: &Change, (a, b): (&Curve, &Curve), side: Side) -> f64 {
    let (lower, other, feature) = match side {
        Side::A => (a, b, resonance.b),
        Side::B => (b, a, Some(resonance.a)),
    };
    let Some(feature) = feature.filter(|_| lower.relative_resolution > 0.0) else {
        return 0.0;
    };
    let blurred = other.blurred_db_at(feature.frequency_hz, lower.relative_resolution);
    blurred.map_or(0.0, |blurred| feature.magnitude_db - blurred)
}

/// The most prominent notch and peak of an entry that both have.
pub(crate) fn notch_and_peak(changes: &[Change]) -> Option<(&Change, &Change)> {
    let of_kind = |is_resonance: bool| {
        let changes = changes.iter().filter(|change| change.b.is_some());
        most_prominent(changes.filter(move |change| change.is_resonance() == is_resonance))
    };
    Some((of_kind(false)?, of_kind(true)?))
}

/// The most prominent of these changes, in A.
pub(crate) fn most_prominent<'a>(changes: impl Iterator<Item = &'a Change>) -> Option<&'a Change> {
    changes.max_by(|x, y| x.a.prominence_db.total_cmp(&y.a.prominence_db))
}
