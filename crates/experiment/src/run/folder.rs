//! Folder of runs, one MCAP each; what is there already and belongs to the plan is not done again.

use std::path::{Path, PathBuf};

use frfid_estimate::{AxisStrength, standing_share};
use frfid_files::{Overwrite, create_folder, read_run, read_run_label, write_run};
use frfid_signals::{Event, EventKind, GoOn, Record, Run, RunId, Testbed};
use serde::Serialize;

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::guard::Guarded;
use crate::run::load::Load;
use crate::run::parallel::{Progress, Steps, for_each_group, kept_each, n_at_once};
use crate::run::planned_runs::PlannedRuns;
use crate::run::provenance::{CONFIG, Metadata};
use crate::run::run_file::run_file;
use crate::run::strength::Strength;

/// How runs are done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunOptions {
    /// Runs at once; 0: one for each core.
    pub jobs: usize,
    /// Only the run at this place of the plan, from 0: for job arrays.
    pub index: Option<usize>,
    /// What to do with a file that exists and is not this run's.
    pub overwrite: Overwrite,
}

/// What came of the runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// Runs done now, in the order of their names.
    pub written: Vec<RunReport>,
    /// Runs that were there already.
    pub n_skipped: usize,
    /// Files among these whose run was stopped before its end; [`Overwrite::Replace`] does such
    /// runs again.
    #[serde(serialize_with = "frfid_files::serialize_paths")]
    pub stopped_before: Vec<PathBuf>,
    /// How the axes were driven and moved in the runs done now; `None` of none.
    pub strength: Option<Strength>,
}

/// What came of one run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// Its file.
    #[serde(serialize_with = "frfid_files::serialize_path")]
    pub path: PathBuf,
    /// Largest values.
    #[serde(rename = "peaks")]
    pub load: Load,
    /// Share of the samples at which the measured velocity is exactly zero, one for each axis: with
    /// an ideal sensor the time in which friction holds the joint; `None` where noise or a coarse
    /// resolution hides it.
    pub standing_share: Vec<Option<f64>>,
    /// Limits that were hit and stops, without the starts of periods.
    pub events: Vec<Event>,
}

/// Does the runs that are `planned` on `testbed` (the description's own model if `None`) and writes
/// `folder/RUN.mcap` for each.
///
/// # Errors
/// [`ExperimentError`]: an index beyond the plan, a run that fails, a file in the way that is not
/// this run's, a disk that is full. Runs that are complete by then stay.
pub fn run_to_folder(
    planned: &PlannedRuns,
    testbed: Option<&dyn Testbed>,
    folder: &Path,
    options: &RunOptions,
    progress: Progress,
) -> Result<RunSummary, ExperimentError> {
    let ids = chosen(planned, options.index)?;
    let experiment = &planned.experiment;
    if testbed.is_none() {
        experiment.model()?;
    }
    let writer = Writer::new(planned, folder, options.overwrite);
    let model = experiment.testbed();
    let guarded = testbed.map(|testbed| Guarded::of(experiment, testbed));
    let (open, stopped_before) = writer.open(&ids, guarded.as_ref())?;
    let testbed = guarded
        .as_ref()
        .map_or(&*model, |guarded| guarded as &dyn Testbed);
    create_folder(folder)?;
    let n_skipped = ids.len() - open.len();
    let steps = Steps {
        progress,
        before: n_skipped,
        total: ids.len(),
    };
    let n_at_once = n_at_once(experiment, testbed)?;
    let done = for_each_group(&open, n_at_once, options.jobs, steps, |ids, go_on| {
        writer.done(ids, testbed, go_on)
    })?;
    let (written, strength) = summarized(experiment, done);
    Ok(RunSummary {
        written,
        n_skipped,
        stopped_before,
        strength,
    })
}

/// What came of a run, and how its axes were driven and moved.
type Done = (RunReport, Option<Vec<AxisStrength>>);

/// What came of all runs, in the order of their names, and their strength as one.
fn summarized(experiment: &Experiment, done: Vec<Done>) -> (Vec<RunReport>, Option<Strength>) {
    let (mut reports, strengths): (Vec<RunReport>, Vec<_>) = done.into_iter().unzip();
    reports.sort_by(|a, b| a.path.cmp(&b.path));
    let strengths: Vec<_> = strengths.into_iter().flatten().collect();
    (reports, experiment.strength(&strengths))
}

/// What is in the place of a run's file.
enum Found {
    /// Nothing, or something that is not this run's.
    Nothing,
    /// The run, stopped before its end.
    Stopped(Record),
    /// The run.
    Whole(Record),
}

/// Does runs and writes their files.
pub(crate) struct Writer<'a> {
    planned: &'a PlannedRuns,
    folder: &'a Path,
    overwrite: Overwrite,
    metadata: Metadata,
}

impl<'a> Writer<'a> {
    pub(crate) fn new(planned: &'a PlannedRuns, folder: &'a Path, overwrite: Overwrite) -> Self {
        Self {
            planned,
            folder,
            overwrite,
            metadata: planned.experiment.provenance(),
        }
    }

    fn path_of(&self, id: RunId) -> PathBuf {
        run_path(self.folder, id)
    }

    /// The runs that are to be done, and the files of those that were stopped before and stay; `guard` sees what is
    /// there.
    fn open(
        &self,
        ids: &[RunId],
        guard: Option<&Guarded>,
    ) -> Result<(Vec<RunId>, Vec<PathBuf>), ExperimentError> {
        let (mut open, mut stopped_before) = (Vec::new(), Vec::new());
        for &id in ids {
            let Some(record) = self.record_of(id) else {
                open.push(id);
                continue;
            };
            if record.stopped_at_s().is_some() {
                stopped_before.push(self.path_of(id));
            }
            if let Some(guard) = guard {
                guard.see(&self.planned.run(id)?, &record);
            }
        }
        Ok((open, stopped_before))
    }

    fn found(&self, id: RunId) -> Found {
        let Ok((file, losses)) = read_run(&self.path_of(id)) else {
            return Found::Nothing;
        };
        let is_ours = self.is_ours(&file.metadata);
        match file.record.stopped_at_s() {
            _ if !losses.is_empty() || file.run != id || !is_ours => Found::Nothing,
            Some(_) => Found::Stopped(file.record),
            None => Found::Whole(file.record),
        }
    }

    /// The record of a run that is there and not to be done again.
    pub(crate) fn record_of(&self, id: RunId) -> Option<Record> {
        match self.found(id) {
            Found::Whole(record) => Some(record),
            Found::Stopped(record) if self.overwrite != Overwrite::Replace => Some(record),
            Found::Stopped(_) | Found::Nothing => None,
        }
    }

    /// What the file of a run says of where it comes from; `None` where it is not there, not this experiment's, or
    /// to be replaced.
    pub(crate) fn metadata_of(&self, id: RunId) -> Option<Metadata> {
        let there = read_run_label(&self.path_of(id)).ok()?.metadata;
        let is_kept = self.overwrite != Overwrite::Replace;
        (is_kept && self.is_ours(&there)).then_some(there)
    }

    fn is_ours(&self, metadata: &Metadata) -> bool {
        metadata.get(CONFIG) == self.metadata.get(CONFIG)
    }

    /// Writes the file of a run; the record comes back with the starts of its periods.
    pub(crate) fn write(&self, id: RunId, record: Record) -> Result<Record, ExperimentError> {
        self.write_with(id, record, Metadata::new())
    }

    /// The same with more to say of where the record comes from.
    pub(crate) fn write_with(
        &self,
        id: RunId,
        record: Record,
        origin: Metadata,
    ) -> Result<Record, ExperimentError> {
        let mut metadata = self.metadata.clone();
        metadata.extend(origin);
        let file = run_file(&self.planned.experiment, id, record, metadata)?;
        write_run(&self.path_of(id), self.overwrite, &file)?;
        Ok(file.record)
    }

    /// Does runs and writes them; what is written stays, whatever comes of the others. A run that has begun
    /// is finished.
    fn done(
        &self,
        ids: &[RunId],
        testbed: &dyn Testbed,
        go_on: GoOn,
    ) -> Result<Vec<Done>, ExperimentError> {
        let runs = ids.iter().map(|&id| self.planned.run_while(id, go_on));
        let runs: Vec<Run> = runs.collect::<Result<_, _>>()?;
        kept_each(&runs, testbed, |run, record| self.written(run, record))
    }

    /// Writes what came of a run.
    fn written(&self, run: &Run, record: Record) -> Result<Done, ExperimentError> {
        let experiment = &self.planned.experiment;
        let record = self.write(run.id, record)?;
        let load = Load::of(&record, &run.start_rad, &experiment.pose_rad);
        let report = report(self.path_of(run.id), load, &record);
        Ok((report, experiment.strength_of(run.id, &record)))
    }
}

/// The file of a run in a folder of runs.
#[must_use]
pub fn run_path(folder: &Path, id: RunId) -> PathBuf {
    folder.join(format!("{id}.mcap"))
}

/// All runs, or the one at `index`.
fn chosen(planned: &PlannedRuns, index: Option<usize>) -> Result<Vec<RunId>, ExperimentError> {
    let ids = planned.run_ids();
    let Some(index) = index else { return Ok(ids) };
    match ids.get(index) {
        Some(&id) => Ok(vec![id]),
        None => Err(ExperimentError::logs(
            "index of the run",
            index.to_string(),
            format!("0 to {}", ids.len().saturating_sub(1)),
            "the order has no more runs",
        )),
    }
}

fn report(path: PathBuf, load: Load, record: &Record) -> RunReport {
    let is_start = |event: &Event| matches!(event.kind, EventKind::PeriodStart { .. });
    let mut events = record.events.clone();
    events.retain(|event| !is_start(event));
    RunReport {
        path,
        load,
        standing_share: record.y.rows().into_iter().map(standing_share).collect(),
        events,
    }
}
