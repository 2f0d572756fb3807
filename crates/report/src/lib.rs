//! Figures and the HTML report.
//!
//! Plain structs go in, pictures ([`Figure`]: SVG and PNG) and one self-contained HTML page come
//! out. Nothing here reads or writes files; the same inputs give the same bytes.

mod axis;
mod bode;
mod check;
mod colormap;
mod convergence;
mod curve;
mod dash;
mod error;
mod figure;
mod html;
mod image;
mod legend;
mod panel;
mod paper;
mod part;
mod payload;
mod phase;
mod report;
mod section6;
mod section7;
mod signals;
mod spectrogram;
mod table;

pub use bode::{bode, bode_matrix};
pub use convergence::{Procedure, convergence};
pub use curve::{Band, Curve, Labels, Mark, MarkShape, Style};
pub use error::ReportError;
pub use figure::Figure;
pub use paper::{Named, paper_report};
pub use part::{Part, Responses};
pub use report::Report;
pub use section6::{section6_figures, section6_part};
pub use section7::{section7_figures, section7_part};
pub use signals::{LineRole, SpectralLine, TimePanel, Trace, spectrum, time_series};
pub use spectrogram::{Spectrogram, spectrogram};
pub use table::Table;
