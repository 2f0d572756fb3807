//! Bags: the mapped signals of any topic of CDR messages, whatever file holds them.

pub(crate) mod contents;
pub(crate) mod db3;
pub(crate) mod folder;
pub(crate) mod mcap;
pub(crate) mod message;

use std::collections::BTreeSet;
use std::path::Path;

use crate::budget::Budget;
use crate::error::FileError;
use crate::log::bag::message::{Received, header_stamp, stamp_ns};
use crate::log::map::{Signal, Signals};
use crate::log::recording::{Cells, Recording, Series, TimedDamage, of_damaged};
use crate::log::table::Table;
use crate::ros::definition::Definition;
use crate::ros::layout::{Layout, Picked};
use crate::ros::selector::Selector;
use crate::ros::value::Value;

/// One mapped topic while its messages come in.
struct Topic {
    selectors: Vec<Selector>,
    definition: Option<Definition>,
    /// Where the numbers of the last decoded message were, the stamp's last.
    layout: Option<Picked>,
    /// Numbers of the last message.
    row: Vec<Option<f64>>,
    n_messages: usize,
    /// The samples, stamped by their headers or, without, by the recorder.
    table: Table,
    /// The recorder's stamps, until a header's stamp is set.
    recorders_ns: Option<Vec<i64>>,
}

/// The mapped topics while their messages come in.
#[derive(Default)]
struct Topics {
    mapped: Vec<Topic>,
    /// Every topic that has messages.
    seen: BTreeSet<String>,
}

/// What is done with every message.
pub(crate) type Take<'t> = dyn FnMut(&Received) -> Result<(), FileError> + 't;

/// Reads every mapped topic; `scan` hands over all messages of a file and returns the damages to it.
pub(crate) fn read(
    path: &Path,
    signals: &Signals,
    scan: impl FnOnce(&mut Take) -> Result<Vec<TimedDamage>, FileError>,
) -> Result<Recording, FileError> {
    let mut topics = Topics::of(path, signals)?;
    let budget = Budget::allowed(path);
    let damages = scan(&mut |received| {
        topics.take(received)?;
        budget.check("what is mapped of its messages", topics.n_bytes())
    })?;
    let checked = topics.check_there(path);
    checked.map_err(|error| of_damaged(error, &damages))?;
    Ok(Recording {
        series: topics.series(signals),
        damages,
        warnings: Vec::new(),
    })
}

impl Topics {
    /// The mapped topics, each with the signals taken from it.
    fn of(path: &Path, signals: &Signals) -> Result<Self, FileError> {
        let mut topics = Self::default();
        for (place, signal) in signals.iter().enumerate() {
            topics.add_signal(place, selector_of(path, signal)?);
        }
        Ok(topics)
    }

    fn add_signal(&mut self, signal: usize, selector: Selector) {
        let topic = self.topic(&selector.topic);
        topic.selectors.push(selector);
        topic.table.add_signal(signal);
    }

    /// The mapped topic of a name, a new one if there is none yet.
    fn topic(&mut self, name: &str) -> &mut Topic {
        let known = self.place(name);
        let place = known.unwrap_or_else(|| self.add_topic(name));
        &mut self.mapped[place]
    }

    fn add_topic(&mut self, name: &str) -> usize {
        self.mapped.push(Topic::of(name));
        self.mapped.len() - 1
    }

    /// The place of a topic among those that are mapped.
    fn place(&self, name: &str) -> Option<usize> {
        let is_it = |topic: &Topic| topic.table.topic() == name;
        self.mapped.iter().position(is_it)
    }

    fn take(&mut self, received: &Received) -> Result<(), FileError> {
        let name = received.topic;
        self.see(name);
        self.place(name)
            .map_or(Ok(()), |place| self.mapped[place].take(received))
    }

    fn n_bytes(&self) -> u64 {
        self.mapped.iter().map(|topic| topic.table.n_bytes()).sum()
    }

    fn see(&mut self, name: &str) {
        if !self.seen.contains(name) {
            self.seen.insert(name.to_owned());
        }
    }

    /// Refuses a mapped topic without messages of its joints.
    fn check_there(&self, path: &Path) -> Result<(), FileError> {
        let is_empty = |topic: &&Topic| topic.table.n_rows() == 0;
        match self.mapped.iter().find(is_empty) {
            None => Ok(()),
            Some(topic) if topic.n_messages == 0 => Err(self.no_messages(path, topic)),
            Some(topic) => Err(topic.nothing_mapped(path)),
        }
    }

    fn no_messages(&self, path: &Path, topic: &Topic) -> FileError {
        let needed = match self.seen.is_empty() {
            true => "a recording with messages of it; there are none of any topic".into(),
            false => format!("one of {}", self.seen().join(", ")),
        };
        FileError::content(path, topic.table.topic(), "no messages", needed)
    }

    fn seen(&self) -> Vec<&str> {
        self.seen.iter().map(String::as_str).collect()
    }

    fn series(self, signals: &Signals) -> Vec<Series> {
        let topics = self.mapped.into_iter();
        topics.flat_map(|topic| topic.series(signals)).collect()
    }
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
            layout: None,
            row: Vec::new(),
            n_messages: 0,
            table: Table::of(name),
            recorders_ns: Some(Vec::new()),
        }
    }

    fn take(&mut self, received: &Received) -> Result<(), FileError> {
        let mut row = std::mem::take(&mut self.row);
        let by_layout = self.layout.as_ref();
        let is_known = by_layout.and_then(|layout| layout.read(received.data, &mut row));
        if is_known.is_none() {
            self.define(received)?;
            let decoded = self.decode(received.data, &mut row);
            decoded.map_err(|found| received.bad(self.n_messages, found))?;
        }
        self.n_messages += 1;
        self.push(received.recorders_ns, &row);
        self.row = row;
        Ok(())
    }

    /// Decodes a message field by field into the numbers of its row, or says what it has instead; its layout is kept
    /// for those to come.
    fn decode(&mut self, message: &[u8], row: &mut Vec<Option<f64>>) -> Result<(), String> {
        let definition = self.definition.as_ref().ok_or("no definition")?;
        let layout = Layout::of(definition, message).map_err(|error| error.to_string())?;
        let picked = layout.picked(&self.picked(layout.places())?);
        let numbers = self.layout.insert(picked).read(message, row);
        numbers.ok_or_else(|| "no number where its definition has one".into())
    }

    /// The mapped signals of a message and the two numbers of its stamp, or what it has instead.
    fn picked(&self, message: &Value) -> Result<Vec<Option<f64>>, String> {
        let selectors = self.selectors.iter();
        let signals = selectors.map(|selector| selector.pick(message));
        let stamp = header_stamp(message);
        let stamp = [0, 1].map(|part| Ok(stamp.map(|stamp| stamp[part])));
        signals.chain(stamp).collect()
    }

    /// Finds the definition of its messages, by the first one.
    fn define(&mut self, received: &Received) -> Result<(), FileError> {
        if self.definition.is_none() {
            self.definition = Some(received.definition()?);
        }
        Ok(())
    }

    /// Takes in a sample, the last two numbers of which are its stamp. Headers whose stamps are all 0 were never set:
    /// then the recorder's count.
    fn push(&mut self, recorders_ns: i64, row: &Cells) {
        let (header_ns, row) = match *row {
            [ref row @ .., Some(sec), Some(nanosec)] => (Some(stamp_ns([sec, nanosec])), row),
            [ref row @ .., _, _] => (None, row),
            _ => (None, row),
        };
        if !self.table.push(header_ns.unwrap_or(recorders_ns), row) {
            return;
        }
        match &mut self.recorders_ns {
            Some(stamps) if header_ns.unwrap_or(0) == 0 => stamps.push(recorders_ns),
            _ => self.recorders_ns = None,
        }
    }

    fn nothing_mapped(&self, path: &Path) -> FileError {
        let count = self.n_messages;
        let found = format!("{count} messages, none of which has what the log map names");
        let needed = "joints and entries that its messages have";
        FileError::content(path, self.table.topic(), found, needed)
    }

    /// What it recorded; a topic is on one clock.
    fn series(mut self, signals: &Signals) -> Vec<Series> {
        if let Some(stamps) = self.recorders_ns {
            self.table.restamp(stamps);
        }
        self.table.split(signals)
    }
}
