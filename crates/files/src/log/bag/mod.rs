//! Bags: the mapped signals of any topic of CDR messages, whatever file holds them.

pub(crate) mod contents;
pub(crate) mod db3;
pub(crate) mod folder;
pub(crate) mod mcap;
pub(crate) mod message;

use std::collections::BTreeSet;
use std::path::Path;

use crate::error::FileError;
use crate::log::bag::message::{Received, header_stamp_ns};
use crate::log::map::{Signal, Signals};
use crate::log::recording::{Cells, Recording, Series, TimedDamage, of_damaged};
use crate::log::table::Table;
use crate::ros::definition::Definition;
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
    let damages = scan(&mut |received| topics.take(received))?;
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
        let needed = format!("one of {}", self.seen().join(", "));
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
            n_messages: 0,
            table: Table::of(name),
            recorders_ns: Some(Vec::new()),
        }
    }

    fn take(&mut self, received: &Received) -> Result<(), FileError> {
        let value = self.decoded(received)?;
        let row = self.picked(&value);
        let row = row.map_err(|found| received.bad(self.n_messages, found))?;
        self.n_messages += 1;
        self.push(header_stamp_ns(&value), received.recorders_ns, &row);
        Ok(())
    }

    /// The mapped signals of a message, or what it has instead.
    fn picked(&self, message: &Value) -> Result<Vec<Option<f64>>, String> {
        let selectors = self.selectors.iter();
        selectors.map(|selector| selector.pick(message)).collect()
    }

    fn decoded(&mut self, received: &Received) -> Result<Value, FileError> {
        let value = decode(self.definition(received)?, received.data);
        value.map_err(|error| received.bad(self.n_messages, error.to_string()))
    }

    /// The definition of its messages, by the first one: of several variants the first that it fits.
    fn definition(&mut self, received: &Received) -> Result<&Definition, FileError> {
        match &mut self.definition {
            Some(definition) => Ok(definition),
            none => {
                let mut variants = received.definitions()?;
                let fits = |variant: &Definition| decode(variant, received.data).is_ok();
                let fitting = variants.iter().position(fits).unwrap_or(0);
                Ok(none.insert(variants.swap_remove(fitting)))
            }
        }
    }

    /// Takes in a sample. Headers whose stamps are all 0 were never set: then the recorder's count.
    fn push(&mut self, header_ns: Option<i64>, recorders_ns: i64, row: &Cells) {
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
