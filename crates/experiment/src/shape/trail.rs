//! Audit trail of a shaping on disk: runs, files of every iteration and the report, written as they
//! come and read back where they are there already.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use frfid_estimate::{Iteration, Shaped, Shaper};
use frfid_files::{
    Overwrite, check_free, create_folder, read_run, sha256_file, sha256_hex, write_bytes,
    write_result, write_run,
};
use frfid_signals::{Frf, Record, Run, RunId, Testbed, TestbedError};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::guard::Guarded;
use crate::run::parallel::{Progress, Steps, for_each_group, kept_each, n_at_once};
use crate::run::provenance::{CONFIG, DESIGN, Metadata};
use crate::run::run_file::run_file;
use crate::shape::earlier::{check_same, clear};
use crate::shape::iteration_files::{BEST, IterationFiles, iteration_name};
use crate::shape::kept_references::{REFERENCE, reference_sha256};
use crate::shape::report::{ANOTHER_FOLDER, FILE, IterationReport, ShapeReport};

/// The folder of a shaping.
pub(crate) struct Trail<'a> {
    experiment: &'a Experiment,
    folder: &'a Path,
    jobs: usize,
    files: IterationFiles<'a>,
    /// What the folder held when it was opened.
    before: Option<ShapeReport>,
    report: ShapeReport,
}

impl<'a> Trail<'a> {
    /// Opens the folder: new, or of this very shaping with every file as it was written.
    pub(crate) fn open(
        experiment: &'a Experiment,
        folder: &'a Path,
        jobs: usize,
        overwrite: Overwrite,
        report: ShapeReport,
    ) -> Result<Self, ExperimentError> {
        let files = IterationFiles::new(experiment)?;
        let before = if overwrite == Overwrite::Replace {
            clear(folder)?;
            None
        } else {
            ShapeReport::load(folder)?
        };
        match &before {
            Some(before) => check_same(folder, before, &report)?,
            None => [BEST, &iteration_name(1)]
                .iter()
                .try_for_each(|name| check_free(&folder.join(name), overwrite))?,
        }
        create_folder(folder)?;
        let trail = Self {
            experiment,
            folder,
            jobs,
            files,
            before,
            report,
        };
        if trail.before.is_none() {
            trail.write_report()?; // from now on the folder is known to be ours
        }
        Ok(trail)
    }

    /// The records of the next iteration: those that are there already, and those of the runs that
    /// are done now.
    pub(crate) fn records(
        &self,
        shaper: &Shaper,
        testbed: &dyn Testbed,
        guard: Option<&Guarded>,
        progress: Progress,
    ) -> Result<Vec<Record>, ExperimentError> {
        let (runs, iteration) = (shaper.runs(), shaper.number());
        let folder = self.folder_of(iteration);
        create_folder(&folder)?;
        let mut records = self.records_in(&folder, &runs)?;
        for (run, record) in runs
            .iter()
            .filter_map(|run| Some((run, records.get(&run.id)?)))
        {
            guard.inspect(|guard| guard.see(run, record));
        }
        let mut open = runs.clone();
        open.retain(|run| !records.contains_key(&run.id));
        testbed.announce(&open.iter().collect::<Vec<_>>())?;
        let steps = Steps {
            progress,
            before: (iteration - 1) * runs.len() + records.len(),
            total: self.report.n_iterations * runs.len(),
        };
        let n_at_once = n_at_once(self.experiment, testbed)?;
        let done = for_each_group(&open, n_at_once, self.jobs, steps, |runs, _| {
            kept_each(runs, testbed, |run, record| {
                let record = self.written(run, record, &folder)?;
                Ok((run.id, record))
            })
        });
        records.extend(done.map_err(|error| in_iteration(iteration, error))?);
        Ok(records.into_values().collect())
    }

    /// The records of the runs that were done before.
    fn records_in(
        &self,
        folder: &Path,
        runs: &[Run],
    ) -> Result<BTreeMap<RunId, Record>, ExperimentError> {
        let mut records = BTreeMap::new();
        for run in runs {
            if let Some(record) = self.recorded(&path_of(run.id, folder), run)? {
                records.insert(run.id, record);
            }
        }
        Ok(records)
    }

    /// The record of a run that was done before; `None` if it was not.
    fn recorded(&self, path: &Path, run: &Run) -> Result<Option<Record>, ExperimentError> {
        if path.symlink_metadata().is_err() {
            return Ok(None);
        }
        let (file, losses) = read_run(path)?;
        if let Some(loss) = losses.first() {
            let advice = "delete it, and its run is done again";
            let found = loss.to_string();
            return Err(ExperimentError::trail(
                path,
                found,
                "a whole recording",
                advice,
            ));
        }
        let expected = self.metadata_of(run);
        let mut keys = [CONFIG, REFERENCE].into_iter();
        match keys.find(|&key| file.metadata.get(key) != expected.get(key)) {
            Some(key) => Err(ExperimentError::trail(
                path,
                format!("another {key}"),
                "the run that follows from the iterations before it",
                ANOTHER_FOLDER,
            )),
            None => Ok(Some(file.record)),
        }
    }

    /// Writes a run.
    fn written(&self, run: &Run, record: Record, folder: &Path) -> Result<Record, ExperimentError> {
        let sound = record.check();
        sound.map_err(|error| TestbedError::foreign(run.id, error))?;
        let file = run_file(self.experiment, run.id, record, self.metadata_of(run))?;
        write_run(&path_of(run.id, folder), Overwrite::Resume, &file)?;
        Ok(file.record)
    }

    /// The provenance of a run. The design differs from iteration to iteration: their runs do not
    /// belong into one estimate.
    fn metadata_of(&self, run: &Run) -> Metadata {
        let mut metadata = self.files.metadata.clone();
        let (design, iteration) = (metadata.get(DESIGN), run.id.realization);
        let design = format!("{design:?} iteration {iteration}");
        metadata.insert(DESIGN.into(), sha256_hex(design.as_bytes()));
        metadata.insert(REFERENCE.into(), reference_sha256(run));
        metadata
    }

    /// Writes what an iteration says, and adds it to the report.
    pub(crate) fn keep(&mut self, iteration: &Iteration) -> Result<(), ExperimentError> {
        let mut report = IterationReport::of(iteration);
        let frf = self.frf_of(iteration, &mut report.notes);
        let folder = self.folder_of(iteration.number);
        report.files = match self.files_before(iteration.number, &folder) {
            Some(known) => known.clone(),
            None => self.files.write(iteration, frf, &folder)?,
        };
        self.report.iterations.push(report);
        if self.report.iterations.len() > self.n_before() {
            self.write_report()?;
        }
        Ok(())
    }

    /// Number of iterations that the folder held when it was opened.
    fn n_before(&self) -> usize {
        let before = self.before.as_ref();
        before.map_or(0, |before| before.iterations.len())
    }

    /// The FRF from torque to velocity of an iteration whose runs went to their end, or a note why
    /// there is none.
    fn frf_of(&self, iteration: &Iteration, notes: &mut Vec<String>) -> Option<Frf> {
        iteration.estimate.as_ref()?;
        self.files
            .frf(&iteration.records)
            .inspect_err(|error| notes.push(format!("no FRF from torque to velocity: {error}")))
            .ok()
    }

    /// The files of an iteration with their hashes, if they were written before and are all there.
    fn files_before(&self, number: usize, folder: &Path) -> Option<&Metadata> {
        let known = self.before.as_ref()?.iterations.get(number - 1)?;
        let is_whole = known.files.keys().all(|name| folder.join(name).exists());
        is_whole.then_some(&known.files)
    }

    /// Writes the FRF of the best iteration and the end of the report.
    pub(crate) fn finish(mut self, shaped: &Shaped) -> Result<ShapeReport, ExperimentError> {
        let best = &shaped.best;
        let frf = self.files.frf(&best.records)?;
        let high_hz = frf.frequency_hz.last().copied().unwrap_or(f64::INFINITY);
        let condition = self.files.condition_check(&frf, best);
        self.report.finish(shaped, high_hz, condition);
        self.report.frf_sha256 = Some(self.write_best(frf, best)?);
        self.write_report()?;
        Ok(self.report)
    }

    /// Writes the FRF of the best iteration; returns the hash of its file.
    fn write_best(&self, frf: Frf, best: &Iteration) -> Result<String, ExperimentError> {
        let path = self.folder.join(BEST);
        let (runs, checks) = (self.folder_of(best.number), self.report.checks.clone());
        let result = self.files.result(frf, best, &runs, checks)?;
        write_result(&path, Overwrite::Replace, &result)?;
        Ok(sha256_file(&path)?)
    }

    fn folder_of(&self, iteration: usize) -> PathBuf {
        self.folder.join(iteration_name(iteration))
    }

    fn write_report(&self) -> Result<(), ExperimentError> {
        let (path, text) = (self.folder.join(FILE), self.report.to_json());
        Ok(write_bytes(&path, Overwrite::Replace, text.as_bytes())?)
    }
}

/// An error of the runs of an iteration: an interruption is one of the shaping.
fn in_iteration(iteration: usize, error: ExperimentError) -> ExperimentError {
    match error {
        ExperimentError::Interrupted { .. } => ExperimentError::ShapingInterrupted { iteration },
        error => error,
    }
}

fn path_of(run: RunId, folder: &Path) -> PathBuf {
    folder.join(format!("{run}.mcap"))
}
