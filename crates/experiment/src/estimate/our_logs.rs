//! Our own logs as records: everything needed to estimate from them stands in the files themselves.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use frfid_files::{FileError, Loss, RunLabel, read_run, read_run_label};
use frfid_signals::{Record, RunId};

use crate::description::estimate::EstimateTable;
use crate::description::text::TomlText;
use crate::error::ExperimentError;
use crate::estimate::gather::{Gathered, Records};
use crate::estimate::outcome::{Inventory, Outcome, log_hashes};
use crate::experiment::Experiment;
use crate::run::parallel::Progress;
use crate::run::provenance::DESIGN;

/// The files among `paths` in the order given, the MCAP files of a folder by name, each file once.
///
/// # Errors
/// [`ExperimentError::File`] for a path that does not exist or cannot be listed,
/// [`ExperimentError::Logs`] for none.
pub(crate) fn find_logs(paths: &[PathBuf]) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut found: Vec<PathBuf> = Vec::new();
    for path in paths {
        if std::fs::metadata(path)
            .map_err(|error| unreadable(path, &error))?
            .is_dir()
        {
            found.extend(logs_inside(path)?);
        } else {
            found.push(path.clone());
        }
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

/// The MCAP files of a folder, by name.
fn logs_inside(folder: &Path) -> Result<BTreeSet<PathBuf>, ExperimentError> {
    let mut inside = BTreeSet::new();
    for entry in std::fs::read_dir(folder).map_err(|error| unreadable(folder, &error))? {
        let path = entry.map_err(|error| unreadable(folder, &error))?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == "mcap")
        {
            inside.insert(path);
        }
    }
    Ok(inside)
}

fn unreadable(path: &Path, error: &std::io::Error) -> FileError {
    let (action, reason) = ("read", error.to_string());
    FileError::Io {
        path: path.to_owned(),
        action,
        reason,
    }
}

/// Estimates the FRF from the files of one plan, in any order; `options` replaces the `[estimate]`
/// table that travelled with them. Memory is that of `jobs` records and of the spectra, whatever
/// the length of the campaign.
///
/// # Errors
/// [`ExperimentError`]: no file is readable, files of different plans, a run twice, or too few
/// runs.
pub(crate) fn estimate_our_logs(
    paths: &[PathBuf],
    options: Option<&EstimateTable>,
    jobs: usize,
    progress: Progress,
) -> Result<Outcome, ExperimentError> {
    let logs = OurLogs::read(paths)?;
    let experiment = logs.experiment()?;
    let way = options.unwrap_or(&experiment.config.estimate);
    let gathered = experiment.gather(&logs, &[way], jobs, progress)?;
    let inventory = logs.inventory(&gathered);
    let outcomes = experiment.conclude(gathered, &inventory);
    let mut outcome = outcomes.into_iter().next().expect("one for each way");
    log_hashes(paths, &mut outcome.result.provenance)?;
    Ok(outcome)
}

/// Run files of one plan.
struct OurLogs {
    paths: Vec<PathBuf>,
    runs: Vec<RunId>,
    /// The first description that is whole, under the name by which its faults are reported.
    description: Option<TomlText>,
    /// Files that could not be read at all, with the reason.
    unreadable: Vec<(PathBuf, String)>,
}

impl Records for OurLogs {
    fn runs(&self) -> &[RunId] {
        &self.runs
    }

    fn record(&self, place: usize) -> Result<(Cow<'_, Record>, Vec<Loss>), ExperimentError> {
        let (run, losses) = read_run(&self.paths[place])?;
        Ok((Cow::Owned(run.record), losses))
    }
}

impl OurLogs {
    /// Reads the label of every file; all must be of one design.
    fn read(paths: &[PathBuf]) -> Result<Self, ExperimentError> {
        let mut logs = Self {
            paths: Vec::new(),
            runs: Vec::new(),
            description: None,
            unreadable: Vec::new(),
        };
        let (mut design, mut first_error) = (None, None);
        for path in paths {
            match read_run_label(path) {
                Ok(label) => {
                    check_design(path, &label, &mut design)?;
                    logs.add(path, label);
                }
                Err(error) => {
                    logs.unreadable.push((path.clone(), error.to_string()));
                    first_error.get_or_insert(error);
                }
            }
        }
        match first_error {
            Some(error) if logs.runs.is_empty() => Err(error.into()),
            _ => Ok(logs),
        }
    }

    fn add(&mut self, path: &Path, label: RunLabel) {
        self.paths.push(path.to_owned());
        self.runs.push(label.run);
        if let (None, Some(text)) = (&self.description, label.experiment_toml)
            && !text.is_empty()
        {
            let name = format!("experiment.toml in {}", path.display());
            self.description = Some(TomlText { name, text });
        }
    }

    /// The description that travelled with the runs.
    fn experiment(&self) -> Result<Experiment, ExperimentError> {
        let source = self.description.clone().ok_or_else(no_description)?;
        Ok(Experiment::new(source, Path::new(""))?)
    }

    /// What is there and what is not, losses by the names of their files.
    fn inventory(&self, gathered: &Gathered) -> Inventory {
        let by_path = |(place, loss): &'_ (usize, Loss)| (&self.paths[*place], loss.to_string());
        let mut lost: Vec<(&PathBuf, String)> = gathered.losses.iter().map(by_path).collect();
        lost.sort_by_key(|(path, _)| *path);
        let flawed: BTreeSet<&PathBuf> = lost.iter().map(|(path, _)| *path).collect();
        let unused = self.unreadable.iter();
        let unused = unused.map(|(path, error)| format!("{}: not used: {error}", path.display()));
        let lost = lost.iter();
        let lost = lost.map(|(path, loss)| format!("{}: {loss}", path.display()));
        Inventory {
            n_records: self.runs.len(),
            n_flawed: flawed.len(),
            losses: unused.chain(lost).collect(),
        }
    }
}

/// Refuses a file of another design than the first one, which is kept in `design`.
fn check_design(
    path: &Path,
    label: &RunLabel,
    design: &mut Option<String>,
) -> Result<(), ExperimentError> {
    let found = label.metadata.get(DESIGN).cloned().unwrap_or_default();
    let needed = design.get_or_insert_with(|| found.clone());
    if found == *needed {
        return Ok(());
    }
    let short = |hash: &str| hash.get(..12).unwrap_or(hash).to_owned();
    Err(ExperimentError::Logs {
        what: "design of the logs",
        found: format!("{} in {}", short(&found), path.display()),
        needed: format!("{}, as in the files before it", short(needed)),
        advice: "estimate the runs of one plan at a time",
    })
}

fn no_description() -> ExperimentError {
    ExperimentError::Logs {
        what: "experiment.toml in the logs",
        found: "none that is readable".into(),
        needed: "the description in at least one of them".into(),
        advice: "the attachment is damaged in every file; say which topic is which (--map)",
    }
}
