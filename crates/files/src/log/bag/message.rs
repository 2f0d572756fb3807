//! Message of a mapped topic: its definition, its stamp, and what is wrong with it.

use std::path::Path;

use crate::error::FileError;
use crate::ros::definition::{self, Definition, DefinitionError};
use crate::ros::known_types::definitions_of;
use crate::ros::value::{Value, decode};

/// A message and where it comes from.
pub(crate) struct Received<'m> {
    pub(crate) path: &'m Path,
    pub(crate) topic: &'m str,
    pub(crate) data: &'m [u8],
    /// When the recorder took it.
    pub(crate) recorders_ns: i64,
    pub(crate) described: Described<'m>,
}

/// What a file says of the type of a topic's messages.
#[derive(Clone, Copy)]
pub(crate) struct Described<'m> {
    /// Encoding of the messages: `cdr`.
    pub(crate) encoding: &'m str,
    /// Name of the type.
    pub(crate) type_name: &'m str,
    /// Encoding and text of the definition, where the file has it.
    pub(crate) definition: Option<(&'m str, &'m [u8])>,
}

impl Received<'_> {
    pub(crate) fn bad(&self, number: usize, found: String) -> FileError {
        let what = format!("{} message {number}", self.topic);
        let needed = "a message of the type that the file states, with the fields of the log map";
        FileError::content(self.path, what, found, needed)
    }

    /// The definition of the message: of several variants the first that it fits.
    pub(crate) fn definition(&self) -> Result<Definition, FileError> {
        let mut variants = self.definitions()?;
        let fits = |variant: &Definition| decode(variant, self.data).is_ok();
        let fitting = variants.iter().position(fits).unwrap_or(0);
        Ok(variants.swap_remove(fitting))
    }

    /// The definitions that the topic's messages may have: that of the file, or the variants of a known type.
    fn definitions(&self) -> Result<Vec<Definition>, FileError> {
        let Described {
            encoding,
            type_name,
            definition,
        } = self.described;
        match (encoding, definition) {
            ("cdr", Some(("ros2msg", text))) => {
                let stated = definition::parse(&String::from_utf8_lossy(text));
                let without = |error: DefinitionError| {
                    let known = self.known(type_name);
                    known.map_err(|_| self.no_definition(error.to_string()))
                };
                stated.map(|stated| vec![stated]).or_else(without)
            }
            ("cdr", None) => self.known(type_name),
            (_, Some((schema, _))) => Err(self.other_encoding(schema)),
            (_, None) => Err(self.other_encoding("no schema")),
        }
    }

    /// The variants of a type whose definition the file does not have.
    fn known(&self, type_name: &str) -> Result<Vec<Definition>, FileError> {
        let texts = definitions_of(type_name);
        let parsed = texts.iter().map(|text| definition::parse(text));
        let known: Vec<Definition> = parsed.flatten().collect();
        if known.is_empty() {
            return Err(self.unknown_type(type_name));
        }
        Ok(known)
    }

    fn unknown_type(&self, type_name: &str) -> FileError {
        let found = format!("{} of {type_name}, without its definition", self.topic);
        let needed = "a definition in the file, or JointState, JointTrajectory, JointTrajectoryControllerState, \
                      DynamicJointState, MultiDOFStateStamped, Float64, Float64MultiArray";
        let advice =
            "convert it where the type is installed: ros2 bag convert, or rosbags-convert, to mcap";
        FileError::format(self.path, found, needed, advice)
    }

    fn no_definition(&self, found: String) -> FileError {
        let needed = "a definition in the language of ROS 2 messages";
        FileError::content(self.path, self.topic, found, needed)
    }

    fn other_encoding(&self, schema: &str) -> FileError {
        let encoding = self.described.encoding;
        let found = format!("{} encoded as {encoding} with {schema}", self.topic);
        let advice = conversion(encoding, schema);
        FileError::format(self.path, found, "cdr with a ros2msg schema", advice)
    }
}

/// How a recording of another encoding can be read.
fn conversion(encoding: &str, schema: &str) -> &'static str {
    match (encoding, schema) {
        ("ros1", _) => "convert it: mcap convert, or rosbags-convert --dst-storage mcap",
        (_, "ros2idl") => {
            "record it on ROS 2 with .msg definitions, or convert it by rosbags-convert"
        }
        _ => "export the signals to CSV and map its columns",
    }
}

/// Seconds and nanoseconds of the header's stamp; none where the message has no header.
pub(crate) fn header_stamp(message: &Value) -> Option<[f64; 2]> {
    let header = message.field("header").unwrap_or(message);
    let stamp = header.field("stamp")?;
    let part = |name| stamp.field(name)?.number();
    Some([part("sec")?, part("nanosec")?])
}

/// A stamp in ns.
pub(crate) fn stamp_ns([sec, nanosec]: [f64; 2]) -> i64 {
    // saturating: what a hostile message holds is no time, and later refused as such
    let whole_ns = (sec as i64).saturating_mul(1_000_000_000);
    whole_ns.saturating_add(nanosec as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stamp_beyond_all_times_does_not_overflow() {
        let message = |fields: &[(&str, Value)]| {
            let named = |(name, value): &(&str, Value)| ((*name).to_owned(), value.clone());
            Value::Message(fields.iter().map(named).collect())
        };
        let stamped = |sec: f64| {
            let stamp = [("sec", Value::Number(sec)), ("nanosec", Value::Number(5.0))];
            message(&[("stamp", message(&stamp))])
        };
        let stamp_of = |sec| header_stamp(&stamped(sec)).map(stamp_ns);
        assert_eq!(stamp_of(2.0), Some(2_000_000_005));
        assert_eq!(stamp_of(1e300), Some(i64::MAX));
    }
}
