//! Layout of an export: which files are written where, in which order they are played.

use std::path::{Path, PathBuf};

use frfid_files::{
    Exported, FileError, OrderEntry, Overwrite, Rehearsal, check_free, create_folder, write_bytes,
    write_order,
};
use frfid_signals::RunId;

use crate::play::export::PlayOptions;

/// Name of the list of runs.
const ORDER: &str = "runs.csv";
/// Name of a file that holds every run.
const CAMPAIGN: &str = "campaign";

/// The files of an export.
pub(crate) struct Layout {
    /// One for each reference, or one for all of them.
    pub(crate) files: Vec<PathBuf>,
    /// The list of runs; none beside a single file.
    pub(crate) order: Option<PathBuf>,
    /// What goes with the format, and its text.
    companion: Option<(PathBuf, &'static str)>,
    is_campaign: bool,
}

impl Layout {
    /// The files for these references, none of which may be in the way.
    pub(crate) fn of(
        path: &Path,
        options: &PlayOptions,
        references: &[(RunId, usize)],
    ) -> Result<Self, FileError> {
        let layout = if options.format.is_ending_of(path) {
            Self::one_file(path, options, references.len())?
        } else {
            Self::folder(path, options, references)
        };
        layout.check_free(options.overwrite)?;
        Ok(layout)
    }

    fn one_file(path: &Path, options: &PlayOptions, n: usize) -> Result<Self, FileError> {
        check_one(path, n, options.is_campaign)?;
        Ok(Self {
            files: vec![path.into()],
            order: None,
            companion: None,
            is_campaign: options.is_campaign,
        })
    }

    fn folder(path: &Path, options: &PlayOptions, references: &[(RunId, usize)]) -> Self {
        let file = |name| path.join(format!("{name}.{}", options.format.suffix));
        let names = file_names(references, options.is_campaign);
        let companion = options.format.companion;
        Self {
            files: names.into_iter().map(file).collect(),
            order: Some(path.join(ORDER)),
            companion: companion.map(|(name, text)| (path.join(name), text)),
            is_campaign: options.is_campaign,
        }
    }

    fn check_free(&self, overwrite: Overwrite) -> Result<(), FileError> {
        let mut all = self.all();
        all.try_for_each(|file| check_free(file, overwrite))
    }

    /// Every file.
    fn all(&self) -> impl Iterator<Item = &PathBuf> {
        let companion = self.companion.iter().map(|(path, _)| path);
        self.files.iter().chain(&self.order).chain(companion)
    }

    /// Creates the folder, if it is one.
    pub(crate) fn create_folder(&self) -> Result<(), FileError> {
        let folder = self.order.as_deref().and_then(Path::parent);
        folder.map_or(Ok(()), create_folder)
    }

    /// Writes the list of runs and what goes with the format.
    pub(crate) fn write_order(
        &self,
        exported: &Exported,
        overwrite: Overwrite,
    ) -> Result<(), FileError> {
        self.write_companion(overwrite)?;
        let mut order = self.order.iter();
        order.try_for_each(|path| write_order(path, overwrite, &self.entries(exported)))
    }

    fn write_companion(&self, overwrite: Overwrite) -> Result<(), FileError> {
        let mut companion = self.companion.iter();
        companion.try_for_each(|(path, text)| write_bytes(path, overwrite, text.as_bytes()))
    }

    /// The runs in the order of play.
    fn entries(&self, exported: &Exported) -> Vec<OrderEntry> {
        let files = self.files.iter().cycle();
        let mut first_k = 0;
        let runs = exported.runs.iter().zip(files);
        let entries = runs.map(|(run, path)| {
            let entry = entry(run, path, first_k, exported.plan_id);
            if self.is_campaign {
                first_k += run.n_samples * run.n_repetitions;
            }
            entry
        });
        entries.collect()
    }
}

fn entry(run: &Rehearsal, path: &Path, first_k: usize, plan_id: u32) -> OrderEntry {
    let name = path.file_name().unwrap_or_default();
    OrderEntry {
        run: run.id.to_string(),
        n_repetitions: run.n_repetitions,
        file: name.to_string_lossy().into_owned(),
        first_k,
        n_samples: run.n_samples,
        run_first_k: run.first_sample,
        run_samples: run.run_samples,
        duration_s: run.duration_s,
        plan_id,
    }
}

/// Refuses several references for one file.
fn check_one(path: &Path, n_references: usize, is_campaign: bool) -> Result<(), FileError> {
    if n_references == 1 || is_campaign {
        return Ok(());
    }
    Err(too_few_files(path, n_references))
}

fn too_few_files(path: &Path, n_references: usize) -> FileError {
    let path = path.display();
    FileError::Shape {
        what: "output",
        found: format!("{path}, one file, for {n_references} references"),
        needed: "a folder, or --campaign (in Python campaign=True) for all runs in one file".into(),
    }
}

fn file_names(references: &[(RunId, usize)], is_campaign: bool) -> Vec<String> {
    if is_campaign {
        return vec![CAMPAIGN.to_owned()];
    }
    references.iter().map(|(id, _)| id.to_string()).collect()
}
