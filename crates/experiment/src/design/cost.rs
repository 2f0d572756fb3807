//! Cost of an experiment, before anything is run.

use frfid_signals::{Plan, SignalError};

/// Cost of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Runs in all, glides included.
    pub n_runs: usize,
    /// Samples of one run.
    pub run_samples: usize,
    /// Time on the robot in s, without the ways back to the start.
    pub robot_time_s: f64,
    /// Memory in bytes for each job: the record and the reference of one run, and one period of a
    /// realization.
    pub memory_bytes: f64,
    /// Disk space in bytes for all records, before compression.
    pub disk_bytes: f64,
}

/// Bytes of a joint's sample in `/joint_states`, `/joint_commands` and `/frfid/excitation`:
/// position, velocity, effort, command and excitation.
const BYTES_PER_JOINT_SAMPLE: f64 = 5.0 * 8.0;
/// Bytes of headers and names that come with each sample, whatever the number of joints.
const BYTES_PER_SAMPLE: f64 = 250.0;

impl Cost {
    /// Cost of all runs of `plan`.
    ///
    /// # Errors
    /// [`SignalError`] if the plan's lengths are impossible.
    pub fn of(plan: &Plan) -> Result<Self, SignalError> {
        let run_samples = plan.run_samples()?;
        let (n, axes) = (run_samples as f64, plan.n_inputs as f64);
        let period_samples = plan.n_experiments() as f64 * plan.period_samples()? as f64;
        let sample_bytes = BYTES_PER_SAMPLE + axes * BYTES_PER_JOINT_SAMPLE;
        Ok(Self {
            n_runs: plan.n_runs(),
            run_samples,
            robot_time_s: plan.robot_time_s()?,
            memory_bytes: 8.0 * axes * (6.0 * n + period_samples),
            disk_bytes: plan.n_runs() as f64 * n * sample_bytes,
        })
    }
}
