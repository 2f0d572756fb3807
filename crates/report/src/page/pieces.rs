//! Pieces of HTML. Whatever comes from outside is shown as text.

use std::iter;

/// A section, or nothing where there is nothing to show. `title` is plain text.
pub(crate) fn section(title: &str, content: &str) -> String {
    let title = escaped(title);
    if content.is_empty() {
        String::new()
    } else {
        format!("<section>\n<h2>{title}</h2>\n{content}</section>\n")
    }
}

/// A row of a table: its name as plain text, its cells as HTML.
pub(crate) type Row = (String, Vec<String>);

/// What is folded away below a line of plain text, or nothing where there is nothing to show.
pub(crate) fn folded(summary: &str, content: &str) -> String {
    let summary = escaped(summary);
    if content.is_empty() {
        String::new()
    } else {
        format!("<details>\n<summary>{summary}</summary>\n{content}</details>\n")
    }
}

/// A table, or nothing without rows. Columns are plain text, that of the rows' names first. Where
/// there is little width, each cell stands below the last with its column before it.
pub(crate) fn table(columns: &[&str], rows: impl Iterator<Item = Row>) -> String {
    let rows: String = rows.map(|row| table_row(columns, &row)).collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = table_head(columns);
    format!("<div class=\"scroll\"><table>\n{head}<tbody>\n{rows}</tbody></table></div>\n")
}

/// The heads of a table's columns, or nothing without columns.
fn table_head(columns: &[&str]) -> String {
    if columns.is_empty() {
        return String::new();
    }
    let names = columns.iter().map(|name| escaped(name));
    let cells: String = names
        .map(|name| format!("<th scope=\"col\">{name}</th>"))
        .collect();
    format!("<thead><tr>{cells}</tr></thead>\n")
}

/// A row, its cells with the heads of their columns.
fn table_row(columns: &[&str], (name, cells): &Row) -> String {
    let heads = columns.iter().skip(1).chain(iter::repeat(&""));
    let cells = cells.iter().zip(heads).map(|(cell, head)| match *head {
        "" => format!("<td>{cell}</td>"),
        head => format!("<td data-head=\"{}\">{cell}</td>", escaped(head)),
    });
    let cells: String = cells.collect();
    format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", escaped(name))
}

/// Good or bad news in a word, told apart by sign as well as colour.
pub(crate) fn badge(good: bool, yes: &str, no: &str) -> String {
    let (class, sign, word) = if good {
        ("good", '✓', yes)
    } else {
        ("bad", '✗', no)
    };
    format!(
        "<span class=\"{class}\">{sign}\u{a0}{}</span>",
        escaped(word)
    )
}

/// Text as HTML shows it literally, in content and in quoted attributes.
pub(crate) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\0' => safe.push('\u{fffd}'),
            other => safe.push(other),
        }
    }
    safe
}

/// Puts values into the `{{places}}` of a template, in one pass: braces in the values stay as they
/// are.
pub(crate) fn filled(template: &str, value: impl Fn(&str) -> String) -> String {
    let mut pieces = template.split("{{");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        match piece.split_once("}}") {
            Some((name, rest)) => {
                text.push_str(&value(name));
                text.push_str(rest);
            }
            None => text.push_str(piece),
        }
    }
    text
}
