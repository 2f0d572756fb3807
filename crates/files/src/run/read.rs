//! Reader of run files: bit for bit what was written, or NaN with a [`Loss`] that says where and
//! why.

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use frfid_signals::RunId;

use crate::budget::Budget;
use crate::error::FileError;
use crate::loss::{self, Damage, Loss};
use crate::mcap::chunk::Entry;
use crate::mcap::open::open_mcap;
use crate::mcap::read::{Part, scan, scan_file};
use crate::mcap::record::{Channel, Message};
use crate::mcap::write::START_NS;
use crate::run::header::{self, Origin};
use crate::run::samples::Samples;
use crate::run::write::{RunFile, RunStructure};

/// Reads a run of ours. Samples that are lost are NaN in the record and listed as [`Loss`], so that
/// periods they hit can be dropped; an empty list means that every sample and event is as it was
/// written.
///
/// # Errors
/// [`FileError::Io`]; [`FileError::Format`] if it is not an MCAP; [`FileError::Content`] if it is
/// not a run of ours, or cut before it says what it holds.
pub fn read_run(path: &Path) -> Result<(RunFile, Vec<Loss>), FileError> {
    read_from(open_mcap(path)?, path)
}

/// What a file says of its run outside of the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct RunLabel {
    /// Which run of the plan it is.
    pub run: RunId,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Provenance (the metadata record `frfid`).
    pub metadata: BTreeMap<String, String>,
    /// The experiment's description; `None` where the attachment is missing or damaged.
    pub experiment_toml: Option<String>,
}

/// Which run a file holds, where it comes from and which experiment it belongs to; the samples are
/// not read.
///
/// # Errors
/// As [`read_run`].
pub fn read_run_label(path: &Path) -> Result<RunLabel, FileError> {
    let (mut label, mut origin) = (None, Origin::default());
    scan_file(path, Part::Description, &mut |entry| {
        match origin.take(entry) {
            Some(Entry::Metadata { name, values }) if name == header::RUN => {
                label = Some(structure(&values, path)?);
            }
            _ => {}
        }
        Ok(())
    })?;
    let label = label.ok_or_else(|| not_a_run(path, WITHOUT_IT))?;
    Ok(RunLabel {
        run: label.run,
        sample_time_s: label.sample_time_s,
        metadata: origin.metadata,
        experiment_toml: origin.experiment_toml,
    })
}

/// Reads a run from bytes that go by the name `path`.
pub(crate) fn read_from<R: Read + Seek>(
    mut file: R,
    path: &Path,
) -> Result<(RunFile, Vec<Loss>), FileError> {
    let length = file
        .seek(SeekFrom::End(0))
        .map_err(FileError::cannot("read", path))?;
    let budget = Budget::of(path, length);
    let mut reading = Reading::default();
    let damages = scan(file, path, Part::All, &mut |entry| {
        reading.take(entry, path, &budget)
    })?;
    reading.finish(damages, path)
}

fn structure(values: &BTreeMap<String, String>, path: &Path) -> Result<RunStructure, FileError> {
    header::from_texts(values).map_err(|error: String| not_a_run(path, error))
}

/// What is found in place of the metadata record.
const WITHOUT_IT: &str = "an MCAP without it";

fn not_a_run(path: &Path, found: impl Into<String>) -> FileError {
    FileError::content(
        path,
        "metadata record frfid.run",
        found,
        "a run written by frfid; for any other recording say which topic is which (--map)",
    )
}

/// What was read of a run so far.
#[derive(Default)]
struct Reading {
    samples: Option<Samples>,
    origin: Origin,
}

impl Reading {
    fn take(&mut self, entry: Entry, path: &Path, budget: &Budget) -> Result<(), FileError> {
        match self.origin.take(entry) {
            Some(Entry::Metadata { name, values })
                if name == header::RUN && self.samples.is_none() =>
            {
                let structure = structure(&values, path)?;
                budget.check("the samples that it says it holds", structure.n_bytes())?;
                let samples = Samples::new(structure);
                self.samples = Some(samples.map_err(|found| not_a_run(path, found))?);
                Ok(())
            }
            Some(Entry::Message {
                channel, message, ..
            }) => self.take_message(channel, &message, path),
            _ => Ok(()),
        }
    }

    fn take_message(
        &mut self,
        channel: &Channel,
        message: &Message,
        path: &Path,
    ) -> Result<(), FileError> {
        let Some(samples) = &mut self.samples else {
            return Err(not_a_run(path, "messages before the metadata"));
        };
        let taken = samples.take(&channel.topic, message);
        taken.map_err(|found| {
            let what = format!("{} message {}", channel.topic, message.sequence);
            let needed = "the sample that the run's metadata announces";
            FileError::content(path, what, found, needed)
        })
    }

    /// The run, and what was lost of it.
    fn finish(self, damages: Vec<Damage>, path: &Path) -> Result<(RunFile, Vec<Loss>), FileError> {
        let Some(samples) = self.samples else {
            let found = damages.first().map_or(WITHOUT_IT, |damage| &damage.reason);
            return Err(not_a_run(path, found));
        };
        let mut losses = loss::of_file(damages, START_NS);
        losses.extend(samples.losses());
        losses.extend(self.origin.loss());
        let run = RunFile {
            joint_names: samples.structure.joint_names.clone(),
            run: samples.structure.run,
            injection: samples.structure.injection,
            record: samples.into_record(),
            metadata: self.origin.metadata,
            experiment_toml: self.origin.experiment_toml.unwrap_or_default(),
        };
        Ok((run, losses))
    }
}
