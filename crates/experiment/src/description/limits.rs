//! Limits of an experiment: the table `[limits]`, its own and those of a `joint_limits.yaml`.

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

use frfid_signals::{Limit, Limits};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::value::StringDeserializer;
use serde::de::{Error, IntoDeserializer, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

use crate::description::fault::Fault;
use crate::description::joint_limits::JointLimits;
use crate::description::text::TomlText;

/// Keys of the limits of the signal.
pub(crate) const MAX_INPUT: &str = "max_input";
/// Of its change.
pub(crate) const MAX_INPUT_RATE: &str = "max_input_rate";

/// Limits that no run may exceed: one list for each, a number for each axis; what is not given is
/// not limited.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LimitsTable {
    /// A `joint_limits.yaml` of `ros2_control` or `MoveIt`, relative to the file that names it; of it and
    /// the keys beside it the tighter one binds.
    pub file: Option<String>,
    /// Largest value of the signal in the unit of each channel; of `[channels]` only.
    pub max_input: Option<Vec<f64>>,
    /// Largest change of the signal from sample to sample in its unit per second, likewise.
    pub max_input_rate: Option<Vec<f64>>,
    /// The limits of the keys; once the file is read, its own among them.
    pub given: Limits,
}

impl LimitsTable {
    /// Limits of the signal of `[channels]`: their keys and values, where they are given.
    pub(crate) fn of_signal(&self) -> impl Iterator<Item = (&'static str, &[f64])> {
        let of_key = [
            (MAX_INPUT, &self.max_input),
            (MAX_INPUT_RATE, &self.max_input_rate),
        ];
        let given = of_key.into_iter();
        given.filter_map(|(key, values)| Some((key, values.as_deref()?)))
    }

    /// The key of the first of them.
    pub(crate) fn first_of_signal(&self) -> Option<&'static str> {
        self.of_signal().map(|(key, _)| key).next()
    }

    /// Checks that every limit has a number for each axis, above 0 for a size.
    pub(crate) fn check(&self, n_axes: usize) -> Result<(), Fault> {
        let checked = self.given.check(n_axes).map_err(Fault::in_table("limits"));
        checked?;
        self.of_signal()
            .try_for_each(|(key, values)| check_signal(key, values, n_axes))
    }

    /// Puts what the file says in the place of its name, and returns what is to be said of it:
    /// joints that it does not know.
    pub(crate) fn read_file(
        &mut self,
        folder: &Path,
        joints: &[String],
    ) -> Result<Option<String>, Fault> {
        let Some(file) = self.file.take() else {
            return Ok(None);
        };
        let read = read(&folder.join(&file), joints);
        let found = read.map_err(|message| Fault::new(&["limits", "file"], message))?;
        self.given = self.given.tighter(&found.limits);
        Ok(found.unlimited_in_words(&file))
    }
}

/// Refuses a limit of the signal that has not one number above 0 for each channel.
fn check_signal(key: &str, values: &[f64], n_channels: usize) -> Result<(), Fault> {
    if values.len() == n_channels && values.iter().all(|value| *value > 0.0) {
        return Ok(());
    }
    let message =
        format!("{key} is {values:?}, needed: a number above 0 for each of {n_channels} channels");
    Err(Fault::new(&["limits", key], message))
}

/// The limits in a file.
fn read(path: &Path, joints: &[String]) -> Result<JointLimits, String> {
    let yaml = TomlText::read(path).map_err(|error| error.to_string())?;
    let limits = JointLimits::of_yaml(&yaml.text, joints);
    limits.map_err(|message| format!("{}: {message}", yaml.name))
}

/// A key of the table.
enum Key {
    File,
    MaxInput,
    MaxInputRate,
    Limit(Limit),
}

impl Key {
    fn of<E: Error>(key: String) -> Result<Self, E> {
        let limit = |key: String| -> Result<Self, E> {
            let key: StringDeserializer<E> = key.into_deserializer();
            Limit::deserialize(key).map(Self::Limit)
        };
        match key.as_str() {
            "file" => Ok(Self::File),
            MAX_INPUT => Ok(Self::MaxInput),
            MAX_INPUT_RATE => Ok(Self::MaxInputRate),
            _ => limit(key),
        }
    }
}

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::of(String::deserialize(deserializer)?)
    }
}

/// Key by key: a reader that collects unknown keys first, as serde's `flatten`, loses their place.
impl<'de> Deserialize<'de> for LimitsTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = LimitsTable;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of limits")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<LimitsTable, A::Error> {
        let mut table = LimitsTable::default();
        while let Some(key) = map.next_key()? {
            match key {
                Key::File => table.file = Some(map.next_value()?),
                Key::MaxInput => table.max_input = Some(map.next_value()?),
                Key::MaxInputRate => table.max_input_rate = Some(map.next_value()?),
                Key::Limit(limit) => table.given.set(limit, map.next_value()?),
            }
        }
        Ok(table)
    }
}

impl Serialize for LimitsTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        if let Some(file) = &self.file {
            map.serialize_entry("file", file)?;
        }
        for (key, values) in self.of_signal() {
            map.serialize_entry(key, values)?;
        }
        for (limit, values) in self.given.iter() {
            map.serialize_entry(&limit, values)?;
        }
        map.end()
    }
}

impl JsonSchema for LimitsTable {
    fn schema_name() -> Cow<'static, str> {
        "LimitsTable".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = Limits::json_schema(generator);
        let mut own: Value = generator.subschema_for::<Own>().into();
        let own = own["properties"].as_object_mut().map(std::mem::take);
        let keys = schema.get_mut("properties").and_then(Value::as_object_mut);
        if let Some(keys) = keys {
            keys.extend(own.into_iter().flatten());
        }
        schema
    }
}

/// Keys that are no limits of a robot, for the schema.
#[derive(JsonSchema)]
#[schemars(inline)]
#[expect(dead_code, reason = "read by nobody but the schema's derive")]
struct Own {
    /// A `joint_limits.yaml` of `ros2_control` or `MoveIt`, relative to the file that names it; of it and
    /// the keys beside it the tighter one binds.
    file: Option<String>,
    /// Largest value of the signal in the unit of each channel; of `[channels]` only.
    max_input: Option<Vec<f64>>,
    /// Largest change of the signal from sample to sample in its unit per second, likewise.
    max_input_rate: Option<Vec<f64>>,
}
