//! Table of what was asked of the robot beside its limits.

use frfid_experiment::Load;
use frfid_signals::format::significant;
use frfid_signals::{Excess, Limit, Limits};

use crate::text::table::{or_dash, row, table};

/// Further rows of each axis: a name, and the value of every axis.
pub(crate) type Others = [(&'static str, Vec<String>)];

/// Largest values beside their limits, a row for each axis and quantity, and below them `others`.
pub(crate) fn load_as_text(title: &str, load: &Load, limits: &Limits, others: &Others) -> String {
    let mut rows = vec![row([title, "at most", "limit", "used"])];
    for (axis, rms_nm) in load.torque_rms_nm.iter().enumerate() {
        let quantities = Limit::ALL.iter();
        rows.extend(quantities.filter_map(|&limit| limited(load, limits, limit, axis)));
        let rms = with_unit(*rms_nm, Limit::Torque);
        rows.push(row([&of_axis(axis, "torque, rms"), &rms, "-", ""]));
        rows.extend(others.iter().filter_map(|other| unlimited(other, axis)));
    }
    table(&rows)
}

/// The row of a quantity without a limit, if this axis has a value.
fn unlimited((name, values): &(&str, Vec<String>), axis: usize) -> Option<Vec<String>> {
    let value = values.get(axis)?;
    Some(row([&of_axis(axis, name), value, "-"]))
}

fn of_axis(axis: usize, quantity: &str) -> String {
    format!("axis {} {quantity}", axis + 1)
}

/// The row of a quantity: some have one only where they have a limit.
fn limited(load: &Load, limits: &Limits, limit: Limit, axis: usize) -> Option<Vec<String>> {
    let value = *load.peaks.get(limit)?.get(axis)?;
    let allowed = Some(limits.of(limit, axis)).filter(|allowed| allowed.is_finite());
    if allowed.is_none() && !is_always_shown(limit) {
        return None;
    }
    let used = |allowed: f64| format!("{:.0} %", 100.0 * value / allowed);
    Some(vec![
        of_axis(axis, &name(limit)),
        with_unit(value, limit),
        or_dash(allowed, |allowed| with_unit(allowed, limit)),
        allowed
            .filter(|_| limit.is_size())
            .map_or_else(String::new, used),
    ])
}

/// Whether a quantity has a row also where it has no limit.
fn is_always_shown(limit: Limit) -> bool {
    match limit {
        Limit::Torque | Limit::TorqueRate | Limit::Velocity | Limit::Travel => true,
        Limit::Acceleration | Limit::Jerk | Limit::LowestPosition | Limit::HighestPosition => false,
    }
}

/// The limited quantity, apart from the rms of the torque beside it.
fn name(limit: Limit) -> String {
    let peak = if limit == Limit::Torque { ", peak" } else { "" };
    format!("{}{peak}", limit.quantity())
}

fn with_unit(value: f64, limit: Limit) -> String {
    format!("{} {}", significant(value, 4), limit.unit())
}

/// A limit that was exceeded, in words.
pub(crate) fn excess_in_words(excess: &Excess) -> String {
    let [found, allowed] =
        [excess.found, excess.allowed].map(|value| with_unit(value, excess.limit));
    let quantity = of_axis(excess.axis, &name(excess.limit));
    format!("{quantity} reached {found}, the limit is {allowed}")
}
