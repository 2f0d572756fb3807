//! Table of verdicts: a row for each cause, a column for each axis, and what each axis is.

use frfid_signals::format::significant;

use crate::result::verdict::{Cause, Verdict};

/// What an axis is where nothing is beyond its limit.
pub const SOUND: &str = "sound";

/// Verdicts as cells of text, for a terminal or a page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VerdictTable {
    /// The axes, the heads of the columns.
    pub axes: Vec<String>,
    /// For every cause: its name and what it is a share of, the cells of the axes, the largest share that is good.
    pub rows: Vec<(String, Vec<Cell>, String)>,
    /// What each axis is, in words.
    pub words: Vec<String>,
}

/// A share in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// The share in per cent, or a dash where it was not measured.
    pub text: String,
    /// Whether it is beyond its limit.
    pub is_beyond: bool,
}

impl VerdictTable {
    /// The table of these verdicts; `None` of none.
    #[must_use]
    pub fn of(verdicts: &[Verdict]) -> Option<Self> {
        let axes = axes(verdicts);
        let causes = Cause::ALL.into_iter();
        let rows = causes
            .filter_map(|cause| row(verdicts, &axes, cause))
            .collect();
        let words = axes.iter().map(|axis| in_words(verdicts, axis)).collect();
        (!verdicts.is_empty()).then_some(Self { rows, words, axes })
    }
}

/// Names of the axes in the order of their first verdict.
fn axes(verdicts: &[Verdict]) -> Vec<String> {
    let mut axes: Vec<String> = Vec::new();
    for verdict in verdicts {
        if !axes.contains(&verdict.axis) {
            axes.push(verdict.axis.clone());
        }
    }
    axes
}

/// The row of a cause; an axis that was not judged for it has a dash.
fn row(verdicts: &[Verdict], axes: &[String], cause: Cause) -> Option<(String, Vec<Cell>, String)> {
    let of_cause = verdicts.iter().filter(|verdict| verdict.cause == cause);
    let mut limits: Vec<String> = of_cause
        .clone()
        .map(|verdict| percent(verdict.limit))
        .collect();
    limits.dedup();
    let cell = |axis: &String| {
        let verdict = of_cause.clone().find(|verdict| verdict.axis == *axis);
        let found = verdict.and_then(|verdict| verdict.found);
        Cell {
            text: found.map_or_else(|| "-".into(), percent),
            is_beyond: verdict.is_some_and(Verdict::is_beyond),
        }
    };
    let share = format!("{}, {}", cause.name(), cause.share_of());
    let cells = axes.iter().map(cell).collect();
    (!limits.is_empty()).then(|| (share, cells, limits.join(", ")))
}

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// What an axis is.
fn in_words(verdicts: &[Verdict], axis: &str) -> String {
    let of_axis = verdicts.iter().filter(|verdict| verdict.axis == axis);
    let beyond = of_axis.filter(|verdict| verdict.is_beyond());
    let words: Vec<&str> = beyond.map(|verdict| verdict.cause.adjective()).collect();
    match words[..] {
        [] => SOUND.into(),
        _ => words.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_its_column_whatever_it_was_judged_for() {
        let verdict = |axis: &str, cause, found, limit| Verdict {
            axis: axis.into(),
            cause,
            found: Some(found),
            limit,
        };
        let verdicts = [
            verdict("a", Cause::Noise, 0.1, 0.3),
            verdict("b", Cause::Noise, 0.4, 0.3),
            verdict("b", Cause::Clipping, 0.0, 0.01),
        ];
        let table = VerdictTable::of(&verdicts).expect("there are some");
        let texts: Vec<Vec<&str>> = table
            .rows
            .iter()
            .map(|(_, cells, _)| cells.iter().map(|cell| cell.text.as_str()).collect())
            .collect();
        assert_eq!(texts, [["10 %", "40 %"], ["-", "0 %"]]);
        assert_eq!(table.words, [SOUND, "noise-limited"]);
    }
}
