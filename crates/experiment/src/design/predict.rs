//! Prediction of what the runs will ask of the robot, by doing them on its model, against the
//! limits.

use frfid_estimate::AxisStrength;
use frfid_plant::{Simulated, SimulatedRobot};
use frfid_signals::{Excess, GoOn, Injection, Plan, Run, RunId};
use serde::Serialize;

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::load::{Load, crest_factors, larger};
use crate::run::parallel::{Progress, Steps, for_each_group, n_at_once, told};
use crate::run::planned_runs::{PlannedRuns, first_repetitions};
use crate::run::strength::Strength;

/// What a design will ask of the robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// Largest values over all realizations and experiments.
    #[serde(rename = "peaks")]
    pub load: Load,
    /// What is asked without the excitation: by the constant velocity, friction and gravity alone.
    pub baseline: Load,
    /// Crest factor of the motor torque about its mean, peak over rms of the same run, largest over
    /// all runs, one for each axis.
    pub crest_factor: Vec<f64>,
    /// Every limit that is exceeded; empty for a design inside the limits.
    pub excesses: Vec<Excess>,
    /// How the axes will be driven and moved; `None` of none that is excited.
    pub strength: Option<Strength>,
    /// Limits that the reference of a closed loop exceeds where it is played from rest to rest.
    pub played: Vec<Excess>,
}

/// Does every run of the design once on the robot's model, beyond its limits too, and compares the
/// peaks with the limits.
///
/// # Errors
/// [`ExperimentError`]: no model, a run that diverges, or an interruption.
pub fn predict(
    experiment: &Experiment,
    jobs: usize,
    progress: Progress,
) -> Result<Prediction, ExperimentError> {
    PlannedRuns::of(experiment.clone()).predict(jobs, progress)
}

impl PlannedRuns {
    /// The same for the references of a plan, which may be those of a file.
    ///
    /// # Errors
    /// As [`predict`].
    pub fn predict(&self, jobs: usize, progress: Progress) -> Result<Prediction, ExperimentError> {
        let experiment = &self.experiment;
        let simulator = experiment.simulator(None)?;
        let plan = &experiment.plan;
        let ids = first_repetitions(plan);
        let total = ids.len();
        let go_on = || progress(0, total);
        let glide = glide(plan)?;
        let baseline = simulator.simulate_while(&glide, &go_on);
        let interrupted = ExperimentError::Interrupted { done: 0, total };
        let baseline = baseline.map_err(|error| told(error.into(), interrupted))?;
        let baseline = Demand::of(&glide, baseline, experiment)?.load;
        let steps = Steps {
            progress,
            before: 0,
            total: ids.len(),
        };
        let n_at_once = n_at_once(experiment, &simulator)?;
        let demands = for_each_group(&ids, n_at_once, jobs, steps, |ids, go_on| {
            let runs = ids.iter().map(|id| self.run_while(*id, go_on));
            Demand::of_each(
                &runs.collect::<Result<Vec<_>, _>>()?,
                experiment,
                &simulator,
                go_on,
            )
        })?;
        let largest = demands.into_iter().reduce(Demand::larger);
        let largest = largest.expect("a plan has runs");
        let excesses = experiment.limits.exceeded(&largest.load.peaks);
        Ok(Prediction {
            load: largest.load,
            baseline,
            crest_factor: largest.crest_factor,
            excesses,
            strength: experiment.strength(&largest.strengths),
            played: largest.played,
        })
    }
}

/// The run without the excitation: the constant velocity, friction and gravity alone.
fn glide(plan: &Plan) -> Result<Run, ExperimentError> {
    let plan = Plan {
        n_glides: 1,
        ..plan.clone()
    };
    Ok(plan.run(RunId::glide(0))?)
}

/// What a run asks of the robot.
struct Demand {
    load: Load,
    /// Crest factor of the torque of every axis.
    crest_factor: Vec<f64>,
    strengths: Vec<Vec<AxisStrength>>,
    played: Vec<Excess>,
}

impl Demand {
    /// Does runs in simulation.
    fn of_each(
        runs: &[Run],
        experiment: &Experiment,
        simulator: &SimulatedRobot,
        go_on: GoOn,
    ) -> Result<Vec<Self>, ExperimentError> {
        let simulated = simulator.simulate_each(runs, go_on).into_iter();
        let demands = simulated
            .zip(runs)
            .map(|(simulated, run)| Self::of(run, simulated?, experiment));
        demands.collect()
    }

    fn of(
        run: &Run,
        simulated: Simulated,
        experiment: &Experiment,
    ) -> Result<Self, ExperimentError> {
        let Simulated {
            record, changes, ..
        } = simulated;
        let load = Load::of(&record, &run.start_rad, &experiment.pose_rad);
        Ok(Self {
            load: load.with_changes(changes),
            played: played(run, experiment)?,
            crest_factor: crest_factors(&record),
            strengths: experiment
                .strength_of(run.id, &record)
                .into_iter()
                .collect(),
        })
    }

    fn larger(self, other: Self) -> Self {
        Self {
            load: self.load.larger(&other.load),
            crest_factor: larger(&self.crest_factor, &other.crest_factor),
            strengths: [self.strengths, other.strengths].concat(),
            played: if self.played.is_empty() {
                other.played
            } else {
                self.played
            },
        }
    }
}

/// Limits that the reference of a closed loop exceeds for itself, from rest to rest: a machine cannot be at its
/// velocity at once.
fn played(run: &Run, experiment: &Experiment) -> Result<Vec<Excess>, ExperimentError> {
    let player = experiment.player(None);
    match experiment.plan.injection {
        Injection::Torque => Ok(Vec::new()),
        Injection::Velocity => Ok(experiment.plan.playback(run, &player)?.excesses(&player)),
    }
}

impl Prediction {
    /// Factor by which all amplitudes must shrink to keep every limit, from the limit that binds
    /// most: the excitation's part of a peak taken as proportional to the amplitude, which is exact
    /// for torques in open loop and a first guess for other quantities. 0 or less where the limit
    /// is exceeded without any excitation; `None` inside the limits.
    #[must_use]
    pub fn feasible_factor(&self) -> Option<f64> {
        let factors = self.excesses.iter().map(|excess| self.factor(excess));
        factors.reduce(f64::min)
    }

    /// The limit that binds most.
    #[must_use]
    pub fn binding(&self) -> Option<&Excess> {
        let by_factor = |a: &&Excess, b: &&Excess| self.factor(a).total_cmp(&self.factor(b));
        self.excesses.iter().min_by(by_factor)
    }

    /// What is asked of a limited quantity without the excitation.
    #[must_use]
    pub fn without_excitation(&self, excess: &Excess) -> f64 {
        let baseline = self.baseline.peaks.get(excess.limit);
        baseline.map_or(0.0, |baseline| baseline[excess.axis])
    }

    fn factor(&self, excess: &Excess) -> f64 {
        let baseline = self.without_excitation(excess);
        // without a part of its own the excitation cannot mend it
        if excess.found == baseline {
            0.0
        } else {
            (excess.allowed - baseline) / (excess.found - baseline)
        }
    }
}
