//! Text of one entry of two FRFs compared: its features with their errors, and what differs
//! elsewhere.

use frfid_estimate::{Change, EntryComparison, Feature, LevelChange, Sides};
use frfid_signals::format::{plus_minus, significant};

use crate::text::table::{or_dash, row, table};

/// The table of features, whether the entry agrees, and what differs elsewhere.
pub(crate) fn entry_as_text(entry: &EntryComparison) -> String {
    let Sides { a, b } = entry.phase_range_deg;
    let beside = [
        ("below the first feature", entry.mass_lines.below),
        ("above the last", entry.mass_lines.above),
    ];
    let beside = beside.into_iter().filter_map(|(where_, level)| {
        let LevelChange { db, std_db } = level?;
        Some(format!("{where_} {} dB", plus_minus(db, std_db)))
    });
    let beside: Vec<String> = beside.collect();
    let mut text = features(entry);
    text += &format!(
        "  over the band, B/A: median {:+.2} dB, median size {:.2} dB; phase spans {a:.0} deg in A, {b:.0} deg in B\n",
        entry.level_db, entry.difference_db
    );
    if !beside.is_empty() {
        text += &format!("  level B/A: {}\n", beside.join(", "));
    }
    if entry.agreement.agrees().is_some() {
        text += &format!("  {}\n", entry.agreement);
    }
    text
}

/// A row for each resonance and antiresonance: those of A, beside those of B that they moved to,
/// and those that are in B alone.
fn features(entry: &EntryComparison) -> String {
    let title = [
        "",
        "A",
        "B",
        "resolution",
        "shift",
        "damping A",
        "damping B",
        "level B/A",
    ];
    let mut rows = vec![row(title)];
    rows.extend(entry.changes.iter().map(changed));
    rows.extend(entry.only_in_b.iter().map(only_in_b));
    table(&rows)
}

fn changed(change: &Change) -> Vec<String> {
    let shift_std = change.shift_std_percent();
    vec![
        change.a.kind.name().to_owned(),
        in_hz(&change.a),
        or_dash(change.b.as_ref(), in_hz),
        resolution(&change.a, change.b.as_ref()),
        or_dash(change.shift_percent(), |percent| {
            signed(percent, shift_std, "%")
        }),
        or_dash(change.a.damping, |value| {
            damping(value, change.a.damping_std)
        }),
        or_dash(change.b.and_then(|b| b.damping), |value| {
            damping(value, change.b.and_then(|b| b.damping_std))
        }),
        or_dash(change.level_db, |level| {
            signed(level, change.level_std_db, "dB")
        }),
    ]
}

fn only_in_b(feature: &Feature) -> Vec<String> {
    let mut cells = row(["-"; 8]);
    cells[0] = feature.kind.name().to_owned();
    cells[2] = in_hz(feature);
    cells[3] = resolution(feature, None);
    cells[6] = or_dash(feature.damping, |value| damping(value, feature.damping_std));
    cells
}

fn in_hz(feature: &Feature) -> String {
    let number = feature.frequency_std_hz.map_or_else(
        || significant(feature.frequency_hz, 4),
        |std| plus_minus(feature.frequency_hz, std),
    );
    format!("{number} Hz")
}

/// The coarser of the two.
fn resolution(a: &Feature, b: Option<&Feature>) -> String {
    let resolution_hz = b.map_or(a.resolution_hz, |b| b.resolution_hz.max(a.resolution_hz));
    format!("{} Hz", significant(resolution_hz, 2))
}

fn damping(damping: f64, std: Option<f64>) -> String {
    std.map_or_else(|| significant(damping, 4), |std| plus_minus(damping, std))
}

/// A difference with its sign.
fn signed(value: f64, std: Option<f64>, unit: &str) -> String {
    let sign = if value >= 0.0 { "+" } else { "" };
    match std {
        Some(std) => format!("{sign}{} {unit}", plus_minus(value, std)),
        None => format!("{value:+.1} {unit}"),
    }
}
