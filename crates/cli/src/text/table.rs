//! Text tables, times and amounts for people.

use frfid_signals::format::significant;

/// Rows of cells, columns two spaces apart: the first one flush left, the others flush right.
pub(crate) fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let cells_of = |column: usize| rows.iter().filter_map(move |row| row.get(column));
    let widths = (0..columns).map(|column| width(cells_of(column)));
    let widths: Vec<usize> = widths.collect();
    let mut text = String::new();
    for row in rows {
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            text += &if column == 0 {
                format!("  {cell:width$}")
            } else {
                format!("  {cell:>width$}")
            };
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text
}

/// Wider tables are written row by row.
const MOST_COLUMNS: usize = 100;

/// A table whose first row has the titles; where it is wider than a page, a list for each of the other
/// rows.
pub(crate) fn titled(rows: &[Vec<String>]) -> String {
    let text = table(rows);
    let Some((titles, rows)) = rows.split_first() else {
        return text;
    };
    if width(text.lines()) <= MOST_COLUMNS {
        return text;
    }
    rows.iter().map(|cells| stacked(titles, cells)).collect()
}

/// The cells of a row below each other, behind their titles.
fn stacked(titles: &[String], cells: &[String]) -> String {
    let entries = titles.iter().map(String::as_str).zip(cells.iter().cloned());
    list(&entries.collect::<Vec<_>>()) + "\n"
}

/// Names and values, both flush left.
pub(crate) fn list(entries: &[(&str, String)]) -> String {
    let width = width(entries.iter().map(|(name, _)| name));
    entries
        .iter()
        .map(|(name, value)| format!("  {name:width$}  {value}\n"))
        .collect()
}

/// Every line two blanks in.
pub(crate) fn indented(text: &str) -> String {
    text.lines().map(|line| format!("  {line}\n")).collect()
}

/// Characters of the widest of these texts.
fn width(texts: impl Iterator<Item: AsRef<str>>) -> usize {
    let widths = texts.map(|text| text.as_ref().chars().count());
    widths.max().unwrap_or(0)
}

/// A row of texts that are known beforehand.
pub(crate) fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

/// A value in words, or a dash.
pub(crate) fn or_dash<T>(value: Option<T>, in_words: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".to_owned(), in_words)
}

/// The values of the axes beside each other.
pub(crate) fn side_by_side(values: &[String]) -> String {
    values.join(" | ")
}

/// A time for people: `12.3 s`, `12 min 17 s`, `3 h 5 min`.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..100 => format!("{} s", significant(seconds, 3)),
        100..6000 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

/// An amount of memory for people: `2.4 MB`.
pub(crate) fn bytes(count: f64) -> String {
    let units = [("GB", 1e9), ("MB", 1e6), ("kB", 1e3), ("B", 1.0)];
    let (unit, size) = units
        .into_iter()
        .find(|(_, size)| count >= *size)
        .unwrap_or(units[3]);
    format!("{} {unit}", significant(count / size, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let text = table(&[
            row(["", "peak", "limit"]),
            row(["torque", "150 N m", ""]),
            row(["é", "1", "22222"]),
        ]);
        assert_eq!(
            text,
            "             peak  limit\n  torque  150 N m\n  é             1  22222\n"
        );
    }

    #[test]
    fn a_table_wider_than_a_page_is_written_row_by_row() {
        let narrow = [row(["iteration", "error"]), row(["1", "2"])];
        assert_eq!(titled(&narrow), table(&narrow));
        let six = vec!["12.34"; 20].join(" | ");
        let wide = [
            row(["iteration", "error"]),
            row(["1", &six]),
            row(["2", "-"]),
        ];
        let text = titled(&wide);
        assert_eq!(text.lines().next(), Some("  iteration  1"));
        assert!(
            text.ends_with("\n\n  iteration  2\n  error      -\n\n"),
            "{text}"
        );
    }

    #[test]
    fn times_and_amounts_read_well() {
        assert_eq!(
            [12.288, 737.28, 11_000.0].map(duration),
            ["12.3 s", "12 min 17 s", "3 h 3 min"]
        );
        assert_eq!([0.0, 999.0, 2.36e6].map(bytes), ["0 B", "999 B", "2.36 MB"]);
    }
}
