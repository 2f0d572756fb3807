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
    let groups = || listing.groups.iter().zip(looks);
    let n_groups = count(listing.groups.len(), "group");
    let mut text = format!("{}, {n_groups} of signals\n", listing.format);
    let rows = groups().map(|(group, look)| sampling(group, look));
    text += &table(
        &[sampling_head()]
            .into_iter()
            .chain(rows)
            .collect::<Vec<_>>(),
    );
    text += &remarks(&listing.told);
    text.extend(groups().map(|(group, look)| in_detail(group, look)));
    if inspection.has_no_signal() {
        text += "no signal in it: nothing that is a number over time\n";
    }
    text
}

fn sampling_head() -> Vec<String> {
    row([
        "",
        "type",
        "rows",
        "length",
        "rate",
        "lost",
        "jitter",
        "longest gap",
    ])
}

/// How a group is sampled.
fn sampling(group: &SignalGroup, look: &GroupLook) -> Vec<String> {
    let step_s = look.sample_time_s;
    let read = Some(look).filter(|look| look.n_samples > 0);
    let rows = group
        .n_rows
        .or(read.map(|look| look.n_samples - look.n_lost));
    vec![
        group.name.clone(),
        group.type_name.clone().unwrap_or_default(),
        or_dash(rows, |rows| rows.to_string()),
        or_dash(step_s, |step_s| duration(look.n_samples as f64 * step_s)),
        or_dash(step_s, |step_s| {
            format!("{} Hz", significant(1.0 / step_s, 5))
        }),
        or_dash(read, |look| look.n_lost.to_string()),
        or_dash(look.jitter, |jitter| {
            format!("{} %", significant(100.0 * jitter, 2))
        }),
        or_dash(look.longest_gap_s, duration),
    ]
}

/// The signals of a group that is long enough to have any.
fn in_detail(group: &SignalGroup, look: &GroupLook) -> String {
    let is_signal = group.n_rows.is_none_or(|n_rows| n_rows >= FEWEST_ROWS);
    if !is_signal || group.signals.is_empty() {
        return String::new();
    }
    let odd = look.signals.iter().flat_map(odd_words);
    let told = odd
        .chain(look.told.iter().cloned())
        .chain(look.failed.clone());
    let told: Vec<String> = told.collect();
    format!("{}\n{}{}", group.name, signals(group, look), remarks(&told))
}

/// Every signal with its unit and its range, or the first of many.
fn signals(group: &SignalGroup, look: &GroupLook) -> String {
    let shown = look.signals.iter().take(MOST_SIGNALS);
    let rows = shown.map(|signal| signal_row(group, signal));
    let head = row(["  signal", "unit", "lowest", "highest"]);
    let text = table(&[head].into_iter().chain(rows).collect::<Vec<_>>());
    match look.signals.len().saturating_sub(MOST_SIGNALS) {
        0 => text,
        n_more => format!("{text}    and {n_more} more\n"),
    }
}

fn signal_row(group: &SignalGroup, signal: &SignalLook) -> Vec<String> {
    let mut listed = group.signals.iter();
    let listed = listed.find(|listed| listed.source == signal.source);
    let number = |value: Option<f64>| or_dash(value, |value| significant(value, 4));
    vec![
        format!("  {}", signal.source),
        or_dash(listed.and_then(|listed| listed.unit.clone()), |unit| unit),
        number(signal.lowest),
        number(signal.highest),
    ]
}

/// What is odd about a signal.
fn odd_words(signal: &SignalLook) -> impl Iterator<Item = String> {
    let odd = signal.odd.iter();
    odd.map(|odd| format!("{} {odd}", signal.source))
}

/// Remarks, a line each.
fn remarks(remarks: &[String]) -> String {
    let lines = remarks.iter().map(|remark| format!("    ! {remark}\n"));
    lines.collect()
}
