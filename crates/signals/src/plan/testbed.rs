//! The seam between experiments and machines: a reference goes in, a [`Record`] comes out.

use std::fmt;

use ndarray::Array2;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::error::SignalError;
use crate::record::Record;

/// Whether a run carries the excitation or only the constant velocity beneath it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunKind {
    /// Excitation, on the constant velocity if there is one.
    Excitation,
    /// The constant velocity alone, recorded to be subtracted (SK15 section 4.4 E).
    Glide,
}

/// Which run of a plan: all indices from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RunId {
    /// Excitation or glide.
    pub kind: RunKind,
    /// Draw of the random phases (0 for a glide).
    pub realization: usize,
    /// Column of U (0 for a glide).
    pub experiment: usize,
    /// Repetition of the same run.
    pub repetition: usize,
}

/// Readable and fit for a file name: `p003-m1-q0`, `glide-q0`.
impl fmt::Display for RunId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            RunKind::Excitation => write!(
                f,
                "p{:03}-m{}-q{}",
                self.realization, self.experiment, self.repetition
            ),
            RunKind::Glide => write!(f, "glide-q{}", self.repetition),
        }
    }
}

/// One run to be done: what is injected, sample by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Which run of the plan it is; testbeds draw their noise from streams of this name.
    pub id: RunId,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// What is injected, `(channel, sample)`: motor torques in N m in open loop, reference
    /// velocities in rad/s in closed loop (the constant velocity then included).
    pub reference: Array2<f64>,
    /// Constant velocity in rad/s on which the run rides, per channel; zeros where there is none.
    /// The testbed starts at this velocity; in open loop it adds the torque that holds it.
    pub velocity_rad_s: Vec<f64>,
    /// Where the run starts, in rad from the pose, per channel.
    pub start_rad: Vec<f64>,
}

/// A machine on which runs can be done: the simulator, a folder of recordings, or a robot behind
/// somebody's own code.
///
/// `run` may be called from several threads at once; a testbed that can do one run at a time must
/// see to that itself.
pub trait Testbed: Sync {
    /// Number of inputs (channels of the reference).
    fn n_inputs(&self) -> usize;

    /// Does one run and returns what was measured: as many samples as the reference, or fewer if
    /// the run was stopped (then the record's last event says why).
    ///
    /// # Errors
    /// [`TestbedError`].
    fn run(&self, run: &Run) -> Result<Record, TestbedError>;
}

/// Why a testbed could not do a run.
#[derive(Debug, Error)]
pub enum TestbedError {
    /// The run does not fit the testbed.
    #[error(transparent)]
    Run(#[from] SignalError),
    /// The simulation left the numbers: the first quantity that was not finite.
    #[error(
        "run {run}: {quantity} of axis {} is no longer finite at {time_s} s; {}",
        channel + 1,
        lower(*gain_nms_per_rad)
    )]
    Diverged {
        /// The run.
        run: RunId,
        /// Which quantity.
        quantity: &'static str,
        /// Channel, from 0.
        channel: usize,
        /// Time in s after the first sample.
        time_s: f64,
        /// Gain in N m s/rad of that axis' controller, in closed loop.
        gain_nms_per_rad: Option<f64>,
    },
    /// The testbed's own code failed (a file missing, a robot that refused, a Python exception).
    #[error("run {run}: {source}")]
    Foreign {
        /// The run.
        run: RunId,
        /// What the testbed said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

/// What to do about a simulation that left the numbers.
fn lower(gain_nms_per_rad: Option<f64>) -> String {
    match gain_nms_per_rad {
        Some(gain) => format!("the gain of that axis is {gain} N m s/rad: lower the gains"),
        None => "lower the amplitude".into(),
    }
}
