//! The report of the paper: its sections one after the other, below the table of claims.

use frfid_experiment::Claim;

use crate::{Figure, Part, Report};

/// A figure with its file name (without ending) and its caption.
#[derive(Debug, Clone)]
pub struct Named {
    /// File name without ending.
    pub name: &'static str,
    /// Caption.
    pub caption: String,
    /// The figure.
    pub figure: Figure,
}

impl Named {
    /// The figure as a part of a report has it.
    pub(crate) fn captioned(&self) -> (String, Figure) {
        (self.caption.clone(), self.figure.clone())
    }
}

/// The report of the paper from its sections and the claims of them all.
#[must_use]
pub fn paper_report(parts: Vec<Part<'_>>, claims: Vec<Claim>) -> Report<'_> {
    let source = "F. Saupe, A. Knoblach, MSSP 52-53 (2015) 60-72, doi:10.1016/j.ymsp.2014.08.011";
    Report {
        title: "Saupe and Knoblach (2015): frequency responses of flexible-joint robots".into(),
        claims,
        checks: Vec::new(),
        parts,
        provenance: vec![
            ("frfid".into(), env!("CARGO_PKG_VERSION").into()),
            ("source".into(), source.into()),
        ],
    }
}
