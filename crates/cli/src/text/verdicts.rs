//! Verdicts of a result as a table, a column for each axis.

use frfid_files::{Cell, Verdict, VerdictTable};

use crate::text::table::table;

/// The table, or nothing where nobody judged.
pub(crate) fn verdicts_as_text(verdicts: &[Verdict]) -> String {
    let Some(VerdictTable { axes, rows, words }) = VerdictTable::of(verdicts) else {
        return String::new();
    };
    let head = [String::new()].into_iter().chain(axes);
    let head = head.chain(["at most".into()]).collect();
    let body = rows.into_iter().map(|(share, cells, limit)| {
        let cells = cells.into_iter().map(marked);
        let row = [share].into_iter().chain(cells);
        row.chain([limit]).collect()
    });
    let last = ["verdict".into()].into_iter().chain(words).collect();
    let all: Vec<Vec<String>> = [head].into_iter().chain(body).chain([last]).collect();
    table(&all)
}

fn marked(cell: Cell) -> String {
    if cell.is_beyond {
        format!("{} !", cell.text)
    } else {
        cell.text
    }
}
