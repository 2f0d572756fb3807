//! Errors of a shaping.

use std::error::Error;

use frfid_signals::{Excess, SignalError, TestbedError};
use thiserror::Error;

use crate::error::EstimateError;

/// Errors of iterative shaping. Channels and experiments count from 0, iterations from 1.
#[derive(Debug, Error)]
pub enum ShapeError {
    /// Options, signals or records that are wrong in themselves, or a response that cannot be
    /// inverted.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// A run could not be done.
    #[error(transparent)]
    Testbed(#[from] TestbedError),
    /// The initial reference already exceeds a limit.
    #[error(
        "the initial reference asks axis {} for a {} in {} of {:.4}, the limit is {:.4}; start with a smaller amplitude",
        .0.axis + 1, .0.limit.quantity(), .0.limit.unit(), .0.found, .0.allowed
    )]
    StartTooLarge(
        /// The limit and the peak of the initial reference.
        Excess,
    ),
    /// The first iteration exceeded a limit or was stopped: there is nothing to go back to.
    #[error(
        "the initial reference was too much for the machine: {reason}; start with a smaller amplitude"
    )]
    FirstTooMuch {
        /// What happened first.
        reason: String,
    },
    /// The target does not follow the reference.
    #[error(
        "the {target} of axis {} does not respond to the reference, the coherence in the band is {coherence:.2}, \
         at least {needed} is needed; is the loop closed, the channel order right, the reference strong enough for noise and friction?",
        axis + 1
    )]
    NoResponse {
        /// Name of the target.
        target: &'static str,
        /// Axis, from 0.
        axis: usize,
        /// Share of the target's power in the band that the references explain.
        coherence: f64,
        /// Share needed.
        needed: f64,
    },
    /// [`crate::shape::shaper::Shaper::finish`] before the first iteration was measured.
    #[error("nothing has been measured yet, at least one iteration is needed")]
    NothingMeasured,
    /// The watcher of the iterations failed.
    #[error(transparent)]
    Watch(Box<dyn Error + Send + Sync>),
}

impl From<SignalError> for ShapeError {
    fn from(error: SignalError) -> Self {
        Self::Estimate(error.into())
    }
}
