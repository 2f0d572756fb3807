//! Signs of another inertia: notch and peak moved unlike, and a level beside them moved as the
//! inertia asks.
//!
//! Two masses on a spring: another link moves the notch more than the peak, and the level below both
//! by `2 ln(notch) - 2 ln(peak)`, not the level above; another motor leaves the notch, and moves the
//! level above both by `2 ln(peak)` and more.

use crate::compare::change::Change;
use crate::compare::curve::DB_PER_NEPER;
use crate::compare::entry::EntryComparison;
use crate::compare::verdict::damping::notch_and_peak;
use crate::compare::verdict::mass_lines::LevelChange;

/// Share of the level change that the shifts ask for, at least and (inverse) at most.
const SHARE: f64 = 0.5;
/// Change of the level above over that below up to which the motor is the same.
const STAYS: f64 = 0.25;
/// Standard deviations that count.
const SIGMAS: f64 = 2.6;

/// Whose inertia changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Whose {
    Link,
    Motor,
}

/// Notch and peak of an axis, and whose inertia moved them.
pub(crate) struct Inertia<'a> {
    pub(crate) entry: &'a EntryComparison,
    pub(crate) whose: Whose,
    pub(crate) notch: &'a Change,
    pub(crate) peak: &'a Change,
}

/// What moved the notch and the peak of an axis unlike; `None` where nothing did, or the levels do
/// not say so.
pub(crate) fn other_inertia(entry: &EntryComparison) -> Option<Inertia<'_>> {
    let (notch, peak) = notch_and_peak(&entry.changes)?;
    let (of_notch, of_peak) = (notch.log_ratio()?, peak.log_ratio()?);
    let apart = of_notch.value - of_peak.value;
    let uncertain = SIGMAS * of_notch.std.hypot(of_peak.std) + of_notch.bound + of_peak.bound;
    let lines = &entry.mass_lines;
    let is_unlike = apart.abs() > uncertain;
    let is_the_notch = of_notch.value.abs() > of_peak.value.abs();
    let whose = if !is_unlike {
        None
    } else if is_the_notch && notch.has_moved() {
        let (below, above) = (lines.below?, lines.above?);
        (follows(below, 2.0 * apart) && stays(above, below)).then_some(Whose::Link)
    } else if !is_the_notch && peak.has_moved() {
        follows(lines.above?, 2.0 * of_peak.value).then_some(Whose::Motor)
    } else {
        None
    };
    whose.map(|whose| Inertia {
        entry,
        whose,
        notch,
        peak,
    })
}

/// Whether a level moved far less than another.
fn stays(level: LevelChange, other: LevelChange) -> bool {
    level.db.abs() <= STAYS * other.db.abs() + SIGMAS * level.std_db
}

/// Whether a level moved as far as it should, in nepers.
fn follows(level: LevelChange, should: f64) -> bool {
    let share = level.db / (DB_PER_NEPER * should);
    let is_more_than_noise = level.db.abs() > SIGMAS * level.std_db;
    is_more_than_noise && (SHARE..=2.0 / SHARE).contains(&share)
}
