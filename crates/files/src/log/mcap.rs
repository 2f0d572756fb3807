//! MCAP recordings: the mapped signals of any topic of CDR messages with a ros2msg definition.

use std::collections::BTreeSet;
use std::path::Path;

use crate::error::FileError;
use crate::log::map::{LogMap, Signal};
use crate::log::recording::{Recording, Series};
use crate::mcap::chunk::Entry;
use crate::mcap::open::open_mcap;
use crate::mcap::read::{Part, scan};
use crate::mcap::record::{Channel, Message, Schema};
use crate::ros::definition::{self, Definition};
use crate::ros::selector::Selector;
use crate::ros::value::{Value, decode};

/// One mapped topic while its messages come in.
struct Topic {
    selectors: Vec<Selector>,
    definition: Option<Definition>,
    unstamped: usize,
    series: Series,
}

/// Reads every mapped topic.
pub(crate) fn read(
    path: &Path,
    _map: &LogMap,
    signals: &[&Signal],
) -> Result<Recording, FileError> {
    let mut topics = topics_of(path, signals)?;
    let mut seen = BTreeSet::new();
    let damages = scan(open_mcap(path)?, path, Part::All, &mut |entry| {
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
        let mapped = |topic: &&mut Topic| topic.series.topic == channel.topic;
        let topic = topics.iter_mut().find(mapped);
        topic.map_or(Ok(()), |topic| topic.take(path, channel, schema, &message))
    })?;
    if let Some(empty) = topics.iter().find(|topic| topic.series.rows.is_empty()) {
        let known: Vec<_> = seen.iter().map(String::as_str).collect();
        let needed = format!("one of {}", known.join(", "));
        let found = "no messages".into();
        return Err(content(path, &empty.series.topic, found, needed));
    }
    let at = |times: Option<(u64, u64)>| times.and_then(|(from, _)| i64::try_from(from).ok());
    Ok(Recording {
        warnings: topics.iter().filter_map(Topic::unstamped_warning).collect(),
        series: topics.into_iter().map(|topic| topic.series).collect(),
        damages: damages
            .into_iter()
            .map(|damage| (at(damage.times_ns), damage.reason))
            .collect(),
        sample_time_s: None,
    })
}

fn content(path: &Path, what: &str, found: String, needed: String) -> FileError {
    FileError::Content {
        path: path.into(),
        what: what.into(),
        found,
        needed,
    }
}

/// The mapped topics, each with the signals taken from it.
fn topics_of(path: &Path, signals: &[&Signal]) -> Result<Vec<Topic>, FileError> {
    let mut topics: Vec<Topic> = Vec::new();
    for (place, signal) in signals.iter().enumerate() {
        let selector = Selector::parse(&signal.source).ok_or_else(|| {
            let needed = "topic:field, for example /joint_states:velocity[elbow]".into();
            content(
                path,
                "source in the log map",
                format!("`{}`", signal.source),
                needed,
            )
        })?;
        let known = topics
            .iter()
            .position(|topic| topic.series.topic == selector.topic);
        let known = known.unwrap_or_else(|| {
            let series = Series {
                topic: selector.topic.clone(),
                ..Default::default()
            };
            topics.push(Topic {
                selectors: vec![],
                definition: None,
                unstamped: 0,
                series,
            });
            topics.len() - 1
        });
        topics[known].selectors.push(selector);
        topics[known].series.signals.push(place);
    }
    Ok(topics)
}

impl Topic {
    fn unstamped_warning(&self) -> Option<String> {
        let (name, count) = (&self.series.topic, self.unstamped);
        (count > 0).then(|| {
            format!(
                "{name}: {count} messages without a header stamp; the time of recording was taken instead"
            )
        })
    }

    fn take(
        &mut self,
        path: &Path,
        channel: &Channel,
        schema: Option<&Schema>,
        message: &Message,
    ) -> Result<(), FileError> {
        let bad = |found| {
            let what = format!("{} message {}", channel.topic, self.series.rows.len());
            content(
                path,
                &what,
                found,
                "a message of the type that the file states, with the fields of the log map".into(),
            )
        };
        let definition = match &mut self.definition {
            Some(definition) => definition,
            none => none.insert(definition_of(path, channel, schema)?),
        };
        let value = decode(definition, message.data).map_err(|error| bad(error.to_string()))?;
        let row = self
            .selectors
            .iter()
            .map(|selector| selector.pick(&value))
            .collect::<Result<Vec<_>, _>>();
        let row = row.map_err(bad)?;
        let stamp_ns = stamp_ns(&value).unwrap_or_else(|| {
            self.unstamped += 1;
            i64::try_from(message.log_time_ns).unwrap_or(i64::MAX)
        });
        self.series.stamps_ns.push(stamp_ns);
        self.series.rows.push(
            row.into_iter()
                .map(|value| value.unwrap_or(f64::NAN))
                .collect(),
        );
        Ok(())
    }
}

/// The definition of a topic's messages, if they are encoded as ROS 2 does.
fn definition_of(
    path: &Path,
    channel: &Channel,
    schema: Option<&Schema>,
) -> Result<Definition, FileError> {
    let encoding = schema.map_or("no schema", |schema| schema.encoding.as_str());
    if channel.encoding != "cdr" || encoding != "ros2msg" {
        let advice = match (channel.encoding.as_str(), encoding) {
            ("ros1", _) => "convert it: mcap convert, or rosbags-convert --dst-storage mcap",
            (_, "ros2idl") => {
                "record it on ROS 2 with .msg definitions, or convert it by rosbags-convert"
            }
            _ => "export the signals to CSV and map its columns",
        };
        return Err(FileError::Format {
            path: path.into(),
            found: format!(
                "{} encoded as {} with {encoding}",
                channel.topic, channel.encoding
            ),
            needed: "cdr with a ros2msg schema",
            advice: advice.into(),
        });
    }
    let text = String::from_utf8_lossy(schema.map_or(&[], |schema| &schema.text));
    definition::parse(&text).map_err(|error| {
        content(
            path,
            &channel.topic,
            error.to_string(),
            "a definition in the language of ROS 2 messages".into(),
        )
    })
}

/// The header's stamp; none where the message has no header or its stamp was never set.
fn stamp_ns(message: &Value) -> Option<i64> {
    let stamp = message.field("header").unwrap_or(message).field("stamp")?;
    let (sec, nanosec) = (
        stamp.field("sec")?.number()?,
        stamp.field("nanosec")?.number()?,
    );
    let stamp_ns = sec as i64 * 1_000_000_000 + nanosec as i64;
    (stamp_ns != 0).then_some(stamp_ns)
}
