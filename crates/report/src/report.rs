//! The report: one HTML file that needs no network, for a browser or for print.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use frfid_experiment::Claim;
use frfid_files::Check;
use sha2::{Digest, Sha256};

use crate::curve::{self, Curve, Labels};
use crate::{Figure, ReportError, payload};

const TEMPLATE: &str = include_str!("page/report.html");
const STYLE: &str = include_str!("page/report.css");
const SCRIPT: &str =
    concat!(include_str!("page/curves.js"), include_str!("page/draw.js"), include_str!("page/controls.js"));

/// Everything a report shows; what is empty is left out.
#[derive(Debug, Clone)]
pub struct Report<'a> {
    /// Title of the page.
    pub title: String,
    /// FRFs of equal size for the interactive Bode matrix.
    pub curves: Vec<Curve<'a>>,
    /// Names of their channels and the unit of the gain.
    pub labels: Labels,
    /// What was checked.
    pub checks: Vec<Check>,
    /// Where the results come from: names and values (versions, seeds, hashes, files).
    pub provenance: Vec<(String, String)>,
    /// Claims of the paper beside our numbers.
    pub claims: Vec<Claim>,
    /// Pictures with their captions.
    pub figures: Vec<(String, Figure)>,
    /// Paragraphs of plain text.
    pub notes: Vec<String>,
}

impl Report<'_> {
    /// The report as a self-contained HTML page.
    ///
    /// The page loads nothing and, by its content security policy, could not; its tables and figures also work without
    /// scripts. Every string is shown as text, whatever it holds.
    ///
    /// # Errors
    /// [`ReportError`] if the curves differ in size, `labels` does not fit them, or a frequency is not above zero.
    pub fn html(&self) -> Result<String, ReportError> {
        if !self.curves.is_empty() {
            curve::check("the report", &self.curves, &self.labels)?;
        }
        // Browsers hash what they parsed, with line feeds only.
        let (style, script) = (STYLE.replace('\r', ""), SCRIPT.replace('\r', ""));
        Ok(filled(TEMPLATE, |name| match name {
            "title" => escaped(&self.title),
            "version" => env!("CARGO_PKG_VERSION").to_owned(),
            "style_hash" => hash(&style),
            "script_hash" => hash(&script),
            "style" => style.clone(),
            "script" => script.clone(),
            "data" => payload::json(&self.curves, &self.labels),
            "verdict" => self.verdict(),
            "claims" => self.claims(),
            "responses" => self.responses(),
            "figures" => self.figures(),
            "checks" => self.checks(),
            "notes" => self.notes(),
            "provenance" => self.provenance(),
            other => unreachable!("the template has no place {other}"),
        }))
    }

    fn verdict(&self) -> String {
        let mut text = String::new();
        let mut count = |all: usize, good: usize, what: &str| {
            if all > 0 {
                let class = if all == good { "good" } else { "bad" };
                text.push_str(&format!("<p><span class=\"{class}\">{good} of {all}</span> {what}</p>\n"));
            }
        };
        count(self.claims.len(), self.claims.iter().filter(|row| row.holds).count(), "claims of the paper hold");
        count(self.checks.len(), self.checks.iter().filter(|row| row.passed).count(), "checks passed");
        text
    }

    fn claims(&self) -> String {
        let rows = self.claims.iter().map(|row| {
            let verdict = badge(row.holds, "holds", "does not hold");
            table_row(&format!("{} {}", row.id, row.statement), &[escaped(row.expected), escaped(&row.found), verdict])
        });
        table("Claims", &["Claim", "Expected (the paper in quotation marks)", "Found", "Verdict"], rows)
    }

    fn checks(&self) -> String {
        let rows = self.checks.iter().map(|row| {
            let verdict = badge(row.passed, "passed", "failed");
            table_row(
                &row.name,
                &[
                    verdict,
                    escaped(&row.found),
                    escaped(&row.needed),
                    escaped(if row.passed { "" } else { &row.advice }),
                ],
            )
        });
        table("Checks", &["Check", "Verdict", "Found", "Needed", "Advice"], rows)
    }

    fn provenance(&self) -> String {
        let rows = self.provenance.iter().map(|(name, value)| table_row(name, &[escaped(value)]));
        table("Provenance", &[], rows)
    }

    fn responses(&self) -> String {
        if self.curves.is_empty() {
            return String::new();
        }
        format!(include_str!("page/responses.html"), unit = escaped(&self.labels.gain_unit))
    }

    fn figures(&self) -> String {
        let mut text = String::new();
        for (caption, figure) in &self.figures {
            // An image cannot run scripts, and the ids inside one cannot meet those of another.
            let (image, caption) = (STANDARD.encode(figure.svg()), escaped(caption));
            text.push_str(&format!(
                "<figure><img src=\"data:image/svg+xml;base64,{image}\" alt=\"{caption}\">\
                 <figcaption>{caption}</figcaption></figure>\n"
            ));
        }
        section("Figures", &text)
    }

    fn notes(&self) -> String {
        let text: String = self.notes.iter().map(|note| format!("<p>{}</p>\n", escaped(note))).collect();
        section("Notes", &text)
    }
}

/// A section, or nothing where there is nothing to show.
fn section(title: &str, content: &str) -> String {
    if content.is_empty() { String::new() } else { format!("<section>\n<h2>{title}</h2>\n{content}</section>\n") }
}

fn table(title: &str, columns: &[&str], rows: impl Iterator<Item = String>) -> String {
    let rows: String = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    let head: String = columns.iter().map(|name| format!("<th scope=\"col\">{name}</th>")).collect();
    let head = if head.is_empty() { head } else { format!("<thead><tr>{head}</tr></thead>\n") };
    section(title, &format!("<div class=\"scroll\"><table>\n{head}<tbody>\n{rows}</tbody></table></div>\n"))
}

/// A row of a table: its name as plain text, its cells as HTML.
fn table_row(name: &str, cells: &[String]) -> String {
    let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
    format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", escaped(name))
}

fn badge(good: bool, yes: &str, no: &str) -> String {
    let (class, sign, word) = if good { ("good", '✓', yes) } else { ("bad", '✗', no) };
    format!("<span class=\"{class}\">{sign} {word}</span>")
}

/// Text as HTML shows it literally, in content and in quoted attributes.
fn escaped(text: &str) -> String {
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

/// The source expression that lets one inline style or script through a content security policy.
fn hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}

/// Puts values into the `{{places}}` of a template, in one pass: braces in the values stay as they are.
fn filled(template: &str, value: impl Fn(&str) -> String) -> String {
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
