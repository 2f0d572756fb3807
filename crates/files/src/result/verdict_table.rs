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
        let rows = causes.filter_map(|cause| row(verdicts, cause));
        let words = axes.iter().map(|axis| in_words(verdicts, axis)).collect();
        (!verdicts.is_empty()).then(|| Self {
            rows: rows.collect(),
            words,
            axes,
        })
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

fn row(verdicts: &[Verdict], cause: Cause) -> Option<(String, Vec<Cell>, String)> {
    let of_cause = verdicts.iter().filter(|verdict| verdict.cause == cause);
    let limit = of_cause.clone().next()?.limit;
    let cells = of_cause.map(|verdict| Cell {
        text: verdict.found.map_or_else(|| "-".into(), percent),
        is_beyond: verdict.is_beyond(),
    });
    let share = format!("{}, {}", cause.name(), cause.share_of());
    Some((share, cells.collect(), percent(limit)))
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
