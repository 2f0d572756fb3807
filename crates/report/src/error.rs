//! Errors of figures and reports.

use frfid_signals::SignalError;
use thiserror::Error;

/// Errors of the `report` crate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ReportError {
    /// A figure was asked for without anything to draw.
    #[error("{figure} has no {missing}; give at least one")]
    Empty {
        /// The figure.
        figure: &'static str,
        /// What it lacks.
        missing: &'static str,
    },
    /// An entry that a curve does not have.
    #[error(
        "curve \"{curve}\" is {outputs} x {inputs} (outputs x inputs), entry (output {output}, input {input}) was asked for; entries count from 0"
    )]
    NoSuchEntry {
        /// The curve's label.
        curve: String,
        /// Its outputs.
        outputs: usize,
        /// Its inputs.
        inputs: usize,
        /// The output asked for.
        output: usize,
        /// The input asked for.
        input: usize,
    },
    /// Curves or labels of different sizes in one figure.
    #[error(
        "{what} is {found_outputs} x {found_inputs} (outputs x inputs), the figure needs {outputs} x {inputs}"
    )]
    Size {
        /// What does not fit.
        what: String,
        /// Its outputs.
        found_outputs: usize,
        /// Its inputs.
        found_inputs: usize,
        /// Outputs of the figure.
        outputs: usize,
        /// Inputs of the figure.
        inputs: usize,
    },
    /// Results of different channels in one picture.
    #[error(
        "{result} is an FRF from {found}, {first} one from {needed}; needed: the same channels with the same units in the same order; make a page of each"
    )]
    Channels {
        /// The result.
        result: String,
        /// Its channels.
        found: String,
        /// The first result.
        first: String,
        /// Its channels.
        needed: String,
    },
    /// Lists that must be of equal length are not.
    #[error("{what} has {found} values, needed {needed}")]
    Length {
        /// The list.
        what: String,
        /// Its length.
        found: usize,
        /// The length needed.
        needed: usize,
    },
    /// A value outside its range.
    #[error("{what} is {found}, needed {needed}")]
    Value {
        /// Name of the value, unit included.
        what: String,
        /// The value.
        found: f64,
        /// The range.
        needed: &'static str,
    },
    /// An FRF whose arrays do not fit together.
    #[error(transparent)]
    Frf(#[from] SignalError),
    /// The picture could not be turned into pixels.
    #[error("PNG: {0}")]
    Png(String),
}

impl ReportError {
    /// A figure without anything to draw.
    pub(crate) fn empty(figure: &'static str, missing: &'static str) -> Self {
        Self::Empty { figure, missing }
    }
}
