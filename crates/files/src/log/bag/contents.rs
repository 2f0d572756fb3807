//! Contents of a bag: its topics, how many messages they have, and every number in the first of them.

use std::collections::BTreeMap;

use crate::error::FileError;
use crate::log::bag::Take;
use crate::log::bag::message::Received;
use crate::log::listing::{ListedSignal, Listing, N_FIRST, SignalGroup};
use crate::log::recording::TimedDamage;
use crate::ros::definition::Definition;
use crate::ros::selector::{Selector, names_of};
use crate::ros::value::{Value, decode};

/// Longer arrays are no joints but pictures, clouds and maps.
const MOST_ENTRIES: usize = 64;

/// A topic while its messages come in.
#[derive(Default)]
struct Topic {
    type_name: String,
    n_messages: usize,
    definition: Option<Definition>,
    /// The first messages.
    first: Vec<Value>,
    /// Why its messages cannot be read.
    failed: Option<String>,
}

/// Lists a bag of which `scan` hands over all messages.
pub(crate) fn list(
    format: &'static str,
    scan: impl FnOnce(&mut Take) -> Result<Vec<TimedDamage>, FileError>,
) -> Result<Listing, FileError> {
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    let damages = scan(&mut |received| {
        if !topics.contains_key(received.topic) {
            topics.insert(received.topic.to_owned(), Topic::default());
        }
        if let Some(topic) = topics.get_mut(received.topic) {
            topic.take(received);
        }
        Ok(())
    })?;
    let failed =
        |(name, topic): (&String, &Topic)| Some(format!("{name}: {}", topic.failed.as_ref()?));
    let told = topics.iter().filter_map(failed);
    let told = told.chain(damages.into_iter().map(|(_, reason)| reason));
    Ok(Listing {
        format,
        told: told.collect(),
        groups: topics
            .into_iter()
            .map(|(name, topic)| topic.group(name))
            .collect(),
    })
}

impl Topic {
    fn take(&mut self, received: &Received) {
        if self.n_messages == 0 {
            self.type_name = received.described.type_name.to_owned();
        }
        self.n_messages += 1;
        if self.first.len() < N_FIRST && self.failed.is_none() {
            let decoded = self.decoded(received);
            match decoded {
                Ok(value) => self.first.push(value),
                Err(error) => self.failed = Some(error),
            }
        }
    }

    fn decoded(&mut self, received: &Received) -> Result<Value, String> {
        let definition = match self.definition.take() {
            Some(definition) => definition,
            None => received.definition().map_err(|error| error.to_string())?,
        };
        let definition = self.definition.insert(definition);
        decode(definition, received.data).map_err(|error| error.to_string())
    }

    fn group(self, name: String) -> SignalGroup {
        let mut ways: Vec<String> = Vec::new();
        for message in &self.first {
            let mut found = Vec::new();
            numbers_in(message, "", &mut vec![message], &mut found);
            let is_new = |way: &String| !ways.contains(way);
            let new: Vec<String> = found.into_iter().filter(is_new).collect();
            ways.extend(new);
        }
        let signals = ways.iter().filter_map(|way| self.signal(&name, way));
        SignalGroup {
            signals: signals.collect(),
            type_name: Some(self.type_name),
            n_rows: Some(self.n_messages),
            name,
        }
    }

    fn signal(&self, topic: &str, way: &str) -> Option<ListedSignal> {
        let source = format!("{topic}:{way}");
        let selector = Selector::parse(&source)?;
        let value = |message: &Value| selector.pick(message).ok().flatten().unwrap_or(f64::NAN);
        let first: Vec<f64> = self.first.iter().map(value).collect();
        let is_measured = first.iter().any(|value| value.is_finite());
        is_measured.then(|| ListedSignal::of(source, None, first))
    }
}

/// The ways to all numbers below a value, but for those of the header.
fn numbers_in<'v>(
    value: &'v Value,
    way: &str,
    around: &mut Vec<&'v Value>,
    found: &mut Vec<String>,
) {
    match value {
        Value::Text(_) => {}
        Value::Number(_) => found.push(way.to_owned()),
        Value::Numbers(numbers) => {
            let entries = entries(numbers.len(), around);
            found.extend(entries.map(|entry| format!("{way}[{entry}]")));
        }
        Value::List(list) => {
            for (place, entry) in list.iter().take(MOST_ENTRIES).enumerate() {
                inside(entry, &format!("{way}[{place}]"), around, found);
            }
        }
        Value::Message(fields) => {
            for (name, field) in fields.iter().filter(|(name, _)| name != "header") {
                let dot = if way.is_empty() { "" } else { "." };
                inside(field, &format!("{way}{dot}{name}"), around, found);
            }
        }
    }
}

fn inside<'v>(value: &'v Value, way: &str, around: &mut Vec<&'v Value>, found: &mut Vec<String>) {
    around.push(value);
    numbers_in(value, way, around, found);
    around.pop();
}

/// What the entries of an array are called: by the names beside it if there are as many, else by their places.
fn entries(count: usize, around: &[&Value]) -> impl Iterator<Item = String> + use<> {
    let count = if count > MOST_ENTRIES { 0 } else { count };
    let names = around.iter().rev().find_map(|value| names_of(value));
    let names = names.filter(|names| names.len() == count && are_names(names));
    (0..count).map(move |place| {
        names
            .as_ref()
            .map_or_else(|| place.to_string(), |names| names[place].clone())
    })
}

/// Whether all names can stand in brackets and are told from each other and from places.
fn are_names(names: &[String]) -> bool {
    let is_name = |name: &String| {
        !name.is_empty() && !name.contains([']', '=']) && name.parse::<usize>().is_err()
    };
    let is_new = |(place, name): (usize, &String)| !names[..place].contains(name);
    names.iter().all(is_name) && names.iter().enumerate().all(is_new)
}
