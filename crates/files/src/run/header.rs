//! Header of a run or a plan: the records with which a file describes itself, key and value texts,
//! every value in JSON.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;

use crate::error::FileError;
use crate::mcap::record::Attachment;

/// Metadata record of a run.
pub(crate) const RUN: &str = "frfid.run";
/// Metadata record of a plan.
pub(crate) const PLAN: &str = "frfid.plan";
/// Provenance, as the user's program gave it.
pub(crate) const PROVENANCE: &str = "frfid";
/// Attachment that describes the experiment. Names of attachments are compared, never used as
/// paths.
pub(crate) const EXPERIMENT: &str = "experiment.toml";

/// Whether an attachment is the experiment's description, and undamaged.
pub(crate) fn is_experiment(attachment: &Attachment) -> bool {
    attachment.name == EXPERIMENT && attachment.is_sound
}

/// The text of an attachment; `None` where it is not UTF-8.
pub(crate) fn text_of(attachment: &Attachment) -> Option<String> {
    String::from_utf8(attachment.data.to_vec()).ok()
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

/// Joint names must be there and differ, or nobody can tell the joints apart.
pub(crate) fn check_joints(names: &[String]) -> Result<(), FileError> {
    let distinct: BTreeSet<_> = names.iter().filter(|name| !name.is_empty()).collect();
    if names.is_empty() || distinct.len() < names.len() {
        return Err(FileError::Shape {
            what: "joint_names",
            found: format!("{names:?}"),
            needed: "at least one name, all different, none empty".into(),
        });
    }
    Ok(())
}

/// Stamps count nanoseconds: samples must lie at least 1 us apart for them to be a clock.
pub(crate) fn check_sample_time(sample_time_s: f64) -> Result<(), FileError> {
    if (1e-6..=1e6).contains(&sample_time_s) {
        return Ok(());
    }
    let needed = "between 1e-6 s and 1e6 s, for stamps in ns".into();
    Err(FileError::Shape {
        what: "sample_time_s",
        found: sample_time_s.to_string(),
        needed,
    })
}
