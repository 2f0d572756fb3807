//! Export of a plan: its runs from rest to rest, in the files that the players of others take.

use std::path::Path;
use std::sync::Arc;

use frfid_files::{Exported, FileError, Overwrite, PlayFormat, PlaybackFile, Rehearsal, TableForm};
use frfid_signals::{Playback, RunKind};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::play::layout::Layout;
use crate::run::parallel::Progress;
use crate::run::planned_runs::PlannedRuns;
use crate::run::provenance::DESIGN;

/// How a plan is exported.
#[derive(Debug, Clone)]
pub struct PlayOptions {
    /// The format of the files.
    pub format: &'static PlayFormat,
    /// The player's samples a second; the plan's own rate if `None`.
    pub rate_hz: Option<f64>,
    /// The form of a table.
    pub form: TableForm,
    /// One file for all runs, in order, with repetitions; else one for each reference.
    pub is_campaign: bool,
    /// Runs to rehearse at once, 0: one for each core.
    pub jobs: usize,
    /// What to do with files that exist.
    pub overwrite: Overwrite,
}

impl PlayOptions {
    /// Refuses a form that does not fit the joints, and that of a table for a format that is none.
    fn check(&self, n_joints: usize) -> Result<(), FileError> {
        if !self.format.is_table && self.form != TableForm::default() {
            return Err(self.no_table());
        }
        self.form.check(n_joints)
    }

    fn no_table(&self) -> FileError {
        let name = self.format.name;
        FileError::Shape {
            what: "form",
            found: format!("separator, decimal mark, unit or side of a table for {name}"),
            needed: "none: messages of ROS are in rad and N m on the joint side".into(),
        }
    }
}

impl Experiment {
    /// The first 32 bits of the hash of its plan.
    pub(crate) fn plan_id(&self) -> u32 {
        let of_plan = self.provenance().remove(DESIGN);
        first_32_bits(&of_plan.unwrap_or_default())
    }
}

impl PlannedRuns {
    /// Writes every run as a player takes it, once all of them were held against the limits.
    ///
    /// A `path` with the format's ending is one file, for a campaign or a plan of one reference; any other is a
    /// folder, which gets the list of runs, too.
    ///
    /// # Errors
    /// [`ExperimentError::Exceeds`]; [`ExperimentError::File`], also for a form that does not fit, a file that
    /// exists, or several references for one file; [`ExperimentError::Interrupted`].
    pub fn export(
        &self,
        path: &Path,
        options: &PlayOptions,
        progress: Progress,
    ) -> Result<Exported, ExperimentError> {
        let player = self.experiment.player(options.rate_hz);
        let layout = Layout::of(path, options, &self.references())?;
        options.check(self.experiment.plan.n_inputs)?;
        let runs = self.rehearse(&player, options.jobs, progress)?;
        let exported = Exported {
            shown: self.rehearsed_again(&runs[shown(&runs)], &player)?,
            plan_id: self.plan_id()?,
            files: layout.files.clone(),
            order: layout.order.clone(),
            joint_names: self.experiment.joint_names.clone(),
            player,
            runs,
        };
        self.write_all(&layout, &exported, options)?;
        Ok(exported)
    }

    /// The first 32 bits of the plan's hash: a number that fits a column, a register and a signal.
    ///
    /// # Errors
    /// Those of a plan with too many samples.
    pub fn plan_id(&self) -> Result<u32, ExperimentError> {
        let of_plan = self.head()?.metadata.remove(DESIGN);
        let hash = of_plan.unwrap_or_else(|| self.experiment.config_sha256());
        Ok(first_32_bits(&hash))
    }

    /// Writes every file of a layout.
    fn write_all(
        &self,
        layout: &Layout,
        exported: &Exported,
        options: &PlayOptions,
    ) -> Result<(), ExperimentError> {
        layout.create_folder()?;
        if options.is_campaign {
            let playbacks = self.campaign(exported)?;
            self.write_file(&layout.files[0], "campaign", playbacks, exported, options)?;
        } else {
            for (run, path) in exported.runs.iter().zip(&layout.files) {
                let playbacks = vec![self.rehearsed_again(run, &exported.player)?];
                self.write_file(path, &run.id.to_string(), playbacks, exported, options)?;
            }
        }
        Ok(layout.write_order(exported, options.overwrite)?)
    }

    /// Every run, repetition by repetition.
    fn campaign(&self, exported: &Exported) -> Result<Vec<Arc<Playback>>, ExperimentError> {
        let mut playbacks = Vec::new();
        for run in &exported.runs {
            let playback = self.rehearsed_again(run, &exported.player)?;
            playbacks.extend(std::iter::repeat_n(playback, run.n_repetitions));
        }
        Ok(playbacks)
    }

    fn write_file(
        &self,
        path: &Path,
        name: &str,
        playbacks: Vec<Arc<Playback>>,
        exported: &Exported,
        options: &PlayOptions,
    ) -> Result<(), ExperimentError> {
        let file = PlaybackFile {
            name: name.to_owned(),
            joint_names: exported.joint_names.clone(),
            plan_id: exported.plan_id,
            signal_units: self.experiment.reference_units(),
            pose_rad: exported.player.pose_rad.clone(),
            playbacks,
            form: options.form.clone(),
        };
        Ok((options.format.write)(path, options.overwrite, &file)?)
    }
}

/// Of a hash in hexadecimal.
fn first_32_bits(hash: &str) -> u32 {
    let first = hash.get(..8).unwrap_or_default();
    u32::from_str_radix(first, 16).unwrap_or_default()
}

/// Which run is shown: the first that is no glide, if there is one.
fn shown(runs: &[Rehearsal]) -> usize {
    let excited = runs
        .iter()
        .position(|run| run.id.kind == RunKind::Excitation);
    excited.unwrap_or_default()
}
