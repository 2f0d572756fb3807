//! From the runs of one plan, as files, to the FRF: everything needed stands in the files
//! themselves.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use frfid_files::{FileError, Loss, read_run, read_run_label};
use frfid_signals::{Event, EventKind, Plan, Record, RunId, RunKind};
use rayon::prelude::*;

use crate::description::estimate::EstimateTable;
use crate::description::text::Source;
use crate::design::predict::Peaks;
use crate::error::ExperimentError;
use crate::estimate::estimator::{Estimated, Estimator, Spectra};
use crate::estimate::strength::{OfRuns, Strength};
use crate::experiment::Experiment;
use crate::run::parallel::{Progress, in_pool};
use crate::run::provenance::DESIGN;

/// What the files of a plan give.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnLogs {
    /// The FRF, and the runs missing from it.
    pub estimated: Estimated,
    /// The description that travelled with the runs.
    pub experiment: Experiment,
    /// Number of files used.
    pub n_files: usize,
    /// Files that could not be read at all, with the reason.
    pub unreadable: Vec<(PathBuf, String)>,
    /// What was lost within files; the periods it hit were dropped.
    pub losses: Vec<(PathBuf, Loss)>,
    /// Largest values over all runs that were read without a loss.
    pub peaks: Option<Peaks>,
    /// How the axes were driven and moved in those runs.
    pub strength: Option<Strength>,
}

/// The files among `paths` in the order given, the MCAP files of a folder by name, each file once.
///
/// # Errors
/// [`ExperimentError::File`] for a path that does not exist or cannot be listed,
/// [`ExperimentError::Logs`] for none.
pub fn find_logs(paths: &[PathBuf]) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut found: Vec<PathBuf> = Vec::new();
    for path in paths {
        let failed = |error: std::io::Error| FileError::Io {
            path: path.clone(),
            action: "read",
            reason: error.to_string(),
        };
        if !std::fs::metadata(path).map_err(failed)?.is_dir() {
            found.push(path.clone());
            continue;
        }
        let mut inside = BTreeSet::new();
        for entry in std::fs::read_dir(path).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path
                .extension()
                .is_some_and(|extension| extension == "mcap")
            {
                inside.insert(path);
            }
        }
        found.extend(inside);
    }
    let mut seen = BTreeSet::new();
    found.retain(|path| seen.insert(path.clone()));
    if found.is_empty() {
        return Err(ExperimentError::Logs {
            what: "recordings",
            found: "no MCAP file".into(),
            needed: "at least one".into(),
            advice: "name files, or folders that hold them",
        });
    }
    Ok(found)
}

/// Estimates the FRF from the files of one plan, in any order; `options` replaces the `[estimate]`
/// table that travelled with them. Memory is that of `jobs` records and of the spectra, whatever
/// the length of the campaign.
///
/// # Errors
/// [`ExperimentError`]: no file is readable, files of different plans, a run twice, or too few
/// runs.
pub fn estimate_own(
    paths: &[PathBuf],
    options: Option<&EstimateTable>,
    jobs: usize,
    progress: Progress,
) -> Result<OwnLogs, ExperimentError> {
    let labels = Labels::read(paths)?;
    let experiment = labels.experiment()?;
    let mut estimator = Estimator::new(
        &experiment.plan,
        options.unwrap_or(&experiment.config.estimate),
    )?;
    let files = Files {
        experiment: &experiment,
        plan: &experiment.plan,
        pose_rad: experiment.config.robot.pose(),
        start_rad: experiment.plan.start_rad()?,
        total: paths.len(),
        read: AtomicUsize::new(0),
        found: Mutex::default(),
        progress,
    };
    in_pool(jobs, || {
        let glides = files.glides(labels.of_kind(RunKind::Glide))?;
        estimator.set_glides(&glides.iter().collect::<Vec<_>>())?;
        if estimator.learns_ripple() {
            estimator.learn_ripple(&files.learning(&labels)?)?;
        }
        labels
            .of_kind(RunKind::Excitation)
            .par_bridge()
            .try_for_each(|(path, id)| files.excited(path, id, &estimator))
    })?;
    let Found {
        spectra,
        mut losses,
        peaks,
        strengths,
    } = files
        .found
        .into_inner()
        .expect("no holder of the lock panics");
    losses.sort_by(|(a, _), (b, _)| a.cmp(b));
    let estimated = estimator.estimate(spectra)?;
    let (n_files, strength) = (labels.runs.len(), experiment.strength(strengths));
    Ok(OwnLogs {
        estimated,
        experiment,
        n_files,
        unreadable: labels.unreadable,
        losses,
        peaks,
        strength,
    })
}

/// Which file holds which run.
struct Labels {
    runs: Vec<(PathBuf, RunId)>,
    /// The first description that is whole, under the name by which its faults are told.
    description: Option<Source>,
    unreadable: Vec<(PathBuf, String)>,
}

impl Labels {
    /// Reads the label of every file; all must be of one design.
    fn read(paths: &[PathBuf]) -> Result<Self, ExperimentError> {
        let (mut runs, mut unreadable) = (Vec::new(), Vec::new());
        let (mut design, mut description, mut first_error) = (None, None, None);
        for path in paths {
            match read_run_label(path) {
                Ok(label) => {
                    let found = label.metadata.get(DESIGN).cloned().unwrap_or_default();
                    let needed = design.get_or_insert_with(|| found.clone());
                    if found != *needed {
                        return Err(other_design(path, &found, needed));
                    }
                    runs.push((path.clone(), label.run));
                    let name = || format!("experiment.toml in {}", path.display());
                    description = description.or_else(|| {
                        label
                            .experiment_toml
                            .filter(|text| !text.is_empty())
                            .map(|text| Source { name: name(), text })
                    });
                }
                Err(error) => {
                    unreadable.push((path.clone(), error.to_string()));
                    first_error.get_or_insert(error);
                }
            }
        }
        match first_error {
            Some(error) if runs.is_empty() => Err(error.into()),
            _ => Ok(Self {
                runs,
                description,
                unreadable,
            }),
        }
    }

    fn of_kind(&self, kind: RunKind) -> impl Iterator<Item = (&Path, RunId)> + Send {
        self.runs
            .iter()
            .filter(move |(_, id)| id.kind == kind)
            .map(|(path, id)| (path.as_path(), *id))
    }

    /// The description that travelled with the runs.
    fn experiment(&self) -> Result<Experiment, ExperimentError> {
        let source = self.description.clone().ok_or_else(no_description)?;
        Ok(Experiment::new(source, Path::new(""))?)
    }
}

fn no_description() -> ExperimentError {
    ExperimentError::Logs {
        what: "experiment.toml in the logs",
        found: "none that is readable".into(),
        needed: "the description in at least one of them".into(),
        advice: "the attachment is damaged in every file; say which topic is which (--map)",
    }
}

fn other_design(path: &Path, found: &str, needed: &str) -> ExperimentError {
    let short = |hash: &str| hash.get(..12).unwrap_or(hash).to_owned();
    ExperimentError::Logs {
        what: "design of the logs",
        found: format!("{} in {}", short(found), path.display()),
        needed: format!("{}, as in the files before it", short(needed)),
        advice: "estimate the runs of one plan at a time",
    }
}

/// What the files held.
#[derive(Default)]
struct Found {
    spectra: Spectra,
    losses: Vec<(PathBuf, Loss)>,
    peaks: Option<Peaks>,
    strengths: OfRuns,
}

/// The files while they are read, several at once.
struct Files<'a> {
    experiment: &'a Experiment,
    plan: &'a Plan,
    pose_rad: Vec<f64>,
    start_rad: Vec<f64>,
    total: usize,
    read: AtomicUsize,
    found: Mutex<Found>,
    progress: Progress<'a>,
}

impl Files<'_> {
    /// One record, with what was lost of it, by a stop too; told to `progress`.
    fn record(&self, path: &Path) -> Result<(Record, Vec<Loss>), ExperimentError> {
        let done = self.read.fetch_add(1, Ordering::Relaxed);
        if !(self.progress)(done, self.total) {
            return Err(ExperimentError::Interrupted {
                done,
                total: self.total,
            });
        }
        let (run, mut losses) = read_run(path)?;
        let mut found = self.found.lock().expect("no holder of the lock panics");
        if losses.is_empty() {
            let peaks = Peaks::of(&run.record, &self.start_rad, &self.pose_rad);
            Peaks::enlarge(&mut found.peaks, &peaks);
            found.strengths.extend(
                self.experiment
                    .strength_of(run.run, &run.record)
                    .map(|strength| (run.run, strength)),
            );
        }
        losses.extend(stop_of(&run.record, self.plan.run_samples()?));
        found
            .losses
            .extend(losses.iter().map(|loss| (path.to_owned(), loss.clone())));
        Ok((run.record, losses))
    }

    /// The whole records of the glides, by repetition.
    fn glides<'p>(
        &self,
        labels: impl Iterator<Item = (&'p Path, RunId)>,
    ) -> Result<Vec<Record>, ExperimentError> {
        let mut glides = Vec::new();
        for (path, id) in labels {
            let (record, losses) = self.record(path)?;
            if losses.is_empty() {
                glides.push((id, record));
            }
        }
        if glides.is_empty() && self.plan.n_glides > 0 {
            return Err(ExperimentError::Logs {
                what: "glide runs",
                found: "none that is readable and whole".into(),
                needed: format!("at least one of the plan's {}", self.plan.n_glides),
                advice: "without them nothing can be subtracted; add their files",
            });
        }
        glides.sort_by_key(|(id, _)| *id);
        Ok(glides.into_iter().map(|(_, record)| record).collect())
    }

    /// The whole records of one run of every experiment of the same realization, the first for
    /// which there are all.
    fn learning(&self, labels: &Labels) -> Result<Vec<(RunId, Record)>, ExperimentError> {
        let mut groups: BTreeMap<(usize, usize), Vec<(&Path, RunId)>> = BTreeMap::new();
        for (path, id) in labels.of_kind(RunKind::Excitation) {
            groups
                .entry((id.realization, id.repetition))
                .or_default()
                .push((path, id));
        }
        for group in groups
            .into_values()
            .filter(|group| group.len() == self.plan.n_experiments())
        {
            let read = group
                .into_iter()
                .map(|(path, id)| read_run(path).map(|(run, losses)| (id, run.record, losses)));
            let read = read.collect::<Result<Vec<_>, _>>()?;
            if read
                .iter()
                .all(|(_, record, losses)| losses.is_empty() && record.stopped_at_s().is_none())
            {
                return Ok(read
                    .into_iter()
                    .map(|(id, record, _)| (id, record))
                    .collect());
            }
        }
        Err(ExperimentError::Logs {
            what: "runs to learn the ripple from",
            found: "no realization of which every experiment is whole".into(),
            needed: "one run of every experiment of one realization".into(),
            advice: "add the missing files, or set glide_subtraction = \"time\"",
        })
    }

    /// The spectra of the whole periods of an excited run.
    fn excited(
        &self,
        path: &Path,
        id: RunId,
        estimator: &Estimator,
    ) -> Result<(), ExperimentError> {
        let (mut record, losses) = self.record(path)?;
        let period_samples = self.plan.period_samples()?;
        let sample = |time_s: f64| (time_s / self.plan.sample_time_s).round() as usize;
        let lost = |period: usize| {
            let from = self.plan.lead_in_samples + period * period_samples;
            let hits = |loss: &Loss| {
                sample(loss.from_s) < from + period_samples && sample(loss.to_s) > from
            };
            losses.iter().any(hits)
        };
        // lost samples lie in periods that are not used: a number in their place keeps the rest of
        // the record usable
        for signal in [
            Some(&mut record.u),
            Some(&mut record.y),
            record.r.as_mut(),
            record.position_rad.as_mut(),
        ] {
            signal
                .into_iter()
                .flatten()
                .filter(|value| !value.is_finite())
                .for_each(|value| *value = 0.0);
        }
        let spectra = estimator.spectra(id, &record, &lost)?;
        self.found
            .lock()
            .expect("no holder of the lock panics")
            .spectra
            .extend(spectra);
        Ok(())
    }
}

/// What a run that was stopped did not do, as a loss.
fn stop_of(record: &Record, run_samples: usize) -> Option<Loss> {
    let why = |event: &Event| match &event.kind {
        EventKind::Stopped { reason, .. } => Some(reason.clone()),
        _ => None,
    };
    let reason = record.events.iter().find_map(why)?;
    let time_s = |samples: usize| samples as f64 * record.sample_time_s;
    let (from_s, to_s) = (time_s(record.n_steady_samples()), time_s(run_samples));
    Some(Loss {
        topic: "run".into(),
        from_s,
        to_s,
        reason: format!("stopped: {reason}"),
    })
}
