//! Section 7.1 of the paper: the multisine on a constant velocity, with and without subtraction of
//! the torque ripple (figures 6 and 8).

use frfid_experiment::{
    EstimateTable, Experiment, ExperimentError, GlideSubtraction, Load, Outcome, Progress,
};
use frfid_plant::Hold;
use frfid_signals::{Frf, RunId};
use ndarray::Array1;

/// The campaign of section 7.1.
#[derive(Debug, Clone, PartialEq)]
pub struct MultisineCampaign {
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Reference velocity of axis 1 of one run in rad/s, lead-in and constant velocity included
    /// (figure 6).
    pub reference_rad_s: Array1<f64>,
    /// Constant velocity of every axis in rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// The estimate without a cure for the ripple (figure 8).
    pub uncompensated: Frf,
    /// The glide subtracted sample by sample, the paper's cure.
    pub in_time: Frf,
    /// The glide subtracted by motor position.
    pub by_position: Frf,
    /// Lines of `by_position` at which what remains of the ripple exceeds the noise.
    pub flagged: Vec<bool>,
    /// The truth at the pose on the lines of the multisine, seen through the sensor.
    pub truth: Frf,
    /// Truths at poses along the way from its start to its end.
    pub along_the_way: Vec<Frf>,
    /// Largest values over all runs.
    pub load: Load,
    /// Number of runs, glides included.
    pub n_runs: usize,
    /// Time on the robot in s.
    pub robot_time_s: f64,
}

/// Poses along the way, its start and its end included.
const POSES: usize = 5;

impl MultisineCampaign {
    /// Does the campaign on the model: every run once, estimated in three ways.
    ///
    /// # Errors
    /// [`ExperimentError`] of a run or an estimate, or an interruption.
    pub fn run(
        experiment: &Experiment,
        jobs: usize,
        progress: Progress,
    ) -> Result<Self, ExperimentError> {
        let plan = experiment.plan();
        let outcomes = measured_in_three_ways(experiment, jobs, progress)?;
        let flagged = outcomes[2].result.flagged.clone().unwrap_or_default();
        let load = outcomes[2].load.clone().expect("a plan has runs");
        let [uncompensated, in_time, by_position] = outcomes.map(|outcome| outcome.result.frf);
        let hz = &uncompensated.frequency_hz;
        let first = RunId::excitation(0, 0, 0);
        Ok(Self {
            sample_time_s: plan.sample_time_s,
            reference_rad_s: plan.run(first)?.reference.row(0).to_owned(),
            velocity_rad_s: plan.velocity_rad_s.clone(),
            truth: experiment.truth(hz, Hold::Zoh, true)?,
            along_the_way: along_the_way(experiment, hz)?,
            uncompensated,
            in_time,
            by_position,
            flagged,
            load,
            n_runs: plan.n_runs(),
            robot_time_s: plan.robot_time_s()?,
        })
    }
}

/// One campaign, estimated without subtraction of the glide, with that in time, and by position.
fn measured_in_three_ways(
    experiment: &Experiment,
    jobs: usize,
    progress: Progress,
) -> Result<[Outcome; 3], ExperimentError> {
    let ways = [
        GlideSubtraction::None,
        GlideSubtraction::Time,
        GlideSubtraction::Position,
    ]
    .map(|glide_subtraction| EstimateTable {
        glide_subtraction,
        ..experiment.config().estimate.clone()
    });
    experiment.measure_each(ways.each_ref(), &*experiment.testbed(), jobs, progress)
}

/// The linear truths at poses from the start of a run to its end.
fn along_the_way(experiment: &Experiment, hz: &[f64]) -> Result<Vec<Frf>, ExperimentError> {
    let truth = |number: usize| {
        let share = 1.0 - 2.0 * number as f64 / (POSES - 1) as f64;
        let pose_rad = pose_at(experiment, share)?;
        let there = experiment.with(|config| config.robot.pose_rad = Some(pose_rad))?;
        there.truth(hz, Hold::Zoh, true)
    };
    (0..POSES).map(truth).collect()
}

/// The pose in rad at a share of the way, from 1 at the start of a run to -1 at its end.
fn pose_at(experiment: &Experiment, share: f64) -> Result<Vec<f64>, ExperimentError> {
    let start_rad = experiment.plan().start_rad()?;
    let ways = experiment.pose_rad().iter().zip(&start_rad);
    Ok(ways.map(|(pose, start)| pose + share * start).collect())
}
