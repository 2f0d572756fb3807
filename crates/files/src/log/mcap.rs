//! MCAP recordings: the mapped signals of any topic of CDR messages with a ros2msg definition.

use std::collections::BTreeSet;
use std::path::Path;

use crate::error::FileError;
use crate::log::map::{LogMap, Signal};
use crate::log::recording::{Recording, Series, TimedDamage, of_damaged};
use crate::log::table::Table;
use crate::loss::Damage;
use crate::mcap::chunk::Entry;
use crate::mcap::read::{Part, scan_file};
use crate::mcap::record::{Channel, Message, Schema};
use crate::ros::definition::{self, Definition};
use crate::ros::selector::Selector;
use crate::ros::value::{Value, decode};

/// One mapped topic while its messages come in.
struct Topic {
    selectors: Vec<Selector>,
    definition: Option<Definition>,
    n_messages: usize,
    /// The samples, stamped by their headers or, without, by the recorder.
    table: Table,
    /// The recorder's stamps, until a header's stamp is set.
    recorders_ns: Option<Vec<i64>>,
}

/// Reads every mapped topic.
pub(crate) fn read(
    path: &Path,
    _map: &LogMap,
    signals: &[&Signal],
) -> Result<Recording, FileError> {
    let mut topics = topics_of(path, signals)?;
    let mut seen = BTreeSet::new();
    let damages = scan_file(path, Part::All, &mut |entry| {
        let Entry::Message {
            channel,
            schema,
            message,
        } = entry
        else {
            return Ok(());
        };
        if !seen.contains(&channel.topic) {
            seen.insert(channel.topic.clone());
        }
        let mapped = topics
            .iter_mut()
            .find(|topic| topic.table.topic() == channel.topic);
        mapped.map_or(Ok(()), |topic| topic.take(path, channel, schema, &message))
    })?;
    let damages: Vec<_> = damages.into_iter().map(timed).collect();
    check_there(path, &topics, &seen).map_err(|error| of_damaged(error, &damages))?;
    Ok(Recording {
        series: topics
            .into_iter()
            .flat_map(|topic| topic.series(signals))
            .collect(),
        damages,
        warnings: Vec::new(),
    })
}

fn timed(damage: Damage) -> TimedDamage {
    let from = damage.times_ns.map(|(from, _)| i64::try_from(from));
    (from.and_then(Result::ok), damage.reason)
}

/// Refuses a mapped topic without messages of its joints; `seen` are the topics that have some.
fn check_there(path: &Path, topics: &[Topic], seen: &BTreeSet<String>) -> Result<(), FileError> {
    let Some(empty) = topics.iter().find(|topic| topic.table.n_rows() == 0) else {
        return Ok(());
    };
    let (found, needed) = match empty.n_messages {
        0 => {
            let known: Vec<_> = seen.iter().map(String::as_str).collect();
            ("no messages".into(), format!("one of {}", known.join(", ")))
        }
        count => (
            format!("{count} messages, none of which has what the log map names"),
            "joints and entries that its messages have".into(),
        ),
    };
    Err(FileError::content(path, empty.table.topic(), found, needed))
}

/// The mapped topics, each with the signals taken from it.
fn topics_of(path: &Path, signals: &[&Signal]) -> Result<Vec<Topic>, FileError> {
    let mut topics: Vec<Topic> = Vec::new();
    for (place, signal) in signals.iter().enumerate() {
        let selector = selector_of(path, signal)?;
        let known = topics
            .iter()
            .position(|topic| topic.table.topic() == selector.topic);
        let known = known.unwrap_or_else(|| {
            topics.push(Topic::of(&selector.topic));
            topics.len() - 1
        });
        topics[known].selectors.push(selector);
        topics[known].table.add_signal(place);
    }
    Ok(topics)
}

fn selector_of(path: &Path, signal: &Signal) -> Result<Selector, FileError> {
    Selector::parse(&signal.source).ok_or_else(|| {
        let found = format!("`{}`", signal.source);
        let needed = "topic:field, for example /joint_states:velocity[elbow]";
        FileError::content(path, "source in the log map", found, needed)
    })
}

impl Topic {
    fn of(name: &str) -> Self {
        Self {
            selectors: Vec::new(),
            definition: None,
            n_messages: 0,
            table: Table::of(name),
            recorders_ns: Some(Vec::new()),
        }
    }

    fn take(
        &mut self,
        path: &Path,
        channel: &Channel,
        schema: Option<&Schema>,
        message: &Message,
    ) -> Result<(), FileError> {
        let bad = |found| bad_message(path, &channel.topic, self.n_messages, found);
        let definition = match &mut self.definition {
            Some(definition) => definition,
            none => none.insert(definition_of(path, channel, schema)?),
        };
        let value = decode(definition, message.data).map_err(|error| bad(error.to_string()))?;
        let picked = self.selectors.iter().map(|selector| selector.pick(&value));
        let row = picked.collect::<Result<Vec<_>, _>>().map_err(bad)?;
        let recorders_ns = i64::try_from(message.log_time_ns).unwrap_or(i64::MAX);
        self.n_messages += 1;
        self.push(header_stamp_ns(&value), recorders_ns, &row);
        Ok(())
    }

    /// Takes in a sample. Headers whose stamps are all 0 were never set: then the recorder's count.
    fn push(&mut self, header_ns: Option<i64>, recorders_ns: i64, row: &[Option<f64>]) {
        if !self.table.push(header_ns.unwrap_or(recorders_ns), row) {
            return;
        }
        match &mut self.recorders_ns {
            Some(stamps) if header_ns.unwrap_or(0) == 0 => stamps.push(recorders_ns),
            _ => self.recorders_ns = None,
        }
    }

    /// What it recorded; a topic is on one clock.
    fn series(mut self, signals: &[&Signal]) -> Vec<Series> {
        if let Some(stamps) = self.recorders_ns {
            self.table.restamp(stamps);
        }
        self.table.split(signals)
    }
}

fn bad_message(path: &Path, topic: &str, number: usize, found: String) -> FileError {
    let what = format!("{topic} message {number}");
    let needed = "a message of the type that the file states, with the fields of the log map";
    FileError::content(path, what, found, needed)
}

/// The definition of a topic's messages, if they are encoded as ROS 2 does.
fn definition_of(
    path: &Path,
    channel: &Channel,
    schema: Option<&Schema>,
) -> Result<Definition, FileError> {
    let encoding = schema.map_or("no schema", |schema| schema.encoding.as_str());
    if channel.encoding != "cdr" || encoding != "ros2msg" {
        return Err(other_encoding(path, channel, encoding));
    }
    let text = String::from_utf8_lossy(schema.map_or(&[], |schema| &schema.text));
    definition::parse(&text).map_err(|error| {
        let needed = "a definition in the language of ROS 2 messages";
        FileError::content(path, &channel.topic, error.to_string(), needed)
    })
}

fn other_encoding(path: &Path, channel: &Channel, schema: &str) -> FileError {
    let advice = match (channel.encoding.as_str(), schema) {
        ("ros1", _) => "convert it: mcap convert, or rosbags-convert --dst-storage mcap",
        (_, "ros2idl") => {
            "record it on ROS 2 with .msg definitions, or convert it by rosbags-convert"
        }
        _ => "export the signals to CSV and map its columns",
    };
    let Channel {
        topic, encoding, ..
    } = channel;
    let found = format!("{topic} encoded as {encoding} with {schema}");
    FileError::format(path, found, "cdr with a ros2msg schema", advice)
}

/// The header's stamp; none where the message has no header.
fn header_stamp_ns(message: &Value) -> Option<i64> {
    let stamp = message.field("header").unwrap_or(message).field("stamp")?;
    let part = |name: &str| stamp.field(name)?.number();
    let (sec, nanosec) = (part("sec")?, part("nanosec")?);
    // saturating: what a hostile message holds is no time, and later refused as such
    let whole_ns = (sec as i64).saturating_mul(1_000_000_000);
    Some(whole_ns.saturating_add(nanosec as i64))
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
