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

use crate::description::fault::Fault;
use crate::description::joint_limits::JointLimits;
use crate::description::text::TomlText;

/// Limits that no run may exceed: one list for each, a number for each axis; what is not given is
/// not limited.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LimitsTable {
    /// A `joint_limits.yaml` of `ros2_control` or `MoveIt`, relative to the file that names it; of it and
    /// the keys beside it the tighter one binds.
    pub file: Option<String>,
    /// The limits of the keys; once the file is read, its own among them.
    pub given: Limits,
}

impl LimitsTable {
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

/// The limits in a file.
fn read(path: &Path, joints: &[String]) -> Result<JointLimits, String> {
    let yaml = TomlText::read(path).map_err(|error| error.to_string())?;
    let limits = JointLimits::of_yaml(&yaml.text, joints);
    limits.map_err(|message| format!("{}: {message}", yaml.name))
}

/// A key of the table.
enum Key {
    File,
    Limit(Limit),
}

impl Key {
    fn of<E: Error>(key: String) -> Result<Self, E> {
        if key == "file" {
            return Ok(Self::File);
        }
        let limit: StringDeserializer<E> = key.into_deserializer();
        Limit::deserialize(limit).map(Self::Limit)
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
        let mut file = generator.subschema_for::<Option<String>>();
        let what = "A joint_limits.yaml of ros2_control or MoveIt, relative to the file that names it; \
                    of it and the keys beside it the tighter one binds.";
        file.insert("description".into(), what.into());
        let mut schema = Limits::json_schema(generator);
        if let Some(keys) = schema
            .get_mut("properties")
            .and_then(|keys| keys.as_object_mut())
        {
            keys.insert("file".into(), file.into());
        }
        schema
    }
}
