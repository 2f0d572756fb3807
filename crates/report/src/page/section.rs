//! Part of a report: paragraphs, tables, an interactive diagram and figures.

use crate::diagrams::curve::Curve;
use crate::diagrams::labels::Labels;
use crate::figure::Figure;
use crate::page::pieces::{escaped, section, table};
use crate::page::table::Table;

/// FRFs of equal size to look into: an interactive matrix of Bode diagrams.
#[derive(Debug, Clone)]
pub struct Responses<'a> {
    /// Title above the diagram.
    pub title: String,
    /// The FRFs.
    pub curves: Vec<Curve<'a>>,
    /// Names of their channels and the unit of the gain.
    pub labels: Labels,
    /// The same with its caption, where the diagram cannot be used: in print and without scripts.
    pub still: Option<(String, Figure)>,
}

/// One part of a report; what is empty is left out.
#[derive(Debug, Clone, Default)]
pub struct Part<'a> {
    /// Title.
    pub title: String,
    /// Paragraphs of plain text.
    pub notes: Vec<String>,
    /// Tables.
    pub tables: Vec<Table>,
    /// FRFs to look into.
    pub responses: Option<Responses<'a>>,
    /// Pictures with their captions.
    pub figures: Vec<(String, Figure)>,
}

impl Part<'_> {
    /// The part as HTML.
    pub(crate) fn html(&self) -> String {
        let notes = self.notes.iter().map(|note| note_html(note));
        let tables = self.tables.iter().map(table_html);
        let responses = self.responses.iter().map(responses_html);
        let figures = self.figures.iter().map(figure_html);
        let content: String = notes
            .chain(responses)
            .chain(figures)
            .chain(tables)
            .collect();
        section(&self.title, &content)
    }
}

fn note_html(note: &str) -> String {
    format!("<p>{}</p>\n", escaped(note))
}

/// A table below its title.
fn table_html(content: &Table) -> String {
    let columns: Vec<&str> = content.columns.iter().map(String::as_str).collect();
    let rows = content.rows.iter().map(|(name, cells)| {
        let cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        (name.clone(), cells)
    });
    let (title, table) = (escaped(&content.title), table(&columns, rows));
    format!("<h3>{title}</h3>\n{table}")
}

/// The frame that the page's script fills with an interactive diagram.
fn responses_html(responses: &Responses) -> String {
    let (title, unit) = (
        escaped(&responses.title),
        escaped(&responses.labels.gain_unit),
    );
    let still = responses.still.iter().map(figure_html);
    let still = still.map(|figure| format!("<div class=\"still\">{figure}</div>\n"));
    format!(
        include_str!("web/responses.html"),
        title = title,
        unit = unit,
        still = still.collect::<String>(),
        kind = if responses.still.is_some() {
            " has-still"
        } else {
            ""
        },
    )
}

/// A text within a `data:` URL in quotes: a quarter shorter than base64.
fn in_url(text: &str) -> String {
    let mut url = String::with_capacity(text.len() + text.len() / 16);
    for letter in text.chars() {
        match letter {
            '%' | '#' | '<' | '>' | '"' | '\'' | '&' | '\n' | '\r' | '\t' => {
                url += &format!("%{:02X}", u32::from(letter));
            }
            _ => url.push(letter),
        }
    }
    url
}

/// A picture as an image: it cannot run scripts, and the ids inside one cannot meet those of
/// another.
fn figure_html((caption, figure): &(String, Figure)) -> String {
    let (image, caption) = (in_url(&figure.svg()), escaped(caption));
    format!(
        "<figure><img src=\"data:image/svg+xml;charset=utf-8,{image}\" alt=\"{caption}\">\
         <figcaption>{caption}</figcaption></figure>\n"
    )
}
