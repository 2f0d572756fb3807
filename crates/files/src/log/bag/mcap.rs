//! MCAP recordings: messages with their definitions, in chunks that are verified.

use std::path::Path;

use crate::error::FileError;
use crate::log::bag::message::{Described, Received};
use crate::log::bag::{self, Take, contents};
use crate::log::listing::Listing;
use crate::log::map::{LogMap, Signals};
use crate::log::recording::{Recording, TimedDamage};
use crate::loss::Damage;
use crate::mcap::chunk::Entry;
use crate::mcap::read::{Part, scan_file};

/// Reads every mapped topic.
pub(crate) fn read(path: &Path, _map: &LogMap, signals: &Signals) -> Result<Recording, FileError> {
    bag::read(path, signals, |take| scan(path, take))
}

/// Lists its topics.
pub(crate) fn list(path: &Path) -> Result<Listing, FileError> {
    contents::list("MCAP", |take| scan(path, take))
}

/// Hands over all messages; returns the damages to the file.
pub(crate) fn scan(path: &Path, take: &mut Take) -> Result<Vec<TimedDamage>, FileError> {
    let damages = scan_file(path, Part::All, &mut |entry| {
        received(path, &entry).map_or(Ok(()), |received| take(&received))
    })?;
    Ok(damages.into_iter().map(timed).collect())
}

/// The message of an entry of the file; none where that is something else.
fn received<'m>(path: &'m Path, entry: &Entry<'m>) -> Option<Received<'m>> {
    let &Entry::Message {
        channel,
        schema,
        ref message,
    } = entry
    else {
        return None;
    };
    Some(Received {
        path,
        topic: &channel.topic,
        data: message.data,
        recorders_ns: i64::try_from(message.log_time_ns).unwrap_or(i64::MAX),
        described: Described {
            encoding: &channel.encoding,
            type_name: schema.map_or("", |schema| &schema.name),
            definition: schema.map(|schema| (&*schema.encoding, &*schema.text)),
        },
    })
}

fn timed(damage: Damage) -> TimedDamage {
    let from = damage.times_ns.map(|(from, _)| i64::try_from(from));
    (from.and_then(Result::ok), damage.reason)
}
