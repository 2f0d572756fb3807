//! Signs of another stiffness: notch and peak of an axis moved by one ratio, while the inertias
//! stayed.
//!
//! A motor and a link on a spring have their antiresonance at `sqrt(k / J_link)` and their resonance
//! at `sqrt(k (1 / J_motor + 1 / J_link))`: the spring moves both by one ratio, an inertia does not,
//! and moves the level below or above them by twice the difference of their logarithms.

use crate::compare::change::{Change, LogRatio};
use crate::compare::entry::EntryComparison;
use crate::compare::feature::resonance::DB_PER_NEPER;
use crate::compare::verdict::damping::most_prominent;
use crate::compare::verdict::mass_lines::{LevelChange, MassLines};

/// Difference of two shifts that are alike, over their mean.
const ALIKE: f64 = 0.1;
/// Uncertainty of a shift over the mean of all beyond which it does not tell alike from unlike.
const TELLING: f64 = 0.25;
/// Standard deviations of a difference that are chance.
const SIGMAS: f64 = 2.0;
/// Change of a level that a spring may make, over the shift: below half its frequency a resonance
/// raises the level by a quarter and less.
const SAME_INERTIA: f64 = 0.5;

/// The resonance of an axis that a spring moved.
pub(crate) struct Stiffening<'a> {
    pub(crate) entry: &'a EntryComparison,
    pub(crate) peak: &'a Change,
    /// Logarithm of the ratio by which the features of the axis moved, B over A.
    pub(crate) shift: f64,
}

/// Whether the features of an axis all moved by one ratio, notch and peak among them, and its
/// inertias stayed.
pub(crate) fn moved_alike(entry: &EntryComparison) -> Option<Stiffening<'_>> {
    let shifts: Vec<(&Change, LogRatio)> = shifts(entry).collect();
    let mean = mean(shifts.iter().map(|(_, shift)| shift))?;
    let is_telling = |shift: &LogRatio| SIGMAS * shift.std + shift.bound <= TELLING * mean.abs();
    let telling = || shifts.iter().filter(|(_, shift)| is_telling(shift));
    let is_alike = |(_, shift): &(&Change, LogRatio)| {
        let apart = (shift.value - mean).abs();
        apart <= ALIKE * mean.abs() + SIGMAS * shift.std + shift.bound
    };
    let peaks = || {
        telling()
            .map(|(change, _)| *change)
            .filter(|change| change.is_resonance())
    };
    let has_notch = telling().any(|(change, _)| !change.is_resonance());
    let moved = telling().all(|(change, _)| change.has_moved());
    if !(has_notch
        && moved
        && shifts.iter().all(is_alike)
        && keeps_inertia(&entry.mass_lines, mean))
    {
        return None;
    }
    Some(Stiffening {
        entry,
        peak: most_prominent(peaks())?,
        shift: mean,
    })
}

/// Whether the most prominent resonance alone moved, away from an antiresonance that stayed, while
/// the inertias stayed: no linear joint does that, but one whose spring is another one where it
/// deflects.
pub(crate) fn peak_moved_alone(entry: &EntryComparison) -> Option<Stiffening<'_>> {
    let of_kind = |is_resonance: bool| {
        let changes = entry.changes.iter().filter(|change| change.b.is_some());
        changes.filter(move |change| change.is_resonance() == is_resonance)
    };
    let (peak, notch) = (
        most_prominent(of_kind(true))?,
        most_prominent(of_kind(false))?,
    );
    let shift = peak.log_ratio()?.value;
    let MassLines { below, above } = entry.mass_lines;
    let is_alone = of_kind(true).count() == 1 && peak.has_moved() && !notch.has_moved();
    (is_alone && below.is_some() && above.is_some() && keeps_inertia(&entry.mass_lines, shift))
        .then_some(Stiffening { entry, peak, shift })
}

/// The shifts of all features that both have.
fn shifts(entry: &EntryComparison) -> impl Iterator<Item = (&Change, LogRatio)> {
    let changes = entry.changes.iter();
    changes.filter_map(|change| Some((change, change.log_ratio()?)))
}

/// Mean with the weights of the uncertainties; `None` of none.
fn mean<'a>(shifts: impl Iterator<Item = &'a LogRatio>) -> Option<f64> {
    // a hundredth of a per cent: features that are known exactly count alike
    let weight = |shift: &LogRatio| 1.0 / (shift.std.powi(2) + shift.bound.powi(2) + 1e-8);
    let sums = shifts.fold((0.0, 0.0), |(sum, weights), shift| {
        (sum + weight(shift) * shift.value, weights + weight(shift))
    });
    (sums.1 > 0.0).then(|| sums.0 / sums.1)
}

/// Whether the levels beside the resonances, where they are known, moved less than an inertia that
/// shifts them so far would move them, `2 |shift|`.
pub(crate) fn keeps_inertia(lines: &MassLines, shift: f64) -> bool {
    let least_db = SAME_INERTIA * DB_PER_NEPER * shift.abs();
    let stays = |level: LevelChange| level.db.abs() <= least_db + SIGMAS * level.std_db;
    lines.below.is_none_or(stays) && lines.above.is_none_or(stays)
}
