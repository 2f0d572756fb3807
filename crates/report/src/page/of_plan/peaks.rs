//! Peaks of an exported plan beside its limits.

use frfid_files::{Check, Exported, Rehearsal};
use frfid_signals::format::{count, significant};
use frfid_signals::{Limit, Peaks};

use crate::page::of_plan::{Row, table};
use crate::page::section::Part;
use crate::page::table::Table;

/// What a machine should have limits of.
const BOUNDED: [Limit; 4] = [
    Limit::Velocity,
    Limit::Acceleration,
    Limit::Jerk,
    Limit::Torque,
];

/// The limits that the description does not give.
pub(super) fn unlimited(exported: &Exported) -> String {
    let limits = &exported.player.limits;
    let missing = BOUNDED.iter().filter(|limit| limits.get(**limit).is_none());
    let missing: Vec<_> = missing.map(|limit| limit.quantity()).collect();
    match missing.join(", ").as_str() {
        "" => String::new(),
        missing => format!("Not limited by the description, so not checked: {missing}."),
    }
}

/// The farther of what is commanded and what is predicted, and what only one of them knows.
pub(super) fn reached(exported: &Exported) -> Peaks {
    let [commanded, predicted] = both(exported);
    let farther = commanded.farther(&predicted);
    let mut reached = predicted;
    reached.extend(commanded);
    reached.extend(farther);
    reached
}

/// The largest of all runs, commanded and predicted.
fn both(exported: &Exported) -> [Peaks; 2] {
    let commanded = largest(exported, |run| Some(&run.commanded));
    let predicted = largest(exported, |run| run.predicted.as_ref());
    [commanded, predicted].map(Option::unwrap_or_default)
}

/// The largest of all runs; `None` where a run does not know.
fn largest(exported: &Exported, of: fn(&Rehearsal) -> Option<&Peaks>) -> Option<Peaks> {
    let mut all = exported.runs.iter().map(of);
    let first = all.next()??.clone();
    all.try_fold(first, |largest, peaks| Some(largest.farther(peaks?)))
}

/// Every peak beside its limit, a table for each joint.
pub(super) fn peaks(exported: &Exported) -> Part<'_> {
    let both = both(exported);
    let joints = 0..exported.joint_names.len();
    let note = "The largest of all runs from rest to rest: of the commands, and of the motion that the model predicts.";
    Part {
        title: "Peaks and limits".into(),
        notes: vec![note.into()],
        tables: joints
            .map(|joint| of_joint(exported, &both, joint))
            .collect(),
        ..Part::default()
    }
}

fn of_joint(exported: &Exported, both: &[Peaks; 2], joint: usize) -> Table {
    let columns = ["Largest", "Commanded", "Predicted", "Limit", "Used"];
    let limits = Limit::ALL.iter();
    let rows = limits.filter_map(|&limit| peak(exported, both, limit, joint));
    table(&exported.joint_names[joint], &columns, rows.collect())
}

/// A quantity of a joint: commanded, predicted, its limit, how much of it is used; `None` where it is not known, and for
/// positions without a limit, which stand elsewhere.
fn peak(exported: &Exported, both: &[Peaks; 2], limit: Limit, joint: usize) -> Option<Row> {
    let [commanded, predicted] = both.each_ref().map(|peaks| value(peaks, limit, joint));
    let known = [commanded, predicted].into_iter().flatten();
    let largest = known.reduce(f64::max)?;
    let allowed = exported.player.limits.of(limit, joint);
    if !limit.is_size() && !allowed.is_finite() {
        return None;
    }
    let [commanded, predicted, bound] =
        [commanded, predicted, finite(allowed)].map(|value| with_unit(value, limit));
    let used = share(largest, allowed, limit);
    Some((
        limit.quantity().to_owned(),
        vec![commanded, predicted, bound, used],
    ))
}

/// A peak of a joint.
pub(super) fn value(peaks: &Peaks, limit: Limit, joint: usize) -> Option<f64> {
    peaks.get(limit)?.get(joint).copied()
}

pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn with_unit(value: Option<f64>, limit: Limit) -> String {
    let text = value.map(|value| format!("{} {}", significant(value, 4), unit(limit)));
    text.unwrap_or_else(|| "-".into())
}

/// The unit as it is printed.
fn unit(limit: Limit) -> String {
    limit.unit().replace("^2", "\u{b2}").replace("^3", "\u{b3}")
}

/// How much of the limit of a size is used.
fn share(found: f64, allowed: f64, limit: Limit) -> String {
    if !limit.is_size() || !allowed.is_finite() {
        return "-".into();
    }
    format!("{} %", significant(100.0 * found / allowed, 3))
}

/// That every limit is kept.
pub(super) fn checks(exported: &Exported) -> Vec<Check> {
    let excesses = exported.player.limits.exceeded(&reached(exported));
    vec![Check {
        name: "limits".into(),
        passed: excesses.is_empty(),
        found: format!("{} beyond a limit", count(excesses.len(), "peak")),
        needed: "no sample of a command or of the predicted motion beyond a limit".into(),
        advice: "lower the amplitudes".into(),
    }]
}

/// Which peak comes closest to its limit, in words.
pub(super) fn closest(exported: &Exported) -> String {
    let shares = shares(exported).into_iter();
    let Some((share, quantity, joint)) = shares.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return String::new();
    };
    let percent = significant(100.0 * share, 3);
    format!("Closest to its limit: the {quantity} of {joint}, at {percent} %.")
}

/// Every size that has a limit: its share of it, what it is, the joint.
fn shares(exported: &Exported) -> Vec<(f64, &'static str, &str)> {
    let peaks = reached(exported);
    let limits = exported.player.limits.iter();
    let sizes = limits.filter(|(limit, _)| limit.is_size());
    let shares = sizes.flat_map(|(limit, allowed)| {
        let found = peaks.get(limit).unwrap_or_default().iter();
        let shares = found.zip(allowed).zip(&exported.joint_names);
        shares.map(move |((found, allowed), joint)| {
            (found / allowed, limit.quantity(), joint.as_str())
        })
    });
    shares.collect()
}
