//! Errors of the reproduction: any but an interruption would be a fault of this library.

use frfid_estimate::EstimateError;
use frfid_report::ReportError;
use frfid_signals::SignalError;
use thiserror::Error;

/// Errors of the figures of the paper.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PaperError {
    /// A figure cannot be drawn.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A signal of a figure cannot be analysed.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// A chirp of a figure is impossible.
    #[error(transparent)]
    Signal(#[from] SignalError),
}
