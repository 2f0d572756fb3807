//! One verdict on a machine from all entries: its own axes, the diagonal, are asked, and what they
//! say must not contradict itself.

use crate::compare::agreement::Agreement;
use crate::compare::change::{Change, Side};
use crate::compare::entry::EntryComparison;
use crate::compare::verdict::damping::DampingMarks;
use crate::compare::verdict::inertia::{Inertia, Whose, other_inertia};
use crate::compare::verdict::stiffness::{
    Stiffening, largest, moved_alike, moved_in_one_sense, peak_moved_alone,
};
use crate::compare::verdict::{Judgement, Peak, Verdict};

/// The verdict; `None` where the FRFs agree within their noise, or nothing stands out.
pub(crate) fn judge(
    entries: &[EntryComparison],
    is_square: bool,
    agreement: &Agreement,
    stronger: Option<Side>,
) -> Option<Judgement> {
    if agreement.agrees() == Some(true) {
        return None;
    }
    let is_own = |entry: &&EntryComparison| !is_square || entry.output == entry.input;
    let axes: Vec<&EntryComparison> = entries.iter().filter(is_own).collect();
    let damping = damping(&axes);
    if let Some((entry, marks)) = damping.filter(|(_, marks)| marks.buries_resonance()) {
        return Some(damped(entry, marks, stronger));
    }
    stiffness(&axes, stronger)
        .or_else(|| inertia(&axes))
        .or_else(|| {
            damping
                .filter(|_| !has_moved_away(&axes))
                .map(|(entry, marks)| damped(entry, marks, stronger))
        })
        .or_else(|| unexplained(&axes, agreement))
}

/// Stiffness, where all axes together, or each that moved, moved as by a spring, in one sense.
fn stiffness(axes: &[&EntryComparison], stronger: Option<Side>) -> Option<Judgement> {
    let moved = || {
        axes.iter()
            .filter(|entry| entry.changes.iter().any(Change::has_moved))
    };
    let together = || Some(vec![moved_alike(axes)?]);
    let each = || moved().map(|entry| moved_alike(&[entry])).collect();
    let alone = || {
        stronger?;
        moved().map(|entry| peak_moved_alone(entry)).collect()
    };
    let unlike = || stronger.and_then(|_| moved_in_one_sense(axes));
    let found: Vec<Stiffening> = together().or_else(each).or_else(alone).or_else(unlike)?;
    let largest = largest(&found)?;
    let is_one_sense = found
        .iter()
        .all(|other| other.shift.signum() == largest.shift.signum());
    let (a, b) = (Peak::of(&largest.peak.a), Peak::of(&largest.peak.b?));
    let verdict = match stronger {
        None => Verdict::StiffnessDiffers { a, b },
        Some(side) => {
            let (weaker, stronger) = if side == Side::A { (b, a) } else { (a, b) };
            if stronger.hz > weaker.hz {
                Verdict::StiffnessGrowsWithDeflection { weaker, stronger }
            } else {
                Verdict::StiffnessFallsWithDeflection { weaker, stronger }
            }
        }
    };
    is_one_sense.then(|| Judgement::of(verdict, largest.entry))
}

/// Another inertia on the axis where notch and peak moved most unlike.
fn inertia(axes: &[&EntryComparison]) -> Option<Judgement> {
    let found: Vec<Inertia> = axes
        .iter()
        .filter_map(|entry| other_inertia(entry))
        .collect();
    let percent = |change: &Change| change.shift_percent().unwrap_or(f64::NAN);
    let apart = |found: &Inertia| (percent(found.notch) - percent(found.peak)).abs();
    let clearest = found.iter().max_by(|x, y| apart(x).total_cmp(&apart(y)))?;
    let (notch_percent, peak_percent) = (percent(clearest.notch), percent(clearest.peak));
    let verdict = match clearest.whose {
        Whose::Link => Verdict::PayloadOrPose {
            notch_percent,
            peak_percent,
        },
        Whose::Motor => Verdict::MotorInertia {
            notch_percent,
            peak_percent,
        },
    };
    let is_one = found.iter().all(|other| other.whose == clearest.whose);
    is_one.then(|| Judgement::of(verdict, clearest.entry))
}

/// The clearest marks of damping; `None` if axes show them on different sides.
fn damping<'a>(axes: &[&'a EntryComparison]) -> Option<(&'a EntryComparison, DampingMarks)> {
    let found = || {
        axes.iter()
            .filter_map(|entry| Some((*entry, entry.damping?)))
    };
    let down = |marks: &DampingMarks| marks.resonance_down_db;
    let clearest = found().max_by(|x, y| down(&x.1).total_cmp(&down(&y.1)))?;
    found()
        .all(|(_, marks)| marks.side == clearest.1.side)
        .then_some(clearest)
}

/// Friction if it is the weaker excitation that is damped.
fn damped(entry: &EntryComparison, marks: DampingMarks, stronger: Option<Side>) -> Judgement {
    let is_the_weaker = stronger.is_some_and(|stronger| stronger != marks.side);
    let verdict = if is_the_weaker {
        Verdict::FrictionIn(marks)
    } else {
        Verdict::DampingDiffers(marks)
    };
    Judgement::of(verdict, entry)
}

/// Whether a feature moved by more than its width, which damping alone does not do.
fn has_moved_away(axes: &[&EntryComparison]) -> bool {
    let mut changes = axes.iter().flat_map(|entry| &entry.changes);
    changes.any(Change::has_moved_beyond_width)
}

/// That they differ: by the test, or by a feature that moved.
fn unexplained(axes: &[&EntryComparison], agreement: &Agreement) -> Option<Judgement> {
    let changes = axes
        .iter()
        .flat_map(|entry| entry.changes.iter().map(move |change| (*entry, change)));
    let moved = changes.filter(|(_, change)| change.has_moved());
    let clearest = moved.max_by(|(_, x), (_, y)| x.a.prominence_db.total_cmp(&y.a.prominence_db));
    let worst = match agreement {
        Agreement::Tested(test) => test.worst,
        Agreement::Unknown { .. } => None,
    };
    if clearest.is_none() && agreement.agrees() != Some(false) {
        return None;
    }
    let moved = clearest
        .and_then(|(_, change)| Some((change.a.kind, Peak::of(&change.a), Peak::of(&change.b?))));
    Some(Judgement {
        verdict: Verdict::Differs { moved, worst },
        entry: clearest.map(|(entry, _)| (entry.output, entry.input)),
    })
}
