//! Verdicts of a report: a row for each cause, a column for each axis.

use std::iter::zip;

use frfid_files::{Cell, SOUND, Verdict, VerdictTable};

use crate::page::pieces::{badge, escaped, section, table};

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
        ((*share).to_string(), cells.collect())
    });
    let words = words.iter().map(|word| word_html(word));
    let words = words.chain([String::new()]); // a verdict has no limit
    let last = [("Verdict".to_owned(), words.collect())];
    section("Axes", &table(&heads, shares.chain(last)))
}

/// What the axes suffer from, a line for those that suffer alike, or nothing where nobody judged.
pub(crate) fn verdict_lines(verdicts: &[Verdict]) -> String {
    let Some(VerdictTable { axes, words, .. }) = VerdictTable::of(verdicts) else {
        return String::new();
    };
    let mut groups: Vec<(&String, Vec<String>)> = Vec::new();
    for (word, axis) in zip(&words, &axes) {
        match groups.iter_mut().find(|(known, _)| *known == word) {
            Some((_, axes)) => axes.push(escaped(axis)),
            None => groups.push((word, vec![escaped(axis)])),
        }
    }
    let lines = groups.iter();
    let lines =
        lines.map(|(word, axes)| format!("<p>{} {}</p>\n", axes.join(", "), word_html(word)));
    lines.collect()
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
