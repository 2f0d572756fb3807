//! Header of a run or a plan: the records with which a file describes itself, key and value texts,
//! every value in JSON.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

use mcap::McapResult;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;

use crate::error::FileError;
use crate::loss::{self, Loss};
use crate::mcap::chunk::Entry;
use crate::mcap::write::RosWriter;

/// Metadata record of a run.
pub(crate) const RUN: &str = "frfid.run";
/// Metadata record of a plan.
pub(crate) const PLAN: &str = "frfid.plan";
/// Provenance, as the user's program gave it.
const PROVENANCE: &str = "frfid";
/// Attachment that describes the experiment. Names of attachments are compared, never used as
/// paths.
const EXPERIMENT: &str = "experiment.toml";

/// Where a run or a plan comes from.
#[derive(Debug, Default)]
pub(crate) struct Origin {
    /// Provenance; empty where the file has none.
    pub(crate) metadata: BTreeMap<String, String>,
    /// The experiment's description; `None` where it is missing, damaged or not UTF-8.
    pub(crate) experiment_toml: Option<String>,
}

impl Origin {
    /// Takes in what it is made of; gives back any other entry.
    pub(crate) fn take<'e>(&mut self, entry: Entry<'e>) -> Option<Entry<'e>> {
        match entry {
            Entry::Metadata { name, values } if name == PROVENANCE => self.metadata = values,
            Entry::Attachment(attached) if attached.name == EXPERIMENT && attached.is_sound => {
                self.experiment_toml = String::from_utf8(attached.data.to_vec()).ok();
            }
            other => return Some(other),
        }
        None
    }

    /// The description, if it is lost.
    pub(crate) fn loss(&self) -> Option<Loss> {
        let reason = "the attachment is missing or damaged";
        let is_lost = self.experiment_toml.is_none();
        is_lost.then(|| loss::of_no_sample(EXPERIMENT, 0.0, reason))
    }
}

/// Writes how a file describes itself: provenance, structure (the record `name`), experiment.
pub(crate) fn write<W: Write>(
    writer: &mut RosWriter<W>,
    metadata: &BTreeMap<String, String>,
    (name, structure): (&str, &impl Serialize),
    experiment_toml: &str,
) -> McapResult<()> {
    writer.metadata(PROVENANCE, metadata)?;
    writer.metadata(name, &to_texts(structure))?;
    writer.attach(EXPERIMENT, "application/toml", experiment_toml.as_bytes())
}

/// No signal of a file may hold more values: 2 GiB of them.
pub(crate) const MOST_VALUES: usize = 1 << 28;

/// Key of the checksum over the other keys and values: MCAP protects messages, but not metadata.
const CHECKSUM: &str = "crc32";

/// The fields of a struct as texts, and their checksum.
pub(crate) fn to_texts<T: Serialize>(structure: &T) -> BTreeMap<String, String> {
    let Value::Object(fields) = serde_json::json!(structure) else {
        return BTreeMap::new();
    };
    let mut texts: BTreeMap<_, _> = fields
        .into_iter()
        .map(|(key, value)| (key, value.to_string()))
        .collect();
    texts.insert(CHECKSUM.into(), checksum(&texts));
    texts
}

fn checksum(texts: &BTreeMap<String, String>) -> String {
    let mut crc = crc32fast::Hasher::new();
    for (key, text) in texts.iter().filter(|(key, _)| *key != CHECKSUM) {
        crc.update(format!("{key}={text}\n").as_bytes());
    }
    format!("\"{:08x}\"", crc.finalize())
}

/// The struct again, or what is wrong with the texts.
pub(crate) fn from_texts<T: DeserializeOwned>(
    texts: &BTreeMap<String, String>,
) -> Result<T, String> {
    if texts.get(CHECKSUM) != Some(&checksum(texts)) {
        return Err("a checksum that fails: the record is damaged".into());
    }
    let mut fields = serde_json::Map::new();
    for (key, text) in texts {
        let value =
            serde_json::from_str(text).map_err(|error| format!("{key} = {text}: {error}"))?;
        fields.insert(key.clone(), value);
    }
    serde_json::from_value(Value::Object(fields)).map_err(|error| error.to_string())
}

/// Refuses a file of another version than the one that is read.
pub(crate) fn check_version(found: u32, read: u32) -> Result<(), String> {
    if found == read {
        return Ok(());
    }
    Err(format!("version {found}, this frfid reads version {read}"))
}

/// Joint names must be there and differ, or nobody can tell the joints apart.
pub(crate) fn check_joints(names: &[String]) -> Result<(), FileError> {
    let distinct: BTreeSet<_> = names.iter().filter(|name| !name.is_empty()).collect();
    if names.is_empty() || distinct.len() < names.len() {
        let needed = "at least one name, all different, none empty";
        return Err(FileError::shape(
            "joint_names",
            format!("{names:?}"),
            needed,
        ));
    }
    Ok(())
}

/// Stamps count nanoseconds: samples must lie at least 1 us apart for them to be a clock.
pub(crate) fn check_sample_time(sample_time_s: f64) -> Result<(), FileError> {
    if (1e-6..=1e6).contains(&sample_time_s) {
        return Ok(());
    }
    let needed = "between 1e-6 s and 1e6 s, for stamps in ns";
    let found = sample_time_s.to_string();
    Err(FileError::shape("sample_time_s", found, needed))
}
