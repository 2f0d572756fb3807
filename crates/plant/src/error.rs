//! Errors of plants, controllers and simulations.

use frfid_signals::{RunId, SignalError, TestbedError};
use thiserror::Error;

/// Errors of the `plant` crate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlantError {
    /// A parameter or an array does not fit.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// Samples say nothing about the torque between them unless a hold does.
    #[error(
        "a sampled torque cannot be simulated with hold \"continuous\"; needed: \"zoh\" or \"linear\" (or a torque given as a function of time)"
    )]
    NoHold,
    /// What is not piecewise linear cannot be simulated by exact steps.
    #[error(
        "the exact integrator needs a single joint without torque ripple, its torque held or a straight line between samples: {found}; use integrator = \"rk4\""
    )]
    NotExact {
        /// What stands in the way.
        found: &'static str,
    },
    /// The simulation diverged.
    #[error("{quantity} of axis {} is no longer finite at {time_s} s; lower the amplitude or the gains", channel + 1)]
    Diverged {
        /// The first quantity that was not finite.
        quantity: &'static str,
        /// Channel, from 0.
        channel: usize,
        /// Time in s after the first sample.
        time_s: f64,
    },
    /// The linear loop of robot, sensors and controller has a pole outside the unit circle.
    #[error(
        "unstable gains: spectral radius {spectral_radius:.6} at {hz:.3} Hz; {} of axis {} ({gain_nms_per_rad} N m s/rad)",
        if *hz > 0.0 { "lower the gain" } else { "it drifts away: raise the integral or position gain, or lower the gain" },
        channel + 1
    )]
    Unstable {
        /// Largest magnitude of a pole: the growth per sample.
        spectral_radius: f64,
        /// Frequency of that pole in Hz.
        hz: f64,
        /// The axis whose controller feeds the growing motion most, from 0.
        channel: usize,
        /// Its proportional gain in N m s/rad.
        gain_nms_per_rad: f64,
    },
    /// Modes changed too often within one step of the integrator.
    #[error(
        "more than {limit} changes between stick, slip and the branches of the spring within one step at {time_s:.4} s; lower the controller's gains if there is one, or lower max_step_s"
    )]
    Chatter {
        /// Number of changes allowed in a step.
        limit: usize,
        /// Time in s after the first sample.
        time_s: f64,
    },
}

impl PlantError {
    /// The same error as a testbed reports it, with the run in which it happened and the gains in N
    /// m s/rad of the axes' controllers, if there are any.
    #[must_use]
    pub fn in_run(self, run: RunId, gains: &[f64]) -> TestbedError {
        match self {
            Self::Signal(error) => TestbedError::Run(error),
            Self::Diverged {
                quantity,
                channel,
                time_s,
            } => {
                let gain_nms_per_rad = gains.get(channel).copied();
                TestbedError::Diverged {
                    run,
                    quantity,
                    channel,
                    time_s,
                    gain_nms_per_rad,
                }
            }
            error @ (Self::NoHold
            | Self::NotExact { .. }
            | Self::Unstable { .. }
            | Self::Chatter { .. }) => TestbedError::Foreign {
                run,
                source: Box::new(error),
            },
        }
    }
}
