//! Import of recordings of a plan that somebody else played and recorded: its runs are recognised, put on
//! the plan's clock and written as runs of our own.

mod judged;
mod places;
mod plan_clock;
mod player_filter;
mod plays;
mod recognised;
mod sought;
mod source;
mod under_way;

use std::path::{Path, PathBuf};

use frfid_files::{LogMap, Overwrite, create_folder, read_log};
use frfid_signals::{Excess, Record, Run};
use serde::Serialize;

use crate::description::estimate::GlideSubtraction;
use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::play::import::judged::{
    check_gains, check_measured, check_place, check_reference, doubt,
};
use crate::play::import::plan_clock::{on_plan_clock, times_of};
use crate::play::import::recognised::{Recognised, check_plan_id};
use crate::play::import::sought::SoughtRuns;
use crate::play::import::under_way::Import;
use crate::run::folder::Writer;
use crate::run::parallel::Progress;
use crate::run::planned_runs::PlannedRuns;

/// How recordings are imported.
#[derive(Debug, Clone, Copy, Default)]
pub struct ImportOptions {
    /// Samples a second of the player; the plan's without it.
    pub rate_hz: Option<f64>,
    /// What to do with a file that exists.
    pub overwrite: Overwrite,
}

/// What came of an import.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ImportSummary {
    /// Runs that were recognised and written, in the order in which they were found.
    pub imported: Vec<ImportedRun>,
    /// Runs that were there already.
    pub n_skipped: usize,
    /// Runs of the plan that are in none of the recordings.
    pub missing: Vec<String>,
    /// What was not used, and why: places that are doubtful, runs too many, recordings that cannot be read.
    pub unused: Vec<String>,
    /// What looks wrong with what was used.
    pub warnings: Vec<String>,
    /// Limits that the machine exceeded.
    pub excesses: Vec<Excess>,
}

impl ImportSummary {
    /// What looks wrong, what was not used, what was stopped and what is missing, in words.
    #[must_use]
    pub fn told(&self) -> Vec<String> {
        let unused = self
            .unused
            .iter()
            .map(|unused| format!("not used: {unused}"));
        let stopped = self
            .imported
            .iter()
            .filter_map(|run| Some((&run.run, run.stopped_s?)));
        let stopped =
            stopped.map(|(run, stopped_s)| format!("run {run} was stopped after {stopped_s:.3} s"));
        let missing = (!self.missing.is_empty())
            .then(|| format!("in none of the recordings: {}", self.missing.join(", ")));
        let flaws = self.imported.iter().flat_map(|run| {
            let origin = format!("run {} in {}", run.run, run.recording.display());
            run.flaws
                .iter()
                .map(move |flaw| format!("{origin}: {flaw}"))
        });
        let told = self.warnings.iter().cloned().chain(flaws).chain(unused);
        let told = told.chain(stopped);
        told.chain(missing).collect()
    }

    /// Whether every run of the plan is there, whole and inside the limits, and all that was recorded is
    /// used.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let is_whole = |run: &ImportedRun| run.stopped_s.is_none() && run.flaws.is_empty();
        self.missing.is_empty() && self.unused.is_empty() && self.imported.iter().all(is_whole)
    }
}

/// A run that was recognised.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportedRun {
    /// Its name.
    pub run: String,
    /// The recording it is in.
    #[serde(serialize_with = "frfid_files::serialize_path")]
    pub recording: PathBuf,
    /// When its first sample was played, in s by the recorder's clock after its first sample.
    pub start_s: f64,
    /// How much faster the recorder's clock is than the player's, in ppm.
    pub clock_ppm: f64,
    /// How long after its place by the player's clock it begins, in s; `None` where that clock was not recorded.
    pub delay_s: Option<f64>,
    /// Correlation coefficient with the plan.
    pub likeness: f64,
    /// The same of the reference that comes next.
    pub rival: f64,
    /// Samples of the run that lie in holes.
    pub n_lost: usize,
    /// Plan time in s at which it was stopped; `None` if it is whole.
    pub stopped_s: Option<f64>,
    /// What is wrong with it.
    pub flaws: Vec<String>,
}

/// Recognises the runs of a plan in recordings and writes `folder/RUN.mcap` for each.
///
/// # Errors
/// [`ExperimentError`]: a map that does not fit the plan, recordings none of which can be read or holds a
/// run of the plan, a file in the way.
pub fn import_recordings(
    planned: &PlannedRuns,
    recordings: &[PathBuf],
    map: &LogMap,
    folder: &Path,
    options: &ImportOptions,
    progress: Progress,
) -> Result<ImportSummary, ExperimentError> {
    check_map(&planned.experiment, map)?;
    let player = planned.experiment.player(options.rate_hz);
    let sought = SoughtRuns::of(planned, &player, map)?;
    create_folder(folder)?;
    let mut import = Import::new(planned, Writer::new(planned, folder, options.overwrite));
    for (done, recording) in recordings.iter().enumerate() {
        if !progress(done, recordings.len()) {
            return Err(ExperimentError::Interrupted {
                done,
                total: recordings.len(),
            });
        }
        import.take(recording, map, &sought)?;
    }
    import.finish()
}

/// A run in the recording of it alone; the record is on the plan's clock.
///
/// # Errors
/// [`ExperimentError`]: a map that does not fit, a recording that cannot be read or is not of this run.
pub(crate) fn imported_run(
    experiment: &Experiment,
    run: &Run,
    recording: &Path,
    map: &LogMap,
    rate_hz: Option<f64>,
) -> Result<Record, ExperimentError> {
    let plan = &experiment.plan;
    let sought = SoughtRuns::of_run(plan, run, &experiment.player(rate_hz), map)?;
    let log = read_log(recording, map)?;
    check_reference(&log, experiment)?;
    check_plan_id(&log, experiment.plan_id())?;
    let times_s = times_of(&log);
    let Recognised { runs, unused, .. } = Recognised::of(&log, &times_s, plan, &sought);
    let mut found = runs;
    found.sort_by(|a, b| b.occurrence.likeness.total_cmp(&a.occurrence.likeness));
    let Some(best) = found.first() else {
        let nothing = format!("nothing like {} in {}", run.id, recording.display());
        return Err(not_recognised(unused.first().unwrap_or(&nothing)));
    };
    if let Some(doubt) = doubt(best, &log) {
        return Err(not_recognised(&format!("{}: {doubt}", recording.display())));
    }
    check_gains(best, &log, experiment)?;
    let record = on_plan_clock(&log, &times_s, best, plan);
    check_measured(&record, &experiment.joint_names)?;
    check_place(&record, run, experiment)?;
    Ok(record)
}

/// Checks that a map has what the description needs.
pub(crate) fn check_map(experiment: &Experiment, map: &LogMap) -> Result<(), ExperimentError> {
    check_number(experiment, map)?;
    let subtraction = experiment.config.estimate.glide_subtraction;
    let is_needed = subtraction == GlideSubtraction::Position;
    match is_needed && map.position.is_empty() {
        true => Err(no_position()),
        false => Ok(()),
    }
}

fn no_position() -> ExperimentError {
    ExperimentError::logs(
        "log map",
        "no position",
        "one for each joint: glide_subtraction = \"position\" takes the ripple off by it",
        "name position in the map, or set glide_subtraction = \"time\" in [estimate]",
    )
}

/// Checks that a map has as many inputs and outputs as the plan.
fn check_number(experiment: &Experiment, map: &LogMap) -> Result<(), ExperimentError> {
    let n = experiment.plan.n_inputs;
    match [map.u.len(), map.y.len()] {
        found if found == [n, n] => Ok(()),
        found => Err(of_another_size(found, n)),
    }
}

fn of_another_size([inputs, outputs]: [usize; 2], n: usize) -> ExperimentError {
    ExperimentError::logs(
        "log map",
        format!("{inputs} inputs and {outputs} outputs"),
        format!("{n} of each, as the plan has"),
        "name one u and one y for each joint, in the order of the plan's joints",
    )
}

fn not_recognised(found: &str) -> ExperimentError {
    ExperimentError::logs(
        "runs of the plan in the recordings",
        found,
        "runs of this plan, played at full speed, the signals as the map says",
        "compare plan and recording: another plan, a speed slider below 100 %, a sign or the order of joints",
    )
}
