//! Figures and the HTML report.
//!
//! Plain structs go in, pictures ([`Figure`]: SVG and PNG) and one self-contained HTML page come
//! out. Nothing here reads or writes files; the same inputs give the same bytes.

/// Diagrams: an FRF, a spectrogram, signals over time, the convergence of a shaping.
mod diagrams {
    pub(crate) mod bode;
    pub(crate) mod convergence;
    pub(crate) mod curve;
    pub(crate) mod distortion;
    pub(crate) mod harmonics;
    pub(crate) mod labels;
    pub(crate) mod mark;
    pub(crate) mod over_frequency;
    pub(crate) mod spectrogram;
    pub(crate) mod spectrum;
    pub(crate) mod style;
    pub(crate) mod time_series;
    pub(crate) mod validation;
}
mod error;
mod figure;
mod page;
mod validation;

pub use diagrams::bode::{bode, bode_matrix};
pub use diagrams::convergence::{Procedure, convergence};
pub use diagrams::curve::{Band, Curve};
pub use diagrams::labels::Labels;
pub use diagrams::mark::{Mark, MarkShape};
pub use diagrams::spectrogram::{Spectrogram, spectrogram};
pub use diagrams::spectrum::{LineRole, SpectralLine, spectrum};
pub use diagrams::style::{Style, Swatch};
pub use diagrams::time_series::{TimePanel, Trace, time_series};
pub use error::ReportError;
pub use figure::Figure;
pub use page::Report;
pub use page::claim::Claim;
pub use page::of_plan::{PLAN_PAGE, plan_page};
pub use page::of_result::{result_figure, result_page, results_page};
pub use page::section::{Part, Responses};
pub use page::table::Table;
