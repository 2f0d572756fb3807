//! Table of what was asked of the robot beside its limits.

use frfid_experiment::Load;
use frfid_signals::format::significant;
use frfid_signals::{Excess, Limit, Limits};

use crate::text::table::table;

/// Further rows of each axis: a name, and the value of every axis.
pub(crate) type Others = [(&'static str, Vec<String>)];

/// Largest values beside their limits, a row for each axis and quantity, and below them `others`.
pub(crate) fn load_as_text(title: &str, load: &Load, limits: &Limits, others: &Others) -> String {
    let mut rows = vec![row([title, "at most", "limit", "used"])];
    for (axis, rms_nm) in load.torque_rms_nm.iter().enumerate() {
        let quantities = Limit::ALL.iter();
        rows.extend(quantities.filter_map(|&limit| limited(load, limits, limit, axis)));
        let name = format!("axis {} torque, rms", axis + 1);
        rows.push(row([&name, &with_unit(*rms_nm, Limit::Torque), "-", ""]));
        for (name, values) in others {
            let name = format!("axis {} {name}", axis + 1);
            rows.extend(
                values
                    .get(axis)
                    .map(|value| vec![name, value.clone(), "-".into()]),
            );
        }
    }
    table(&rows)
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
        format!("axis {} {}", axis + 1, name(limit)),
        with_unit(value, limit),
        allowed.map_or_else(|| "-".into(), |allowed| with_unit(allowed, limit)),
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

fn row(cells: [&str; 4]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

/// A limit that was exceeded, in words.
pub(crate) fn excess_in_words(excess: &Excess) -> String {
    let &Excess {
        axis,
        limit,
        allowed,
        found,
    } = excess;
    let [found, allowed] = [found, allowed].map(|value| with_unit(value, limit));
    format!(
        "axis {} {} reached {found}, the limit is {allowed}",
        axis + 1,
        name(limit)
    )
}
