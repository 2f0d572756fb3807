//! Inspection of a recording as tables: how its groups are sampled, and every signal with what is odd about it.

use frfid_experiment::{GroupLook, Inspection, SignalLook};
use frfid_files::SignalGroup;
use frfid_signals::format::{count, significant};

use crate::text::table::{duration, or_dash, row, table};

/// Groups of fewer rows are no signals over time.
const FEWEST_ROWS: usize = 16;
/// Signals of a group that are listed one by one.
const MOST_SIGNALS: usize = 80;

/// What was found in a recording.
pub(crate) fn inspection_as_text(inspection: &Inspection) -> String {
    let Inspection { listing, looks, .. } = inspection;
    let groups: Vec<(&SignalGroup, &GroupLook)> = listing.groups.iter().zip(looks).collect();
    let n_groups = count(groups.len(), "group");
    let mut text = format!("{}, {n_groups} of signals\n", listing.format);
    let head = row([
        "",
        "type",
        "rows",
        "length",
        "rate",
        "lost",
        "jitter",
        "longest gap",
    ]);
    let rows = groups.iter().map(|(group, look)| sampling(group, look));
    text += &table(&[head].into_iter().chain(rows).collect::<Vec<_>>());
    text += &remarks(&listing.told);
    for (group, look) in groups {
        let is_signal = group.n_rows.is_none_or(|n_rows| n_rows >= FEWEST_ROWS);
        if is_signal && !group.signals.is_empty() {
            text += &format!("{}\n", group.name);
            text += &signals(group, look);
            text += &remarks(&look.told);
            text += &remarks(look.failed.as_slice());
        }
    }
    text
}

/// How a group is sampled.
fn sampling(group: &SignalGroup, look: &GroupLook) -> Vec<String> {
    let step_s = look.sample_time_s;
    let is_read = look.n_samples > 0;
    let rows = group
        .n_rows
        .or(is_read.then_some(look.n_samples - look.n_lost));
    let lost = is_read.then(|| look.n_lost.to_string());
    vec![
        group.name.clone(),
        group.type_name.clone().unwrap_or_default(),
        or_dash(rows, |rows| rows.to_string()),
        or_dash(step_s, |step_s| duration(look.n_samples as f64 * step_s)),
        or_dash(step_s, |step_s| {
            format!("{} Hz", significant(1.0 / step_s, 5))
        }),
        or_dash(lost, |lost| lost),
        or_dash(look.jitter, |jitter| {
            format!("{} %", significant(100.0 * jitter, 2))
        }),
        or_dash(look.longest_gap_s, |gap_s| duration(gap_s)),
    ]
}

/// Every signal with its unit, its range and what is odd about it.
fn signals(group: &SignalGroup, look: &GroupLook) -> String {
    let unit_of = |signal: &SignalLook| {
        let listed = group
            .signals
            .iter()
            .find(|listed| listed.source == signal.source);
        or_dash(listed.and_then(|listed| listed.unit.clone()), |unit| unit)
    };
    let number = |value: Option<f64>| or_dash(value, |value| significant(value, 4));
    let rows = look.signals.iter().take(MOST_SIGNALS).map(|signal| {
        vec![
            format!("  {}", signal.source),
            unit_of(signal),
            number(signal.lowest),
            number(signal.highest),
        ]
    });
    let head = row(["  signal", "unit", "lowest", "highest"]);
    let mut text = table(&[head].into_iter().chain(rows).collect::<Vec<_>>());
    let n_more = look.signals.len().saturating_sub(MOST_SIGNALS);
    text += &if n_more > 0 {
        format!("    and {n_more} more\n")
    } else {
        String::new()
    };
    for signal in &look.signals {
        let odd = signal
            .odd
            .iter()
            .map(|odd| format!("{} {odd}", signal.source));
        text += &remarks(&odd.collect::<Vec<_>>());
    }
    text
}

/// Remarks, a line each.
fn remarks(remarks: &[String]) -> String {
    remarks
        .iter()
        .map(|remark| format!("    ! {remark}\n"))
        .collect()
}
