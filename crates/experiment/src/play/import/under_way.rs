//! Import under way: recordings one by one, their runs named, looked at and written.

use std::collections::BTreeMap;
use std::path::Path;

use frfid_files::{Log, LogMap, read_log};
use frfid_signals::{Record, RunId, RunKind};
use ndarray::Array2;

use crate::error::ExperimentError;
use crate::play::import::judged::{
    check_gains, check_measured, check_place, check_reference, doubt,
};
use crate::play::import::plan_clock::{on_plan_clock, times_of};
use crate::play::import::player_filter::player_filter;
use crate::play::import::recognised::{Recognised, check_plan_id};
use crate::play::import::sought::{FoundRun, SoughtRuns};
use crate::play::import::source::Source;
use crate::play::import::{ImportSummary, ImportedRun, not_recognised};
use crate::run::folder::Writer;
use crate::run::load::Load;
use crate::run::planned_runs::PlannedRuns;

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

/// Where a run goes.
enum Place {
    /// To be written under this name.
    Free(RunId),
    /// It is there already.
    There,
    /// The plan has no more repetitions of it.
    None,
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
        let log = match self.read(recording, map) {
            Ok(log) => {
                self.n_read += 1;
                log
            }
            Err(error) => {
                self.summary.unused.push(error.to_string());
                self.first_error.get_or_insert(error);
                return Ok(());
            }
        };
        check_reference(&log, &self.planned.experiment)?;
        let told = log
            .warnings
            .iter()
            .map(|warning| format!("{name}: {warning}"));
        self.summary.warnings.extend(told);
        let (times_s, source) = (times_of(&log), Source::of(recording)?);
        let plan = &self.planned.experiment.plan;
        let recognised = Recognised::of(&log, &times_s, plan, sought);
        self.tell(&source, &recognised);
        let mut found = recognised.runs;
        found.sort_by(|a, b| start_s(a).total_cmp(&start_s(b)));
        for run in found {
            match doubt(&run, &log) {
                Some(doubt) => self.pass_over(&source, &doubt),
                None => self.keep(&run, &source, &log, &times_s)?,
            }
        }
        Ok(())
    }

    /// A recording of this plan.
    fn read(&self, recording: &Path, map: &LogMap) -> Result<Log, ExperimentError> {
        let log = read_log(recording, map)?;
        check_plan_id(&log, self.planned.plan_id()?)?;
        Ok(log)
    }

    /// Names a run, puts it on the plan's clock and writes it.
    fn keep(
        &mut self,
        found: &FoundRun,
        source: &Source,
        log: &Log,
        times_s: &[f64],
    ) -> Result<(), ExperimentError> {
        match check_gains(found, log, &self.planned.experiment) {
            Err(error) if found.id.kind == RunKind::Glide => {
                self.pass_over(source, &error.to_string());
                return Ok(());
            }
            checked => checked?,
        }
        let start_s = found.occurrence.alignment.start_s;
        match self.place_of(found.id, source, start_s) {
            Place::Free(id) => return self.write(id, found, source, (log, times_s)),
            Place::There => self.summary.n_skipped += 1,
            Place::None => {
                let many = format!("{} once more than the plan repeats it", found.id);
                self.pass_over(source, &format!("at {start_s:.3} s {many}"));
            }
        }
        Ok(())
    }

    /// Says what looks wrong with a recording and what of it is not used.
    fn tell(&mut self, source: &Source, recognised: &Recognised) {
        let name = source.path.display();
        let warnings = recognised.warnings.iter();
        let told = warnings.map(|warning| format!("{name}: {warning}"));
        self.summary.warnings.extend(told);
        for unused in &recognised.unused {
            self.pass_over(source, unused);
        }
    }

    /// Says what of a recording is not used.
    fn pass_over(&mut self, source: &Source, why: &str) {
        let name = source.path.display();
        self.summary.unused.push(format!("{name}: {why}"));
    }

    /// Writes a run under its name, on the plan's clock.
    fn write(
        &mut self,
        id: RunId,
        found: &FoundRun,
        source: &Source,
        (log, times_s): (&Log, &[f64]),
    ) -> Result<(), ExperimentError> {
        let record = on_plan_clock(log, times_s, found, &self.planned.experiment.plan);
        let told = ImportedRun {
            flaws: self.look(id, &record)?,
            ..imported(id, found, &source.path, &record)
        };
        let origin = source.provenance(&told);
        self.writer.write_with(id, record, origin)?;
        self.summary.imported.push(told);
        Ok(())
    }

    /// The place of a run among the repetitions of its reference: those that are there came from elsewhere, or are
    /// this very run.
    fn place_of(&mut self, first: RunId, source: &Source, start_s: f64) -> Place {
        while let Some(id) = self.next_of(first) {
            match self.writer.metadata_of(id) {
                None => return Place::Free(id),
                Some(there) if source.is_origin_of(&there, start_s) => return Place::There,
                Some(_) => {}
            }
        }
        Place::None
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
        let is_there = |id: &RunId| self.writer.metadata_of(*id).is_some();
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

fn is_lost(signal: &Array2<f64>, sample: usize) -> bool {
    let mut values = signal.column(sample).into_iter();
    values.any(|value| !value.is_finite())
}

fn start_s(run: &FoundRun) -> f64 {
    run.occurrence.alignment.start_s
}

/// What is told of a run.
fn imported(id: RunId, found: &FoundRun, recording: &Path, record: &Record) -> ImportedRun {
    let occurrence = &found.occurrence;
    let is_lost = |k: &usize| is_lost(&record.u, *k) || is_lost(&record.y, *k);
    ImportedRun {
        run: id.to_string(),
        recording: recording.into(),
        start_s: occurrence.alignment.start_s,
        clock_ppm: (occurrence.alignment.clock_ratio - 1.0) * 1e6,
        delay_s: found.delay_s,
        likeness: occurrence.likeness,
        rival: occurrence.rival,
        n_lost: (0..record.n_samples()).filter(is_lost).count(),
        stopped_s: occurrence.stopped_s,
        flaws: Vec::new(),
    }
}
