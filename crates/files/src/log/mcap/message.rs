//! Message of a mapped topic: its definition, its stamp, and what is wrong with it.

use std::path::Path;

use crate::error::FileError;
use crate::mcap::chunk::Entry;
use crate::mcap::record::{Channel, Message, Schema};
use crate::ros::definition::{self, Definition};
use crate::ros::value::Value;

/// A message and where it comes from.
pub(crate) struct Received<'m> {
    pub(crate) path: &'m Path,
    pub(crate) channel: &'m Channel,
    schema: Option<&'m Schema>,
    pub(crate) message: Message<'m>,
}

impl<'m> Received<'m> {
    /// The message of an entry of the file; none where that is something else.
    pub(crate) fn of(path: &'m Path, entry: Entry<'m>) -> Option<Self> {
        let Entry::Message {
            channel,
            schema,
            message,
        } = entry
        else {
            return None;
        };
        Some(Self {
            path,
            channel,
            schema,
            message,
        })
    }

    pub(crate) fn recorders_ns(&self) -> i64 {
        i64::try_from(self.message.log_time_ns).unwrap_or(i64::MAX)
    }

    pub(crate) fn bad(&self, number: usize, found: String) -> FileError {
        let what = format!("{} message {number}", self.channel.topic);
        let needed = "a message of the type that the file states, with the fields of the log map";
        FileError::content(self.path, what, found, needed)
    }

    /// The definition of the topic's messages, if they are encoded as ROS 2 does.
    pub(crate) fn definition(&self) -> Result<Definition, FileError> {
        match (self.channel.encoding.as_str(), self.schema) {
            ("cdr", Some(schema)) if schema.encoding == "ros2msg" => self.parsed(schema),
            (_, Some(schema)) => Err(self.other_encoding(&schema.encoding)),
            (_, None) => Err(self.other_encoding("no schema")),
        }
    }

    fn parsed(&self, schema: &Schema) -> Result<Definition, FileError> {
        let text = String::from_utf8_lossy(&schema.text);
        definition::parse(&text).map_err(|error| self.no_definition(error.to_string()))
    }

    fn no_definition(&self, found: String) -> FileError {
        let needed = "a definition in the language of ROS 2 messages";
        FileError::content(self.path, &self.channel.topic, found, needed)
    }

    fn other_encoding(&self, schema: &str) -> FileError {
        let Channel {
            topic, encoding, ..
        } = self.channel;
        let found = format!("{topic} encoded as {encoding} with {schema}");
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

/// The header's stamp; none where the message has no header.
pub(crate) fn header_stamp_ns(message: &Value) -> Option<i64> {
    let header = message.field("header").unwrap_or(message);
    time_ns(header.field("stamp")?)
}

/// A time in whole seconds and the ns behind them.
fn time_ns(time: &Value) -> Option<i64> {
    let sec = time.field("sec")?.number()?;
    // saturating: what a hostile message holds is no time, and later refused as such
    let whole_ns = (sec as i64).saturating_mul(1_000_000_000);
    Some(whole_ns.saturating_add(time.field("nanosec")?.number()? as i64))
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
        assert_eq!(header_stamp_ns(&stamped(2.0)), Some(2_000_000_005));
        assert_eq!(header_stamp_ns(&stamped(1e300)), Some(i64::MAX));
    }
}
