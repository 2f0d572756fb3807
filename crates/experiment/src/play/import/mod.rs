//! Import of recordings of a plan that somebody else played and recorded: its runs are recognised, put on
//! the plan's clock and written as runs of our own.

pub(crate) mod judged;
mod plan_clock;
mod sought;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use frfid_files::{Log, LogMap, Overwrite, create_folder, read_log, sha256_file};
use frfid_signals::{Excess, Limit, Record, Run, RunId, RunKind};
use serde::Serialize;

use crate::description::estimate::GlideSubtraction;
use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::play::import::judged::{
    check_gains, check_measured, check_place, check_reference, doubt,
};
use crate::play::import::plan_clock::{followed, on_plan_clock, times_of};
use crate::play::import::sought::{FoundRun, SoughtRuns};
use crate::run::folder::Writer;
use crate::run::load::Load;
use crate::run::parallel::Progress;
use crate::run::planned_runs::PlannedRuns;
use crate::run::provenance::Metadata;

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
        let told = self.warnings.iter().cloned().chain(unused).chain(stopped);
        told.chain(missing).collect()
    }

    /// Whether every run of the plan is there, whole and inside the limits, and all that was recorded is
    /// used.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let is_whole = |run: &ImportedRun| run.stopped_s.is_none();
        self.missing.is_empty()
            && self.unused.is_empty()
            && self.excesses.is_empty()
            && self.imported.iter().all(is_whole)
    }
}

/// A run that was recognised.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportedRun {
    /// Its name.
    pub run: String,
    /// The recording it is in.
    pub recording: PathBuf,
    /// When its first sample was played, in s by the recorder's clock after its first sample.
    pub start_s: f64,
    /// How much faster the recorder's clock is than the player's, in ppm.
    pub clock_ppm: f64,
    /// Correlation coefficient with the plan.
    pub likeness: f64,
    /// The same of the reference that comes next.
    pub rival: f64,
    /// Samples of the run that lie in holes.
    pub n_lost: usize,
    /// Plan time in s at which it was stopped; `None` if it is whole.
    pub stopped_s: Option<f64>,
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
    let sought = SoughtRuns::of(planned, &player)?;
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
    let sought = SoughtRuns::of_run(plan, run, &experiment.player(rate_hz))?;
    let log = read_log(recording, map)?;
    check_reference(&log, experiment)?;
    let times_s = times_of(&log);
    let mut found = sought.find(&followed(&log, &times_s, plan));
    found.sort_by(|a, b| b.occurrence.likeness.total_cmp(&a.occurrence.likeness));
    let Some(best) = found.first() else {
        return Err(not_recognised(&format!(
            "nothing like {} in {}",
            run.id,
            recording.display()
        )));
    };
    if let Some(doubt) = doubt(best, &log) {
        return Err(not_recognised(&format!("{}: {doubt}", recording.display())));
    }
    check_gains(best, &log, experiment)?;
    Ok(on_plan_clock(&log, &times_s, best, plan))
}

/// Checks that a map has what the description needs.
pub(crate) fn check_map(experiment: &Experiment, map: &LogMap) -> Result<(), ExperimentError> {
    check_number(experiment, map)?;
    let subtraction = experiment.config.estimate.glide_subtraction;
    if subtraction != GlideSubtraction::Position || !map.position.is_empty() {
        return Ok(());
    }
    Err(ExperimentError::logs(
        "log map",
        "no position",
        "one for each joint: glide_subtraction = \"position\" takes the ripple off by it",
        "name position in the map, or set glide_subtraction = \"time\" in [estimate]",
    ))
}

/// Checks that a map has as many inputs and outputs as the plan.
fn check_number(experiment: &Experiment, map: &LogMap) -> Result<(), ExperimentError> {
    let (n, found) = (experiment.plan.n_inputs, [map.u.len(), map.y.len()]);
    if found == [n, n] {
        return Ok(());
    }
    Err(ExperimentError::logs(
        "log map",
        format!("{} inputs and {} outputs", found[0], found[1]),
        format!("{n} of each, as the plan has"),
        "name one u and one y for each joint, in the order of the plan's joints",
    ))
}

fn not_recognised(found: &str) -> ExperimentError {
    ExperimentError::logs(
        "runs of the plan in the recordings",
        found,
        "runs of this plan, played at full speed, the signals as the map says",
        "compare plan and recording: another plan, a speed slider below 100 %, a sign or the order of joints",
    )
}

/// An import under way.
struct Import<'a> {
    planned: &'a PlannedRuns,
    writer: Writer<'a>,
    /// Runs of each reference that were found so far.
    counts: BTreeMap<RunId, usize>,
    summary: ImportSummary,
    first_error: Option<ExperimentError>,
    /// Recordings that could be read.
    n_read: usize,
}

impl<'a> Import<'a> {
    fn new(planned: &'a PlannedRuns, writer: Writer<'a>) -> Self {
        Self {
            planned,
            writer,
            counts: BTreeMap::new(),
            summary: ImportSummary::default(),
            first_error: None,
            n_read: 0,
        }
    }

    /// Takes the runs of one recording.
    fn take(
        &mut self,
        recording: &Path,
        map: &LogMap,
        sought: &SoughtRuns,
    ) -> Result<(), ExperimentError> {
        let name = recording.display();
        let log = match read_log(recording, map) {
            Ok(log) => {
                self.n_read += 1;
                log
            }
            Err(error) => {
                self.summary.unused.push(error.to_string());
                self.first_error.get_or_insert(error.into());
                return Ok(());
            }
        };
        check_reference(&log, &self.planned.experiment)?;
        let told = log
            .warnings
            .iter()
            .map(|warning| format!("{name}: {warning}"));
        self.summary.warnings.extend(told);
        let times_s = times_of(&log);
        let mut found = sought.find(&followed(&log, &times_s, &self.planned.experiment.plan));
        found.sort_by(|a, b| {
            let start_s = |run: &FoundRun| run.occurrence.alignment.start_s;
            start_s(a).total_cmp(&start_s(b))
        });
        for run in found {
            match doubt(&run, &log) {
                Some(doubt) => self.summary.unused.push(format!("{name}: {doubt}")),
                None => self.keep(&run, recording, &log, &times_s)?,
            }
        }
        Ok(())
    }

    /// Names a run, puts it on the plan's clock and writes it.
    fn keep(
        &mut self,
        found: &FoundRun,
        recording: &Path,
        log: &Log,
        times_s: &[f64],
    ) -> Result<(), ExperimentError> {
        let experiment = &self.planned.experiment;
        if let Err(error) = check_gains(found, log, experiment) {
            if found.id.kind == RunKind::Excitation {
                return Err(error);
            }
            let name = recording.display();
            self.summary.unused.push(format!("{name}: {error}"));
            return Ok(());
        }
        let Some(id) = self.next_of(found.id) else {
            let (id, name) = (found.id, recording.display());
            let start_s = found.occurrence.alignment.start_s;
            let many = format!("{name}: at {start_s:.3} s {id} once more than the plan repeats it");
            self.summary.unused.push(many);
            return Ok(());
        };
        if self.writer.record_of(id).is_some() {
            self.summary.n_skipped += 1;
            return Ok(());
        }
        let record = on_plan_clock(log, times_s, found, &experiment.plan);
        self.check_limits(id, &record)?;
        let run = self.planned.run(id)?;
        for error in [
            check_measured(&record, &experiment.joint_names).err(),
            check_place(&record, &run, experiment).err(),
        ]
        .into_iter()
        .flatten()
        {
            self.summary.warnings.push(error.to_string());
        }
        let told = imported(id, found, recording, &record);
        self.writer
            .write_with(id, record, provenance(&told, recording)?)?;
        self.summary.imported.push(told);
        Ok(())
    }

    /// The next repetition of a reference; `None` if all were found.
    fn next_of(&mut self, first: RunId) -> Option<RunId> {
        let plan = &self.planned.experiment.plan;
        let n_repetitions = match first.kind {
            RunKind::Glide => plan.n_glides,
            RunKind::Excitation => plan.n_repetitions,
        };
        let count = self.counts.entry(first).or_default();
        let id = RunId {
            repetition: *count,
            ..first
        };
        *count += 1;
        (id.repetition < n_repetitions).then_some(id)
    }

    fn check_limits(&mut self, id: RunId, record: &Record) -> Result<(), ExperimentError> {
        let experiment = &self.planned.experiment;
        let load = Load::of(record, &experiment.plan.start_rad()?, &experiment.pose_rad);
        let exceeded = experiment.limits.exceeded(&load.peaks);
        self.summary
            .warnings
            .extend(exceeded.iter().map(|excess| beyond(id, excess)));
        self.summary.excesses.extend(exceeded);
        Ok(())
    }

    fn finish(mut self) -> Result<ImportSummary, ExperimentError> {
        let all = self.planned.run_ids();
        let is_there = |id: &RunId| self.writer.record_of(*id).is_some();
        let imported = &self.summary.imported;
        let is_new = |id: &RunId| imported.iter().any(|run| run.run == id.to_string());
        let missing = all.iter().filter(|id| !is_new(id) && !is_there(id));
        self.summary.missing = missing.map(ToString::to_string).collect();
        if self.summary.missing.len() < all.len() {
            return Ok(self.summary);
        }
        let found = match self.summary.unused.first() {
            Some(unused) => unused.clone(),
            None => "none".into(),
        };
        let unread = self.first_error.filter(|_| self.n_read == 0);
        Err(unread.unwrap_or_else(|| not_recognised(&found)))
    }
}

/// What is told of a run.
fn imported(id: RunId, found: &FoundRun, recording: &Path, record: &Record) -> ImportedRun {
    let occurrence = &found.occurrence;
    let is_lost = |k: &usize| {
        let signals = [&record.u, &record.y];
        signals
            .iter()
            .any(|signal| signal.column(*k).iter().any(|value| !value.is_finite()))
    };
    ImportedRun {
        run: id.to_string(),
        recording: recording.into(),
        start_s: occurrence.alignment.start_s,
        clock_ppm: (occurrence.alignment.clock_ratio - 1.0) * 1e6,
        likeness: occurrence.likeness,
        rival: occurrence.rival,
        n_lost: (0..record.n_samples()).filter(is_lost).count(),
        stopped_s: occurrence.stopped_s,
    }
}

/// Where an imported run comes from.
fn provenance(told: &ImportedRun, recording: &Path) -> Result<Metadata, ExperimentError> {
    let name = recording
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let mut entries = Metadata::from([
        ("recording".to_owned(), name),
        ("recording_start_s".to_owned(), told.start_s.to_string()),
        ("recording_clock_ppm".to_owned(), told.clock_ppm.to_string()),
        ("recording_likeness".to_owned(), told.likeness.to_string()),
    ]);
    if recording.is_file() {
        entries.insert("recording_sha256".to_owned(), sha256_file(recording)?);
    }
    Ok(entries)
}

/// A limit that the machine exceeded.
fn beyond(id: RunId, excess: &Excess) -> String {
    let Excess {
        axis,
        limit,
        allowed,
        found,
    } = *excess;
    let (quantity, unit): (&str, &str) = (limit.quantity(), Limit::unit(limit));
    let joint = axis + 1;
    format!(
        "run {id}: axis {joint} reached {quantity} {found:.5} {unit}, the limit is {allowed:.5}"
    )
}
