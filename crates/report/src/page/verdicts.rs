//! Verdicts of a report: a row for each cause, a column for each axis.

use frfid_files::{Cell, SOUND, Verdict, VerdictTable};

use crate::page::pieces::{badge, escaped, section, table, table_row};

/// The section, or nothing where nobody judged.
pub(crate) fn verdicts_html(verdicts: &[Verdict]) -> String {
    let Some(VerdictTable { axes, rows, words }) = VerdictTable::of(verdicts) else {
        return String::new();
    };
    let heads: Vec<&str> = ["Share"]
        .into_iter()
        .chain(axes.iter().map(String::as_str))
        .chain(["At most"])
        .collect();
    let shares = rows.iter().map(|(share, cells, limit)| {
        let cells = cells.iter().map(cell_html).chain([escaped(limit)]);
        table_row(share, &cells.collect::<Vec<_>>())
    });
    let words = words.iter().map(|word| word_html(word));
    let words = words.chain([String::new()]); // a verdict has no limit
    let last = [table_row("Verdict", &words.collect::<Vec<_>>())];
    section("Axes", &table(&heads, shares.chain(last)))
}

fn cell_html(cell: &Cell) -> String {
    match (cell.is_beyond, cell.text.as_str()) {
        (true, text) => badge(false, "", text),
        (false, "-") => "not measured".into(),
        (false, text) => escaped(text),
    }
}

fn word_html(word: &str) -> String {
    badge(word == SOUND, word, word)
}
