//! Iterative shaping with an audit trail on disk: every reference, record, FRF and error of every
//! iteration. What is there already is read back instead of being done again, and leads to the same
//! end.

use std::collections::BTreeMap;
use std::path::Path;

use frfid_estimate::{Driver, Iteration, Shaped, Shaper};
use frfid_files::{
    FileError, Overwrite, check_free, create_folder, read_run, sha256_file, sha256_hex,
    write_bytes, write_result, write_run,
};
use frfid_signals::{Record, Run, RunId, Testbed};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::folder::run_file;
use crate::run::parallel::{Progress, Steps, for_each};
use crate::run::provenance::{CONFIG, DESIGN};
use crate::shape::iteration_files::{IterationFiles, NAMES};
use crate::shape::report::{FILE, IterationReport, ShapeReport};

/// FRF of the best iteration, in the folder of the shaping.
const BEST: &str = "frf.json";
/// What to do where a folder does not hold what it should.
const ANEW: &str =
    "choose another folder, or say that it may be replaced (--force, in Python overwrite=True)";
/// Key of the hash of the reference that was applied, in the metadata of a run.
const REFERENCE: &str = "reference_sha256";

/// How a shaping is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShapeFolderOptions {
    /// Runs at once; 0: one for each core. A testbed that can do one run at a time sees to that
    /// itself.
    pub jobs: usize,
    /// What to do with a folder that holds another shaping: with [`Overwrite::Replace`] it begins
    /// anew.
    pub overwrite: Overwrite,
}

/// Shapes the chirp of `experiment` on `testbed` (the description's own model if `None`) with
/// everything that is applied and measured in `folder`; an interrupted shaping goes on where it
/// stopped.
///
/// # Errors
/// [`ExperimentError`]: a description without what shaping needs, a folder that holds something
/// else, a run that fails, a target that does not respond, a disk that is full, or an interruption.
/// Runs that are complete by then stay.
pub fn shape_to_folder(
    experiment: &Experiment,
    testbed: Option<&dyn Testbed>,
    folder: &Path,
    options: &ShapeFolderOptions,
    progress: Progress,
) -> Result<ShapeReport, ExperimentError> {
    let (shaper, shape_options) = experiment.shaper()?;
    let model = if testbed.is_none() {
        Some(experiment.testbed())
    } else {
        None
    };
    let testbed = testbed
        .or(model.as_deref())
        .expect("one of the two was given");
    let report = ShapeReport::begun(experiment, &shape_options);
    let trail = Trail::open(experiment, folder, options, report)?;
    let mut player = Player {
        trail,
        testbed,
        progress,
    };
    let shaped = shaper.drive(&mut player)?;
    player.trail.finish(&shaped)
}

/// Does the runs of a shaping and keeps them on its trail.
struct Player<'a> {
    trail: Trail<'a>,
    testbed: &'a dyn Testbed,
    progress: Progress<'a>,
}

impl Driver for Player<'_> {
    type Error = ExperimentError;

    fn records(&mut self, shaper: &Shaper) -> Result<Vec<Record>, ExperimentError> {
        self.trail.records(shaper, self.testbed, self.progress)
    }

    fn iterated(&mut self, iteration: &Iteration) -> Result<bool, ExperimentError> {
        self.trail.keep(iteration)?;
        Ok(true)
    }
}

/// The folder of a shaping.
struct Trail<'a> {
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
    fn open(
        experiment: &'a Experiment,
        folder: &'a Path,
        options: &ShapeFolderOptions,
        report: ShapeReport,
    ) -> Result<Self, ExperimentError> {
        let files = IterationFiles::new(experiment)?;
        let before = if options.overwrite == Overwrite::Replace {
            clear(folder)?;
            None
        } else {
            ShapeReport::load(folder)?
        };
        match &before {
            Some(before) => check_same(folder, before, &report)?,
            None => [BEST, &iteration_name(1)]
                .iter()
                .try_for_each(|name| check_free(&folder.join(name), options.overwrite))?,
        }
        create_folder(folder)?;
        let trail = Self {
            experiment,
            folder,
            jobs: options.jobs,
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
    fn records(
        &self,
        shaper: &Shaper,
        testbed: &dyn Testbed,
        progress: Progress,
    ) -> Result<Vec<Record>, ExperimentError> {
        let (runs, iteration) = (shaper.runs(), shaper.number());
        let folder = self.folder.join(iteration_name(iteration));
        create_folder(&folder)?;
        let path_of = |id: RunId| folder.join(format!("{id}.mcap"));
        let mut records = BTreeMap::new();
        for run in &runs {
            if let Some(record) = self.recorded(&path_of(run.id), run)? {
                records.insert(run.id, record);
            }
        }
        let open: Vec<&Run> = runs
            .iter()
            .filter(|run| !records.contains_key(&run.id))
            .collect();
        let steps = Steps {
            progress,
            before: (iteration - 1) * runs.len() + records.len(),
            total: self.report.n_iterations * runs.len(),
        };
        let done = for_each(&open, self.jobs, steps, |&run| {
            let record = testbed.run(run)?;
            let file = run_file(self.experiment, run.id, record, self.metadata_of(run))?;
            write_run(&path_of(run.id), Overwrite::Resume, &file)?;
            Ok((run.id, file.record))
        });
        records.extend(done.map_err(|error| match error {
            ExperimentError::Interrupted { .. } => {
                ExperimentError::ShapingInterrupted { iteration }
            }
            error => error,
        })?);
        Ok(records.into_values().collect())
    }

    /// The record of a run that was done before; `None` if it was not.
    fn recorded(&self, path: &Path, run: &Run) -> Result<Option<Record>, ExperimentError> {
        if path.symlink_metadata().is_err() {
            return Ok(None);
        }
        let (file, losses) = read_run(path)?;
        if let Some(loss) = losses.first() {
            let advice = "delete it, and its run is done again";
            return Err(unfit(path, loss.to_string(), "a whole recording", advice));
        }
        let expected = self.metadata_of(run);
        let differs = [CONFIG, REFERENCE]
            .into_iter()
            .find(|&key| file.metadata.get(key) != expected.get(key));
        match differs {
            Some(key) => Err(unfit(
                path,
                format!("another {key}"),
                "the run that follows from the iterations before it",
                ANEW,
            )),
            None => Ok(Some(file.record)),
        }
    }

    /// The provenance of a run. The design differs from iteration to iteration: their runs do not
    /// belong into one estimate.
    fn metadata_of(&self, run: &Run) -> BTreeMap<String, String> {
        let mut metadata = self.files.metadata.clone();
        let design = format!(
            "{:?} iteration {}",
            metadata.get(DESIGN),
            run.id.realization
        );
        metadata.insert(DESIGN.into(), sha256_hex(design.as_bytes()));
        let reference: Vec<u8> = run.reference.iter().flat_map(|r| r.to_le_bytes()).collect();
        metadata.insert(REFERENCE.into(), sha256_hex(&reference));
        metadata
    }

    /// Writes what an iteration says, and adds it to the report.
    fn keep(&mut self, iteration: &Iteration) -> Result<(), ExperimentError> {
        let mut report = IterationReport::of(iteration);
        let frf = match iteration
            .estimate
            .is_some()
            .then(|| self.files.frf(&iteration.records))
        {
            Some(Err(error)) => {
                report
                    .notes
                    .push(format!("no FRF from torque to velocity: {error}"));
                None
            }
            Some(Ok(frf)) => Some(frf),
            None => None,
        };
        let known = self
            .before
            .as_ref()
            .and_then(|before| before.iterations.get(iteration.number - 1));
        let folder = self.folder.join(iteration_name(iteration.number));
        let is_whole =
            |known: &&IterationReport| known.files.keys().all(|name| folder.join(name).exists());
        report.files = match known.filter(is_whole) {
            Some(known) => known.files.clone(),
            None => self.files.write(iteration, frf, &folder)?,
        };
        self.report.iterations.push(report);
        let n_before = self
            .before
            .as_ref()
            .map_or(0, |before| before.iterations.len());
        if self.report.iterations.len() > n_before {
            self.write_report()
        } else {
            Ok(())
        }
    }

    /// Writes the FRF of the best iteration and the end of the report.
    fn finish(mut self, shaped: &Shaped) -> Result<ShapeReport, ExperimentError> {
        let (path, best) = (self.folder.join(BEST), &shaped.best);
        let frf = self.files.frf(&best.records)?;
        let high_hz = frf.frequency_hz.last().copied().unwrap_or(f64::INFINITY);
        self.report
            .finish(shaped, high_hz, self.files.condition_check(&frf, best));
        let result = self.files.result(
            frf,
            best,
            &self.folder.join(iteration_name(best.number)),
            self.report.checks.clone(),
        )?;
        write_result(&path, Overwrite::Replace, &result)?;
        self.report.frf_sha256 = Some(sha256_file(&path)?);
        self.write_report()?;
        Ok(self.report)
    }

    fn write_report(&self) -> Result<(), ExperimentError> {
        Ok(write_bytes(
            &self.folder.join(FILE),
            Overwrite::Replace,
            self.report.to_json().as_bytes(),
        )?)
    }
}

/// Folder of an iteration.
fn iteration_name(number: usize) -> String {
    format!("iteration_{number:02}")
}

fn unfit(
    path: &Path,
    found: String,
    needed: &'static str,
    advice: &'static str,
) -> ExperimentError {
    ExperimentError::Trail {
        path: path.to_owned(),
        found,
        needed,
        advice,
    }
}

/// Refuses a folder that holds another shaping, or files that were changed since they were written.
fn check_same(
    folder: &Path,
    before: &ShapeReport,
    now: &ShapeReport,
) -> Result<(), ExperimentError> {
    if before.config_sha256 != now.config_sha256 {
        return Err(unfit(
            &folder.join(FILE),
            "the shaping of another description".into(),
            "one of this description",
            ANEW,
        ));
    }
    let best = before
        .frf_sha256
        .iter()
        .map(|hash| (folder.join(BEST), hash));
    let of_iteration = |iteration: &'_ IterationReport| {
        let folder = folder.join(iteration_name(iteration.number));
        iteration
            .files
            .iter()
            .map(|(name, hash)| (folder.join(name), hash.clone()))
            .collect::<Vec<_>>()
    };
    let files = best
        .map(|(path, hash)| (path, hash.clone()))
        .chain(before.iterations.iter().flat_map(of_iteration));
    for (path, hash) in files.filter(|(path, _)| path.exists()) {
        if sha256_file(&path)? != hash {
            let advice = "put the original back; or delete it, and it is made again";
            return Err(unfit(
                &path,
                "another content".into(),
                "the file as it was written",
                advice,
            ));
        }
    }
    Ok(())
}

/// Removes the best FRF and the iterations of an earlier shaping, of their folders what frfid wrote
/// into them.
fn clear(folder: &Path) -> Result<(), FileError> {
    let remove = |path: &Path| {
        std::fs::remove_file(path).map_err(|error| FileError::Io {
            path: path.to_owned(),
            action: "remove",
            reason: error.to_string(),
        })
    };
    if folder.join(BEST).exists() {
        remove(&folder.join(BEST))?;
    }
    for number in 1.. {
        let iteration = folder.join(iteration_name(number));
        let Ok(entries) = std::fs::read_dir(&iteration) else {
            break;
        };
        for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let name = name.strip_suffix(".part").unwrap_or(&name);
            if name.ends_with(".mcap") || NAMES.contains(&name) {
                remove(&path)?;
            }
        }
        std::fs::remove_dir(&iteration).ok(); // stays where somebody keeps files of his own in it
    }
    Ok(())
}
