//! Planned runs: of a description, whose references are made from the seed, or of a plan file,
//! whose references are read.

use std::path::Path;

use frfid_files::{
    BoxError, Overwrite, PlanFile, PlanHead, PlannedRun, check_not_read, write_plan,
};
use frfid_signals::{GoOn, Plan, Run, RunId, RunKind};

use crate::description::text::TomlText;
use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::parallel::Progress;

/// Runs to be done.
#[derive(Debug, Clone)]
pub struct PlannedRuns {
    /// The description.
    pub experiment: Experiment,
    /// The plan file whose references are played instead of those the description would give.
    plan: Option<PlanFile>,
}

impl PlannedRuns {
    /// Reads a description (`.toml`) or a plan file (anything else).
    ///
    /// # Errors
    /// [`ExperimentError`]: unreadable, damaged, or not what it should be.
    pub fn load(path: &Path) -> Result<Self, ExperimentError> {
        if path.extension().is_some_and(|ending| ending == "toml") {
            return Ok(Self::of(Experiment::load(path)?));
        }
        let plan = PlanFile::open(path)?;
        let source = TomlText::travelled_in(path, plan.head.experiment_toml.clone());
        Ok(Self {
            experiment: Experiment::travelled(source)?,
            plan: Some(plan),
        })
    }

    /// The runs of a description.
    #[must_use]
    pub fn of(experiment: Experiment) -> Self {
        Self {
            experiment,
            plan: None,
        }
    }

    /// The plan file that the references are in, if they are in one.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.plan.as_ref().map(PlanFile::path)
    }

    /// Every run, in the order in which they are done.
    #[must_use]
    pub fn run_ids(&self) -> Vec<RunId> {
        match &self.plan {
            Some(plan) => plan.run_ids().collect(),
            None => self.experiment.plan.run_ids().collect(),
        }
    }

    /// The reference of one run.
    ///
    /// # Errors
    /// [`ExperimentError`] if there is no such run, or the plan file is damaged there.
    pub fn run(&self, id: RunId) -> Result<Run, ExperimentError> {
        self.run_while(id, &|| true)
    }

    /// The same as long as `go_on` says so: phases for a low crest factor take a while.
    ///
    /// # Errors
    /// As [`PlannedRuns::run`]; [`frfid_signals::SignalError::Interrupted`].
    pub fn run_while(&self, id: RunId, go_on: GoOn) -> Result<Run, ExperimentError> {
        match &self.plan {
            Some(plan) => Ok(plan.run(id)?),
            None => Ok(self.experiment.plan.run_while(id, go_on)?),
        }
    }

    /// Writes the references of every run as a plan file that a player on the robot's side can
    /// send.
    ///
    /// # Errors
    /// [`ExperimentError::File`], also when `progress` said to stop, and as
    /// [`PlannedRuns::check_output`].
    pub fn write(
        &self,
        path: &Path,
        overwrite: Overwrite,
        progress: Progress,
    ) -> Result<(), ExperimentError> {
        self.check_output(path)?;
        let ids = first_repetitions(&self.experiment.plan);
        let total = ids.len();
        let runs = ids.iter().enumerate().map(|(done, &id)| {
            if !progress(done, total) {
                let interrupted = ExperimentError::Interrupted { done, total };
                return Err(BoxError::from(interrupted));
            }
            Ok(self.planned_run(id, &|| progress(done, total))?)
        });
        Ok(write_plan(path, overwrite, &self.head()?, runs)?)
    }

    /// Refuses an output in the place of the file that the references, or the description, were read
    /// from.
    ///
    /// # Errors
    /// [`ExperimentError::File`].
    pub fn check_output(&self, path: &Path) -> Result<(), ExperimentError> {
        let description = Path::new(&self.experiment.text.name);
        Ok(check_not_read(
            path,
            self.path().into_iter().chain([description]),
        )?)
    }

    /// What all runs of the plan file have in common.
    pub(crate) fn head(&self) -> Result<PlanHead, ExperimentError> {
        if let Some(plan) = &self.plan {
            return Ok(plan.head.clone());
        }
        let experiment = &self.experiment;
        let plan = &experiment.plan;
        Ok(PlanHead {
            joint_names: experiment.joint_names.clone(),
            sample_time_s: plan.sample_time_s,
            injection: plan.injection,
            lead_in_samples: plan.lead_in_samples,
            period_samples: plan.period_samples()?,
            n_periods: plan.n_periods,
            metadata: experiment.provenance(),
            experiment_toml: experiment.to_toml(),
        })
    }

    /// A run with the number of its repetitions.
    fn planned_run(&self, id: RunId, go_on: GoOn) -> Result<PlannedRun, ExperimentError> {
        let plan = &self.experiment.plan;
        let n_repetitions = match id.kind {
            RunKind::Glide => plan.n_glides,
            RunKind::Excitation => plan.n_repetitions,
        };
        Ok(PlannedRun {
            run: self.run_while(id, go_on)?,
            n_repetitions,
        })
    }
}

/// One run of every reference: repetitions share theirs.
pub(crate) fn first_repetitions(plan: &Plan) -> Vec<RunId> {
    plan.run_ids().filter(|id| id.repetition == 0).collect()
}
