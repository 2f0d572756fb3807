//! Signs of another stiffness: notch and peak of an axis moved by one ratio, while the inertias
//! stayed.
//!
//! A motor and a link on a spring have their antiresonance at `sqrt(k / J_link)` and their resonance
//! at `sqrt(k (1 / J_motor + 1 / J_link))`: the spring moves both by one ratio, an inertia does not,
//! and moves the level below or above them by twice the difference of their logarithms.

use crate::compare::change::{Change, LogRatio};
use crate::compare::curve::DB_PER_NEPER;
use crate::compare::entry::EntryComparison;
use crate::compare::verdict::damping::notch_and_peak;
use crate::compare::verdict::mass_lines::{LevelChange, MassLines};

/// Difference of two shifts that are alike, over their mean.
const ALIKE: f64 = 0.1;
/// Uncertainty of the shift of the notches, or of the peaks, over the mean of both beyond which it
/// does not tell alike from unlike.
const TELLING: f64 = 0.15;
/// Typical error of what lies within a bound, over the bound.
const TYPICAL: f64 = 0.5;
/// Standard deviations of a difference that are chance, of one and of the worst of many.
const SIGMAS: f64 = 2.0;
const SIGMAS_OF_MANY: f64 = 3.5;
/// Change of a level that a spring may make, over that of an inertia that shifts as far: below half
/// its frequency a resonance raises the level by a quarter and less.
const SAME_INERTIA: f64 = 0.25;

/// The resonance that a spring moved.
pub(crate) struct Stiffening<'a> {
    pub(crate) entry: &'a EntryComparison,
    pub(crate) peak: &'a Change,
    /// Logarithm of the ratio by which the features moved, B over A.
    pub(crate) shift: f64,
}

/// That with the largest shift.
pub(crate) fn largest<'s, 'a>(found: &'s [Stiffening<'a>]) -> Option<&'s Stiffening<'a>> {
    let shifts = found.iter();
    shifts.max_by(|x, y| x.shift.abs().total_cmp(&y.shift.abs()))
}

/// Whether the features of these axes all moved by one ratio, notches and peaks, while the inertias
/// stayed. Where the levels on both sides of the features are known, which an inertia that moved the
/// peaks would have moved, the notches need only not contradict.
pub(crate) fn moved_alike<'a>(axes: &[&'a EntryComparison]) -> Option<Stiffening<'a>> {
    let shifts: Vec<Shift> = axes.iter().flat_map(|entry| shifts(entry)).collect();
    let of_kind = |is_resonance: bool| {
        mean(
            shifts
                .iter()
                .filter(|shift| shift.change.is_resonance() == is_resonance),
        )
    };
    let (all, peaks, notches) = (mean(shifts.iter())?, of_kind(true)?, of_kind(false)?);
    let size = all.value.abs();
    let is_telling = |mean: LogRatio| {
        SIGMAS * mean.std + TYPICAL * mean.bound <= TELLING * size
            && mean.value.abs() > mean.uncertain()
    };
    let apart = (peaks.value - notches.value).abs();
    let chance = SIGMAS * peaks.std.hypot(notches.std) + peaks.bound + notches.bound;
    let is_alike = |shift: &Shift| {
        let LogRatio { value, std, bound } = shift.ratio;
        (value - all.value).abs() <= ALIKE * size + SIGMAS_OF_MANY * std + bound
    };
    let by_levels = axes
        .iter()
        .all(|entry| would_show_inertia(&entry.mass_lines, all.value));
    let is_told = is_telling(peaks) && (by_levels || is_telling(notches));
    let found = is_told && apart <= ALIKE * size + chance;
    let stays = |entry: &&EntryComparison| keeps_inertia(&entry.mass_lines, all.value);
    if !(found && shifts.iter().all(is_alike) && axes.iter().all(stays)) {
        return None;
    }
    let resonances = shifts.iter().filter(|shift| shift.change.is_resonance());
    let prominence = |shift: &&Shift| shift.change.a.prominence_db;
    let Shift { entry, change, .. } =
        *resonances.max_by(|x, y| prominence(x).total_cmp(&prominence(y)))?;
    Some(Stiffening {
        entry,
        peak: change,
        shift: all.value,
    })
}

/// Whether the only resonance moved, by more than its width, away from an antiresonance that stayed,
/// while the inertias stayed: no linear joint does that, but one whose spring is another one where
/// it deflects.
pub(crate) fn peak_moved_alone(entry: &EntryComparison) -> Option<Stiffening<'_>> {
    let (notch, peak) = notch_and_peak(&entry.changes)?;
    let shift = peak.log_ratio()?.value;
    let of_both = entry.changes.iter().filter(|change| change.b.is_some());
    let n_peaks = of_both.filter(|change| change.is_resonance()).count();
    let is_alone = n_peaks == 1 && peak.has_moved_beyond_width() && !notch.has_moved();
    let is_known = would_show_inertia(&entry.mass_lines, shift);
    (is_alone && is_known && keeps_inertia(&entry.mass_lines, shift)).then_some(Stiffening {
        entry,
        peak,
        shift,
    })
}

/// Whether all that moved on these axes moved in one sense, the peak of each farther than its notch, while the
/// inertias stayed: a spring that is another one at each deflection moves no two features by one ratio, and the
/// peak, where it deflects most, farther than the notch. Another link moves the notch farther, another
/// motor not at all.
pub(crate) fn moved_in_one_sense<'a>(axes: &[&'a EntryComparison]) -> Option<Vec<Stiffening<'a>>> {
    let found = axes.iter().map(|entry| peak_moved_farther(entry));
    let found: Vec<Stiffening> = found.collect::<Option<_>>()?;
    let shift = largest(&found)?.shift;
    let moved = axes.iter().flat_map(|entry| shifts(entry));
    let mut moved = moved.filter(|moved| moved.change.has_moved());
    let is_one_sense = moved.all(|moved| moved.ratio.value * shift > 0.0);
    let stays = |entry: &&EntryComparison| {
        let lines = &entry.mass_lines;
        lines.below.is_some_and(|below| is_known(below, shift)) && keeps_inertia(lines, shift)
    };
    let mut changes = axes.iter().flat_map(|entry| &entry.changes);
    let has_notch_moved = changes.any(|change| !change.is_resonance() && change.has_moved());
    (is_one_sense && has_notch_moved && axes.iter().all(stays)).then_some(found)
}

/// The most prominent peak of an axis, if it moved farther than the most prominent notch.
fn peak_moved_farther(entry: &EntryComparison) -> Option<Stiffening<'_>> {
    let (notch, peak) = notch_and_peak(&entry.changes)?;
    let (of_notch, of_peak) = (notch.log_ratio()?, peak.log_ratio()?);
    let chance = SIGMAS_OF_MANY * of_notch.std.hypot(of_peak.std);
    let (of_notch, of_peak) = (of_notch.value, of_peak.value);
    let is_farther = of_notch * of_peak > 0.0 && of_peak.abs() >= of_notch.abs() + chance;
    (peak.has_moved() && is_farther).then_some(Stiffening {
        entry,
        peak,
        shift: of_peak,
    })
}

/// Shift of a feature that both have.
#[derive(Clone, Copy)]
struct Shift<'a> {
    entry: &'a EntryComparison,
    change: &'a Change,
    ratio: LogRatio,
}

fn shifts(entry: &EntryComparison) -> impl Iterator<Item = Shift<'_>> {
    let ratio = |change| Some((change, Change::log_ratio(change)?));
    let found = entry.changes.iter().filter_map(ratio);
    found.map(move |(change, ratio)| Shift {
        entry,
        change,
        ratio,
    })
}

/// Mean with the weights of the uncertainties; `None` of none.
fn mean<'a>(shifts: impl Iterator<Item = &'a Shift<'a>>) -> Option<LogRatio> {
    let (mut value, mut variance, mut bound, mut weights) = (0.0, 0.0, 0.0, 0.0);
    for Shift { ratio, .. } in shifts {
        // a hundredth of a per cent: features that are known exactly count alike
        let weight = 1.0 / (ratio.std.powi(2) + ratio.bound.powi(2) + 1e-8);
        value += weight * ratio.value;
        variance += (weight * ratio.std).powi(2);
        bound += weight * ratio.bound;
        weights += weight;
    }
    (weights > 0.0).then(|| LogRatio {
        value: value / weights,
        std: variance.sqrt() / weights,
        bound: bound / weights,
    })
}

/// Whether no level beside the resonances moved as an inertia that shifts them so far would move it,
/// by `2 |shift|`.
fn keeps_inertia(lines: &MassLines, shift: f64) -> bool {
    let stays =
        |level: LevelChange| level.db.abs() <= least_db(shift) + SIGMAS_OF_MANY * level.std_db;
    lines.below.is_none_or(stays) && lines.above.is_none_or(stays)
}

/// Whether both levels are known so well that an inertia would have been seen.
fn would_show_inertia(lines: &MassLines, shift: f64) -> bool {
    let is_known = |level: LevelChange| is_known(level, shift);
    lines.below.is_some_and(is_known) && lines.above.is_some_and(is_known)
}

/// Whether a level is known so well that an inertia that shifts so far would have moved it visibly.
fn is_known(level: LevelChange, shift: f64) -> bool {
    SIGMAS * level.std_db <= least_db(shift)
}

/// Change of a level that a spring may make.
fn least_db(shift: f64) -> f64 {
    SAME_INERTIA * 2.0 * DB_PER_NEPER * shift.abs()
}
