//! Page of a report: one HTML file that needs no network, for a browser or for print.

pub(crate) mod claim;
mod levels;
pub(crate) mod of_plan;
pub(crate) mod of_result;
pub(crate) mod payload;
pub(crate) mod pieces;
mod provenance;
pub(crate) mod section;
pub(crate) mod table;
mod verdicts;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use frfid_files::{Check, Verdict};
use sha2::{Digest, Sha256};

use crate::diagrams::validation::check_curves;
use crate::error::ReportError;
use crate::page::claim::Claim;
use crate::page::pieces::{badge, escaped, filled, section, table};
use crate::page::provenance::provenance_html;
use crate::page::section::{Part, Responses};
use crate::page::verdicts::{verdict_lines, verdicts_html};

const TEMPLATE: &str = include_str!("web/report.html");
const STYLE: &str = include_str!("web/report.css");
/// One function for each diagram of the page, so that several do not meet.
const SCRIPT: &str = concat!(
    "\"use strict\";\nfunction responses(root, data) {\n",
    include_str!("web/curves.js"),
    include_str!("web/draw.js"),
    include_str!("web/readout.js"),
    include_str!("web/controls.js"),
    "}\n",
    include_str!("web/start.js")
);

/// Everything a report shows; what is empty is left out.
#[derive(Debug, Clone, Default)]
pub struct Report<'a> {
    /// Title of the page.
    pub title: String,
    /// What is seen first, before every table.
    pub lead: Option<Part<'a>>,
    /// Claims of the paper beside our numbers.
    pub claims: Vec<Claim>,
    /// What each axis suffers from.
    pub verdicts: Vec<Verdict>,
    /// What was checked.
    pub checks: Vec<Check>,
    /// The parts, one after the other.
    pub parts: Vec<Part<'a>>,
    /// Where the results come from: names and values (versions, seeds, hashes, files).
    pub provenance: Vec<(String, String)>,
}

impl Report<'_> {
    /// The report as a self-contained HTML page.
    ///
    /// The page loads nothing and, by its content security policy, could not; its tables and
    /// figures also work without scripts. Every string is shown as text, whatever it holds.
    ///
    /// # Errors
    /// [`ReportError`] if the curves of a part differ in size, their labels do not fit, or a
    /// frequency is not above zero.
    pub fn html(&self) -> Result<String, ReportError> {
        let parts = self.lead.iter().chain(&self.parts);
        let responses: Vec<&Responses> = parts.filter_map(|part| part.responses.as_ref()).collect();
        for Responses { curves, labels, .. } in &responses {
            check_curves("the report", curves, labels)?;
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
            "data" => payload::json(&responses),
            "verdict" => self.verdict(),
            "lead" => self.lead.iter().map(Part::html).collect(),
            "claims" => self.claims(),
            "axes" => verdicts_html(&self.verdicts),
            "checks" => self.checks(),
            "parts" => self.parts.iter().map(Part::html).collect(),
            "provenance" => provenance_html(&self.provenance),
            other => unreachable!("the template has no place {other}"),
        }))
    }

    /// How many claims hold and how many checks passed, those that failed, and the verdict on each
    /// axis.
    fn verdict(&self) -> String {
        let claims = self.claims.iter().map(|row| row.holds);
        let checks = self.checks.iter().map(|row| row.passed);
        let failed = self.checks.iter().filter(|row| !row.passed);
        let failed = failed.map(|Check { name, found, .. }| {
            let sign = badge(false, "", name);
            format!("<p>{sign}: {}</p>\n", escaped(found))
        });
        [
            count(claims, "claims of the paper hold"),
            count(checks, "checks passed"),
            failed.collect(),
            verdict_lines(&self.verdicts),
        ]
        .concat()
    }

    /// The table of claims.
    fn claims(&self) -> String {
        let rows = self.claims.iter().map(|row| {
            let verdict = badge(row.holds, "holds", "does not hold");
            let cells = [escaped(row.expected), escaped(&row.found), verdict];
            (format!("{} {}", row.id, row.statement), cells.to_vec())
        });
        let expected = "Expected (the paper in quotation marks)";
        section(
            "Claims",
            &table(&["Claim", expected, "Found", "Verdict"], rows),
        )
    }

    /// The table of checks.
    fn checks(&self) -> String {
        let rows = self.checks.iter().map(|row| {
            let advice = if row.passed { "" } else { &row.advice };
            let [found, needed, advice] = [&row.found, &row.needed, advice].map(escaped);
            let verdict = badge(row.passed, "passed", "failed");
            (row.name.clone(), vec![verdict, found, needed, advice])
        });
        let columns = ["Check", "Verdict", "Found", "Needed", "Advice"];
        section("Checks", &table(&columns, rows))
    }
}

/// How many are good of how many, or nothing where there are none.
fn count(are_good: impl ExactSizeIterator<Item = bool>, what: &str) -> String {
    let all = are_good.len();
    if all == 0 {
        return String::new();
    }
    let good = are_good.filter(|is_good| *is_good).count();
    let class = if all == good { "good" } else { "bad" };
    format!("<p><span class=\"{class}\">{good} of {all}</span> {what}</p>\n")
}

/// The source expression that lets one inline style or script through a content security policy.
fn hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}
