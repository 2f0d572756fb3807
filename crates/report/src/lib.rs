//! Figures and the HTML report.
//!
//! Plain structs go in, pictures ([`Figure`]: SVG and PNG) and one self-contained HTML page come out. Nothing here reads or
//! writes files; the same inputs give the same bytes.

mod axis;
mod bode;
mod curve;
mod dash;
mod error;
mod figure;
mod legend;
mod panel;
mod payload;
mod phase;
mod report;
mod section6;
mod signals;

pub use bode::{bode, bode_matrix};
pub use curve::{Band, Curve, Labels, Style};
pub use error::ReportError;
pub use figure::Figure;
pub use report::Report;
pub use section6::{Named, section6_figures, section6_report};
pub use signals::{LineRole, SpectralLine, TimePanel, Trace, spectrum, time_series};
