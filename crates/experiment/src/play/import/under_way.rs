//! Import under way: recordings one by one, their runs named, looked at and written.

use std::collections::BTreeMap;
use std::path::Path;

use frfid_files::{Log, LogMap, read_log, sha256_file};
use frfid_signals::{Record, RunId, RunKind};

use crate::error::ExperimentError;
use crate::play::import::judged::{
    check_gains, check_measured, check_place, check_reference, doubt,
};
use crate::play::import::plan_clock::{followed, on_plan_clock, times_of};
use crate::play::import::player_filter::player_filter;
use crate::play::import::sought::{FoundRun, SoughtRuns};
use crate::play::import::{ImportSummary, ImportedRun, not_recognised};
use crate::run::folder::Writer;
use crate::run::load::Load;
use crate::run::planned_runs::PlannedRuns;
use crate::run::provenance::Metadata;

/// An import under way.
pub(super) struct Import<'a> {
    planned: &'a PlannedRuns,
    writer: Writer<'a>,
    /// Runs of each reference that were found so far.
    counts: BTreeMap<RunId, usize>,
    summary: ImportSummary,
    first_error: Option<ExperimentError>,
    /// Recordings that could be read.
    n_read: usize,
    /// One filter is told once.
    filter_is_told: bool,
}

impl<'a> Import<'a> {
    pub(super) fn new(planned: &'a PlannedRuns, writer: Writer<'a>) -> Self {
        Self {
            planned,
            writer,
            counts: BTreeMap::new(),
            summary: ImportSummary::default(),
            first_error: None,
            n_read: 0,
            filter_is_told: false,
        }
    }

    /// Takes the runs of one recording.
    pub(super) fn take(
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
        let flaws = self.look(id, &record)?;
        let told = ImportedRun {
            flaws,
            ..imported(id, found, recording, &record)
        };
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

    /// What is wrong with a record: limits, places, holes; and once what filter the player has.
    fn look(&mut self, id: RunId, record: &Record) -> Result<Vec<String>, ExperimentError> {
        let experiment = &self.planned.experiment;
        let run = self.planned.run(id)?;
        let load = Load::of(record, &run.start_rad, &experiment.pose_rad);
        let exceeded = experiment.limits.exceeded(&load.peaks);
        let mut flaws: Vec<String> = exceeded.iter().map(ToString::to_string).collect();
        self.summary.excesses.extend(exceeded);
        let measured = check_measured(record, &experiment.joint_names);
        let placed = check_place(record, &run, experiment);
        let wrong = [measured.err(), placed.err()].into_iter().flatten();
        flaws.extend(wrong.map(|error| error.to_string()));
        if flaws.is_empty() && !self.filter_is_told {
            let told = player_filter(record, &run, &experiment.plan);
            self.filter_is_told = told.is_some();
            self.summary.warnings.extend(told);
        }
        Ok(flaws)
    }

    pub(super) fn finish(mut self) -> Result<ImportSummary, ExperimentError> {
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
        flaws: Vec::new(),
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
