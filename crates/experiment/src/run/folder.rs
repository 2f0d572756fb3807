//! The runs of an order into a folder, one MCAP each; what is there already and belongs to it is
//! not done again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use frfid_files::{Overwrite, RunFile, create_folder, read_run, write_run};
use frfid_signals::{Event, EventKind, Plan, Record, RunId, RunKind, Testbed};
use serde::Serialize;

use crate::design::predict::Peaks;
use crate::error::ExperimentError;
use crate::estimate::strength::{OfRuns, Strength};
use crate::experiment::Experiment;
use crate::run::parallel::{Progress, run_all};
use crate::run::planned_runs::Order;
use crate::run::provenance::CONFIG;

/// How runs are done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunOptions {
    /// Runs at once; 0: one for each core.
    pub jobs: usize,
    /// Only the run at this place of the order, from 0: for job arrays.
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
    pub stopped_before: Vec<PathBuf>,
    /// How the axes were driven and moved in the runs done now; `None` of none.
    pub strength: Option<Strength>,
}

/// What came of one run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// Its file.
    pub path: PathBuf,
    /// Largest values.
    pub peaks: Peaks,
    /// Share of the samples at which the measured velocity is exactly zero, one for each axis: with
    /// an ideal sensor the time in which friction holds the joint.
    pub standing_share: Vec<f64>,
    /// Limits that were hit and stops, without the starts of periods.
    pub events: Vec<Event>,
}

/// Does the runs of `order` on `testbed` (the description's own model if `None`) and writes
/// `folder/RUN.mcap` for each.
///
/// # Errors
/// [`ExperimentError`]: an index beyond the order, a run that fails, a file in the way that is not
/// this run's, a disk that is full. Runs that are complete by then stay.
pub fn run_to_folder(
    order: &Order,
    testbed: Option<&dyn Testbed>,
    folder: &Path,
    options: &RunOptions,
    progress: Progress,
) -> Result<RunSummary, ExperimentError> {
    let ids = chosen(order, options.index)?;
    let experiment = &order.experiment;
    let metadata = experiment.provenance();
    let config_sha256 = metadata.get(CONFIG);
    let path_of = |id: RunId| folder.join(format!("{id}.mcap"));
    let mut stopped_before = Vec::new();
    let mut is_done = |id: &RunId| {
        let whole = read_run(&path_of(*id))
            .ok()
            .filter(|(_, losses)| losses.is_empty());
        let ours =
            whole.filter(|(file, _)| file.run == *id && file.metadata.get(CONFIG) == config_sha256);
        let Some((file, _)) = ours else { return false };
        if file.record.stopped_at_s().is_none() {
            return true;
        }
        let kept = options.overwrite != Overwrite::Replace;
        stopped_before.extend(kept.then(|| path_of(*id)));
        kept
    };
    let (done, open): (Vec<RunId>, Vec<RunId>) = ids.iter().partition(|id| is_done(id));
    let model = if testbed.is_none() {
        Some(experiment.testbed()?)
    } else {
        None
    };
    let testbed = testbed
        .or(model.as_deref())
        .expect("one of the two was given");
    let pose_rad = experiment.config.robot.pose();
    let written: Mutex<(Vec<RunReport>, OfRuns)> = Mutex::default();
    create_folder(folder)?;
    let progress_of_all = |now: usize, _: usize| progress(done.len() + now, ids.len());
    run_all(
        &open,
        &|id| order.run(id),
        testbed,
        options.jobs,
        &progress_of_all,
        &|run, record| {
            let file = run_file(experiment, run.id, record, metadata.clone())?;
            let peaks = Peaks::of(&file.record, &run.start_rad, &pose_rad);
            let report = report(path_of(run.id), peaks, &file.record);
            write_run(&report.path, options.overwrite, &file)?;
            let mut written = written.lock().expect("no holder of the lock panics");
            written.0.push(report);
            written.1.extend(
                experiment
                    .strength_of(run.id, &file.record)
                    .map(|strength| (run.id, strength)),
            );
            Ok(())
        },
    )?;
    let (mut written, strengths) = written.into_inner().expect("no holder of the lock panics");
    written.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(RunSummary {
        written,
        n_skipped: done.len(),
        stopped_before,
        strength: experiment.strength(strengths),
    })
}

/// All runs, or the one at `index`.
fn chosen(order: &Order, index: Option<usize>) -> Result<Vec<RunId>, ExperimentError> {
    let ids = order.run_ids();
    let Some(index) = index else { return Ok(ids) };
    match ids.get(index) {
        Some(&id) => Ok(vec![id]),
        None => Err(ExperimentError::Logs {
            what: "index of the run",
            found: index.to_string(),
            needed: format!("0 to {}", ids.len().saturating_sub(1)),
            advice: "the order has no more runs",
        }),
    }
}

/// A record with what belongs to it, ready to be written.
pub(crate) fn run_file(
    experiment: &Experiment,
    run: RunId,
    mut record: Record,
    metadata: BTreeMap<String, String>,
) -> Result<RunFile, ExperimentError> {
    record
        .events
        .extend(period_starts(&experiment.plan, run, &record)?);
    record.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    Ok(RunFile {
        joint_names: experiment.config.robot.joint_names(),
        run,
        injection: experiment.plan.injection,
        record,
        metadata,
        experiment_toml: experiment.to_toml(),
    })
}

/// The starts of the measured periods that the record reaches.
fn period_starts(plan: &Plan, id: RunId, record: &Record) -> Result<Vec<Event>, ExperimentError> {
    let period_samples = plan.period_samples()?;
    let periods = if id.kind == RunKind::Glide {
        0..0
    } else {
        0..plan.n_periods
    };
    let starts = periods.map(|period| (period, plan.lead_in_samples + period * period_samples));
    let reached = starts.filter(|(_, start)| *start < record.n_samples());
    Ok(reached
        .map(|(period, start)| Event {
            time_s: start as f64 * plan.sample_time_s,
            kind: EventKind::PeriodStart { period },
        })
        .collect())
}

fn report(path: PathBuf, peaks: Peaks, record: &Record) -> RunReport {
    let standing = |row: ndarray::ArrayView1<f64>| {
        row.iter().filter(|&&y| y == 0.0).count() as f64 / row.len().max(1) as f64
    };
    let is_start = |event: &&Event| matches!(event.kind, EventKind::PeriodStart { .. });
    RunReport {
        path,
        peaks,
        standing_share: record.y.rows().into_iter().map(standing).collect(),
        events: record
            .events
            .iter()
            .filter(|event| !is_start(event))
            .cloned()
            .collect(),
    }
}
