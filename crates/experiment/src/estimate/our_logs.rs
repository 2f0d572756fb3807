//! Our own logs as records: everything needed to estimate from them stands in the files themselves.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::iter::zip;
use std::path::{Path, PathBuf};

use frfid_files::{
    FORMATS, FileError, Format, Loss, RunLabel, is_bag_folder, read_run, read_run_label, sha256_hex,
};
use frfid_signals::RunId;

use crate::description::estimate::EstimateTable;
use crate::description::text::TomlText;
use crate::error::ExperimentError;
use crate::estimate::gather::Gathered;
use crate::estimate::majority::majority;
use crate::estimate::outcome::{Inventory, Outcome, log_hashes};
use crate::estimate::records::{Recorded, Records};
use crate::experiment::Experiment;
use crate::run::parallel::Progress;
use crate::run::provenance::{CONFIG, DESIGN, PLAN};

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
    let has_ending = |path: &Path| FORMATS[1..].iter().any(|format: &Format| format.has(path));
    let is_others = |path: &&PathBuf| is_bag_folder(path) || has_ending(path);
    let other = paths.iter().find(is_others);
    other.map_or(Ok(()), |other| Err(no_map(other)))
}

fn no_map(recording: &Path) -> ExperimentError {
    ExperimentError::logs(
        "recordings",
        format!("{}, which frfid did not make", recording.display()),
        "which signal is which",
        "give a log map: --map, or --u and --y with their units; frfid inspect FILE shows what is in it and guesses one",
    )
}

/// Run files of one plan.
struct OurLogs {
    paths: Vec<PathBuf>,
    runs: Vec<RunId>,
    /// The first description that is whole, under the name by which its faults are reported.
    description: Option<TomlText>,
    /// Files that are not used, with the reason.
    unused: Vec<(PathBuf, String)>,
}

impl Records for OurLogs {
    fn runs(&self) -> &[RunId] {
        &self.runs
    }

    fn records(&self, places: &[usize]) -> Result<Vec<Recorded<'_>>, ExperimentError> {
        let recorded = |&place: &usize| {
            let (run, losses) = read_run(&self.paths[place])?;
            Ok((Cow::Owned(run.record), losses))
        };
        places.iter().map(recorded).collect()
    }
}

impl OurLogs {
    /// Reads the label of every file; what most of them agree on is kept, the odd ones out are not
    /// used.
    fn read(paths: &[PathBuf]) -> Result<Self, ExperimentError> {
        let (mut labelled, mut unused, mut first_error) = (Vec::new(), Vec::new(), None);
        for path in paths {
            match read_run_label(path) {
                Ok(label) => labelled.push((path.clone(), label)),
                Err(stopped @ FileError::Stopped { .. }) => return Err(stopped.into()),
                Err(error) => {
                    unused.push((path.clone(), error.to_string()));
                    first_error.get_or_insert(error);
                }
            }
        }
        match first_error {
            Some(error) if labelled.is_empty() => Err(error.into()),
            _ => Self::of_majority(labelled, unused),
        }
    }

    /// The files that come from what most of them come from.
    fn of_majority(
        labelled: Vec<(PathBuf, RunLabel)>,
        mut unused: Vec<(PathBuf, String)>,
    ) -> Result<Self, ExperimentError> {
        let origins: Vec<Origin> = labelled
            .iter()
            .map(|(_, label)| Origin::of(label))
            .collect();
        let kept = believed(&origins).ok_or_else(|| no_majority(&labelled, &origins))?;
        let mut logs = Self {
            paths: Vec::new(),
            runs: Vec::new(),
            description: None,
            unused: Vec::new(),
        };
        for ((path, label), origin) in zip(labelled, &origins) {
            match origin.difference(&origins[kept]) {
                None => logs.add(&path, label),
                Some(difference) => unused.push((path, difference)),
            }
        }
        Ok(Self { unused, ..logs })
    }

    fn add(&mut self, path: &Path, label: RunLabel) {
        self.paths.push(path.to_owned());
        self.runs.push(label.run);
        let is_first = self.description.is_none();
        if let Some(text) = description(label).filter(|_| is_first) {
            self.description = Some(TomlText::travelled_in(path, text));
        }
    }

    /// The description that travelled with the runs.
    fn experiment(&self) -> Result<Experiment, ExperimentError> {
        let source = self.description.clone().ok_or_else(no_description)?;
        Ok(Experiment::travelled(source)?)
    }

    /// What is there and what is not, losses by the names of their files.
    fn inventory(&self, gathered: &Gathered) -> Inventory {
        let lost = self.losses_by_path(gathered);
        let flawed: BTreeSet<&PathBuf> = lost.iter().map(|(path, _)| *path).collect();
        let lost = lost.iter();
        let lost = lost.map(|(path, loss)| format!("{}: {loss}", path.display()));
        let unused = self.unused.iter();
        let unused = unused.map(|(path, reason)| format!("{}: not used: {reason}", path.display()));
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

/// What a run was made with: runs that differ in it do not belong together.
struct Origin {
    design: String,
    config: String,
    sample_time_s: f64,
    /// Whether the hashes are those of the plan and the description beside them.
    is_sealed: bool,
}

/// Place of an origin that most of the sealed ones share, or most of all where none is sealed.
fn believed(origins: &[Origin]) -> Option<usize> {
    let mut candidates: Vec<usize> = (0..origins.len()).collect();
    if origins.iter().any(|origin| origin.is_sealed) {
        candidates.retain(|place| origins[*place].is_sealed);
    }
    let are_alike = |a: &usize, b: &usize| origins[*a].difference(&origins[*b]).is_none();
    majority(&candidates, are_alike).map(|place| candidates[place])
}

impl Origin {
    fn of(label: &RunLabel) -> Self {
        let hash = |key: &str| label.metadata.get(key).cloned().unwrap_or_default();
        Self {
            design: hash(DESIGN),
            config: hash(CONFIG),
            sample_time_s: label.sample_time_s,
            is_sealed: is_sealed(label),
        }
    }

    /// In what a run differs from the others, in words; `None` where it does not.
    fn difference(&self, others: &Self) -> Option<String> {
        if self.sample_time_s != others.sample_time_s {
            let (found, needed) = (self.sample_time_s, others.sample_time_s);
            return Some(format!(
                "sampled every {found} s, the others every {needed} s"
            ));
        }
        self.other_hash(others).map(|other| match self.is_sealed {
            true => other,
            false => format!("{other}; its metadata record frfid is damaged"),
        })
    }

    fn other_hash(&self, others: &Self) -> Option<String> {
        if self.design != others.design {
            return Some(other_hash("plan", &self.design, &others.design));
        }
        (self.config != others.config)
            .then(|| other_hash("experiment or robot", &self.config, &others.config))
    }
}

/// Whether the hashes of a run are those of the plan and the description that travel with it. The
/// record that they stand in has no checksum of its own.
fn is_sealed(label: &RunLabel) -> bool {
    let is_hash_of = |key: &str, text: Option<&String>| {
        text.is_none_or(|text| label.metadata.get(key) == Some(&sha256_hex(text.as_bytes())))
    };
    let description = label.experiment_toml.as_ref();
    is_hash_of(DESIGN, label.metadata.get(PLAN))
        && is_hash_of(CONFIG, description.filter(|text| !text.is_empty()))
}

/// Says by the first digits of their hashes that something is not the same.
fn other_hash(what: &str, found: &str, needed: &str) -> String {
    let short = |hash: &str| match hash.get(..12) {
        Some(short) => short.to_owned(),
        None => "no hash".to_owned(),
    };
    let (found, needed) = (short(found), short(needed));
    format!("of another {what} ({found}) than the others ({needed})")
}

/// No more than half of the files come from the same plan: the first two that do not are named.
fn no_majority(labelled: &[(PathBuf, RunLabel)], origins: &[Origin]) -> ExperimentError {
    let pairs = zip(labelled, origins).skip(1);
    let mut others =
        pairs.filter_map(|((path, _), origin)| Some((path, origin.difference(&origins[0])?)));
    let (path, difference) = others.next().expect("all alike would be a majority");
    ExperimentError::logs(
        "logs",
        format!(
            "{} {difference}, as {}",
            path.display(),
            labelled[0].0.display()
        ),
        "runs of one plan on one robot",
        "estimate the runs of one plan at a time",
    )
}

/// The description that travelled with a run, if it is the one that the run was made with.
fn description(label: RunLabel) -> Option<String> {
    let hash = label.metadata.get(CONFIG).cloned();
    let text = label.experiment_toml.filter(|text| !text.is_empty())?;
    let is_its_own = hash.is_none_or(|hash| hash == sha256_hex(text.as_bytes()));
    is_its_own.then_some(text)
}

fn no_description() -> ExperimentError {
    ExperimentError::logs(
        "experiment.toml in the logs",
        "none that is readable",
        "the description in at least one of them",
        "the attachment is damaged in every file; say which topic is which (--map)",
    )
}
