//! Testbed, the seam between experiments and machines: a reference goes in, a [`Record`] comes out.

use thiserror::Error;

use crate::error::SignalError;
use crate::excitation::GoOn;
use crate::plan::run::{Run, RunId};
use crate::record::Record;

/// A machine on which runs can be done: the simulator, a folder of recordings, or a robot behind
/// somebody's own code.
///
/// `run` may be called from several threads at once; a testbed that can do one run at a time must
/// see to that itself.
pub trait Testbed: Sync {
    /// Number of inputs (channels of the reference).
    fn n_inputs(&self) -> usize;

    /// Hears which runs come next, before the first of them: for machines whose runs are played elsewhere,
    /// all in one go.
    ///
    /// # Errors
    /// [`TestbedError`].
    fn announce(&self, _runs: &[&Run]) -> Result<(), TestbedError> {
        Ok(())
    }

    /// Does one run and returns what was measured: as many samples as the reference, or fewer if
    /// the run was stopped (then the record's last event says why).
    ///
    /// # Errors
    /// [`TestbedError`].
    fn run(&self, run: &Run) -> Result<Record, TestbedError>;

    /// The same as long as `go_on` says so, on testbeds that can be asked in the middle of a run;
    /// others finish it.
    ///
    /// # Errors
    /// As [`Testbed::run`]; [`SignalError::Interrupted`] as [`TestbedError::Run`].
    fn run_while(&self, run: &Run, _go_on: GoOn) -> Result<Record, TestbedError> {
        self.run(run)
    }

    /// How many runs it does at once in hardly more time than one.
    fn n_at_once(&self) -> usize {
        1
    }

    /// Does several runs, which must not depend on each other: [`Testbed::n_at_once`] at a time take
    /// the least time.
    ///
    /// # Errors
    /// Of each run, as [`Testbed::run_while`].
    fn run_each(&self, runs: &[Run], go_on: GoOn) -> Vec<Result<Record, TestbedError>> {
        let each = runs.iter().map(|run| self.run_while(run, go_on));
        each.collect()
    }
}

/// Why a testbed could not do a run.
#[derive(Debug, Error)]
pub enum TestbedError {
    /// The run does not fit the testbed.
    #[error(transparent)]
    Run(#[from] SignalError),
    /// The simulation diverged: the first quantity that was not finite.
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

impl TestbedError {
    /// What the testbed's own code said of a run.
    pub fn foreign(
        run: RunId,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        let source = source.into();
        Self::Foreign { run, source }
    }
}

/// What to do about a simulation that diverged.
fn lower(gain_nms_per_rad: Option<f64>) -> String {
    match gain_nms_per_rad {
        Some(gain) => format!("the gain of that axis is {gain} N m s/rad: lower the gains"),
        None => "lower the amplitude".into(),
    }
}
