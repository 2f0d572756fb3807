//! Our own logs as records: everything needed to estimate from them stands in the files themselves.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use frfid_files::{FORMATS, Format, Loss, RunLabel, read_run, read_run_label};
use frfid_signals::RunId;

use crate::description::estimate::EstimateTable;
use crate::description::text::TomlText;
use crate::error::ExperimentError;
use crate::estimate::gather::{Gathered, Recorded, Records};
use crate::estimate::outcome::{Inventory, Outcome, log_hashes};
use crate::experiment::Experiment;
use crate::run::parallel::Progress;
use crate::run::provenance::DESIGN;

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
    refuse_others(paths)?;
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

/// Refuses files that by their names are no logs of ours, which are all of the first format.
fn refuse_others(paths: &[PathBuf]) -> Result<(), ExperimentError> {
    let is_others = |path: &&PathBuf| FORMATS[1..].iter().any(|format: &Format| format.has(path));
    let other = paths.iter().find(is_others);
    other.map_or(Ok(()), |other| Err(no_map(other)))
}

fn no_map(recording: &Path) -> ExperimentError {
    ExperimentError::logs(
        "recordings",
        format!("{}, which frfid did not make", recording.display()),
        "which signal is which",
        "give a log map: --map, or --u and --y with their units",
    )
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

    fn record(&self, place: usize) -> Result<Recorded<'_>, ExperimentError> {
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
            self.description = Some(TomlText::travelled_in(path, text));
        }
    }

    /// The description that travelled with the runs.
    fn experiment(&self) -> Result<Experiment, ExperimentError> {
        let source = self.description.clone().ok_or_else(no_description)?;
        Ok(Experiment::new(source, Path::new(""))?)
    }

    /// What is there and what is not, losses by the names of their files.
    fn inventory(&self, gathered: &Gathered) -> Inventory {
        let lost = self.losses_by_path(gathered);
        let flawed: BTreeSet<&PathBuf> = lost.iter().map(|(path, _)| *path).collect();
        let lost = lost.iter();
        let lost = lost.map(|(path, loss)| format!("{}: {loss}", path.display()));
        let unused = self.unreadable.iter();
        let unused = unused.map(|(path, error)| format!("{}: not used: {error}", path.display()));
        Inventory {
            n_records: self.runs.len(),
            n_flawed: flawed.len(),
            losses: unused.chain(lost).collect(),
        }
    }

    /// What was lost of each file, in the order of their paths.
    fn losses_by_path<'a>(&'a self, gathered: &'a Gathered) -> Vec<(&'a PathBuf, &'a Loss)> {
        let losses = gathered.losses.iter();
        let by_path = losses.map(|(place, loss)| (&self.paths[*place], loss));
        let mut by_path: Vec<_> = by_path.collect();
        by_path.sort_by_key(|(path, _)| *path);
        by_path
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
    Err(ExperimentError::logs(
        "design of the logs",
        format!("{} in {}", short(&found), path.display()),
        format!("{}, as in the files before it", short(needed)),
        "estimate the runs of one plan at a time",
    ))
}

/// The first digits of a hash.
fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}

fn no_description() -> ExperimentError {
    ExperimentError::logs(
        "experiment.toml in the logs",
        "none that is readable",
        "the description in at least one of them",
        "the attachment is damaged in every file; say which topic is which (--map)",
    )
}
