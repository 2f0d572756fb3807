//! Run of a plan: its name, and what it injects sample by sample.

use std::fmt;

use ndarray::{Array1, Array2, ArrayView1};
use serde::{Deserialize, Serialize};

use crate::excitation::Injection;
use crate::peaks::steepest;

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

impl RunId {
    /// An excited run: draw of the phases, column of U, repetition.
    #[must_use]
    pub fn excitation(realization: usize, experiment: usize, repetition: usize) -> Self {
        let kind = RunKind::Excitation;
        Self {
            kind,
            realization,
            experiment,
            repetition,
        }
    }

    /// A glide.
    #[must_use]
    pub fn glide(repetition: usize) -> Self {
        let kind = RunKind::Glide;
        Self {
            kind,
            realization: 0,
            experiment: 0,
            repetition,
        }
    }
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
    /// Constant velocity in rad/s beneath the run, per channel; zeros where there is none.
    /// The testbed starts at this velocity; in open loop it adds the torque that holds it.
    pub velocity_rad_s: Vec<f64>,
    /// Where the run starts, in rad from the pose, per channel.
    pub start_rad: Vec<f64>,
}

impl Run {
    /// Largest rate of the reference of every channel, in its unit per s: from sample to sample, and
    /// from the rest before the first to it and from the last to the rest after it. Rest is no
    /// torque, or the constant velocity.
    #[must_use]
    pub fn steepest_per_s(&self, injection: Injection) -> Vec<f64> {
        let rests = self.velocity_rad_s.iter().map(|velocity| match injection {
            Injection::Torque => 0.0,
            Injection::Velocity => *velocity,
        });
        let channels = self.reference.rows().into_iter().zip(rests);
        channels
            .map(|(row, rest)| steepest_from(rest, row) / self.sample_time_s)
            .collect()
    }
}

/// Largest change from sample to sample, with a rest before and after.
fn steepest_from(rest: f64, row: ArrayView1<f64>) -> f64 {
    let whole: Array1<f64> = [rest]
        .into_iter()
        .chain(row.iter().copied())
        .chain([rest])
        .collect();
    steepest(whole.view())
}
