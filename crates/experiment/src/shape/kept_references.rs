//! References that are kept with their records: a run whose very reference is in the folder is not done again.

use std::path::{Path, PathBuf};

use frfid_files::{Overwrite, RunFile, create_folder, read_run, sha256_hex, write_run};
use frfid_signals::{Injection, Record, Run, Testbed, TestbedError};

use crate::error::ExperimentError;
use crate::run::provenance::metadata;
use crate::shape::iteration_files::iteration_name;

/// Key of the hash of the reference that was applied, in the metadata of a run.
pub(crate) const REFERENCE: &str = "reference_sha256";

/// A testbed around another that writes each record at once to `folder/iteration_NN/RUN.mcap`, and reads it back
/// where a run of the same reference is there already: for shapings without a description, whose references
/// follow from the records before.
pub struct KeptReferences<'a> {
    testbed: &'a dyn Testbed,
    folder: &'a Path,
    overwrite: Overwrite,
}

impl<'a> KeptReferences<'a> {
    /// The testbed whose records are kept in `folder`.
    ///
    /// # Errors
    /// [`ExperimentError::File`] for a folder that cannot be made.
    pub fn new(
        testbed: &'a dyn Testbed,
        folder: &'a Path,
        overwrite: Overwrite,
    ) -> Result<Self, ExperimentError> {
        create_folder(folder)?;
        Ok(Self {
            testbed,
            folder,
            overwrite,
        })
    }

    fn path_of(&self, run: &Run) -> PathBuf {
        let folder = self.folder.join(iteration_name(run.id.realization));
        folder.join(format!("{}.mcap", run.id))
    }

    /// The record of a run of this very reference.
    fn kept(&self, run: &Run) -> Option<Record> {
        let (file, losses) = read_run(&self.path_of(run)).ok()?;
        (losses.is_empty() && is_of(&file, run)).then_some(file.record)
    }

    fn done(&self, run: &Run) -> Result<Record, TestbedError> {
        let kept = self.keep(run, self.testbed.run(run)?);
        kept.map_err(|error| TestbedError::foreign(run.id, error))
    }

    fn keep(&self, run: &Run, record: Record) -> Result<Record, ExperimentError> {
        let path = self.path_of(run);
        create_folder(path.parent().unwrap_or(self.folder))?;
        let n_axes = record.u.nrows().max(record.y.nrows());
        let file = RunFile {
            joint_names: (1..=n_axes).map(|axis| format!("axis_{axis}")).collect(),
            run: run.id,
            injection: Injection::Velocity,
            record,
            metadata: metadata([(REFERENCE, reference_sha256(run))]),
            experiment_toml: String::new(),
        };
        write_run(&path, self.overwrite, &file)?;
        Ok(file.record)
    }
}

impl Testbed for KeptReferences<'_> {
    fn n_inputs(&self) -> usize {
        self.testbed.n_inputs()
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        self.kept(run).map_or_else(|| self.done(run), Ok)
    }
}

fn is_of(file: &RunFile, run: &Run) -> bool {
    file.metadata.get(REFERENCE) == Some(&reference_sha256(run))
}

/// SHA-256 of the samples of a reference.
pub(crate) fn reference_sha256(run: &Run) -> String {
    let reference = run.reference.iter().flat_map(|r| r.to_le_bytes());
    sha256_hex(&reference.collect::<Vec<u8>>())
}
