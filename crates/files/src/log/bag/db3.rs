//! rosbag2 recordings in SQLite (`.db3`), schema 1 to 4: definitions from the file where it has them, else known
//! types.

use std::collections::HashMap;
use std::fmt::Display;
use std::path::Path;

use rusqlite::{Connection, OpenFlags, Row};

use crate::error::FileError;
use crate::log::bag::message::{Described, Received};
use crate::log::bag::{self, Take, contents};
use crate::log::listing::Listing;
use crate::log::map::{LogMap, Signals};
use crate::log::recording::{Recording, TimedDamage};

/// First bytes of a file of SQLite.
pub(crate) const MAGIC: &[u8] = b"SQLite format 3\0";
/// Whether what is read is computed, by a view or in a column: of any length, without end.
const COMPUTED: &str = "SELECT EXISTS (SELECT 1 FROM sqlite_schema AS known
    WHERE lower(name) IN ('topics', 'messages', 'message_definitions')
    AND (type = 'view' OR sql LIKE 'CREATE VIRTUAL%' OR EXISTS (SELECT 1 FROM pragma_table_xinfo(known.name) WHERE hidden != 0)))";
const TOPICS: &str = "SELECT id, name, type, serialization_format FROM topics";
const DEFINITIONS: &str =
    "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions";
const MESSAGES: &str = "SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id";

/// A topic of the bag.
struct Topic {
    name: String,
    type_name: String,
    format: String,
}

/// Encoding and text of the definition of a type.
type Definitions = HashMap<String, (String, Vec<u8>)>;

/// Reads every mapped topic.
pub(crate) fn read(path: &Path, _map: &LogMap, signals: &Signals) -> Result<Recording, FileError> {
    bag::read(path, signals, |take| scan(path, take))
}

/// Lists its topics.
pub(crate) fn list(path: &Path) -> Result<Listing, FileError> {
    contents::list("rosbag2 SQLite", |take| scan(path, take))
}

/// Hands over all messages; returns the damages to the file.
pub(crate) fn scan(path: &Path, take: &mut Take) -> Result<Vec<TimedDamage>, FileError> {
    Bag::open(path)?.scan(take)
}

struct Bag<'p> {
    path: &'p Path,
    database: Connection,
    topics: HashMap<i64, Topic>,
    definitions: Definitions,
}

impl<'p> Bag<'p> {
    fn open(path: &'p Path) -> Result<Self, FileError> {
        let opened = || {
            let database = Connection::open_with_flags(uri(path), flags())?;
            // of what is computed no row is asked for
            let is_computed = database.query_row(COMPUTED, [], |row| row.get(0))?;
            if is_computed {
                return Ok(None);
            }
            let topics = rows(&database, TOPICS, |row| {
                let topic = Topic {
                    name: row.get(1)?,
                    type_name: row.get(2)?,
                    format: row.get(3)?,
                };
                Ok((row.get(0)?, topic))
            })?;
            // only schema 4 has the table
            let definitions = rows(&database, DEFINITIONS, |row| {
                Ok((row.get(0)?, (row.get(1)?, text_of(row)?)))
            });
            Ok(Some((database, topics, definitions.unwrap_or_default())))
        };
        let opened = opened().map_err(|error: rusqlite::Error| no_bag(path, &error))?;
        let Some((database, topics, definitions)) = opened else {
            let found = "topics or messages that are computed, by a view or in a column";
            return Err(no_bag(path, &found));
        };
        Ok(Self {
            path,
            database,
            topics: topics.into_iter().collect(),
            definitions: definitions.into_iter().collect(),
        })
    }

    /// Hands over all messages in the order of their times; returns the damage to the file.
    fn scan(&self, take: &mut Take) -> Result<Vec<TimedDamage>, FileError> {
        let failed = |error: rusqlite::Error| no_bag(self.path, &error);
        let mut statement = self.database.prepare(MESSAGES).map_err(failed)?;
        let mut messages = statement.query([]).map_err(failed)?;
        let mut last_ns = None;
        loop {
            match messages.next() {
                Ok(None) => return Ok(Vec::new()),
                Ok(Some(row)) => last_ns = self.take(row, take)?.or(last_ns),
                Err(error) => return Ok(vec![(last_ns, format!("cannot read on: {error}"))]),
            }
        }
    }

    /// Hands over a message; returns its time.
    fn take(&self, row: &Row, take: &mut Take) -> Result<Option<i64>, FileError> {
        let read = || Ok((row.get(0)?, row.get(1)?, row.get_ref(2)?.as_blob()?));
        let (id, time_ns, data) =
            read().map_err(|error: rusqlite::Error| no_bag(self.path, &error))?;
        let Some(topic) = self.topics.get(&id) else {
            return Ok(None);
        };
        let definition = self.definitions.get(&topic.type_name);
        take(&Received {
            path: self.path,
            topic: &topic.name,
            data,
            recorders_ns: time_ns,
            described: Described {
                encoding: &topic.format,
                type_name: &topic.type_name,
                definition: definition.map(|(encoding, text)| (encoding.as_str(), text.as_slice())),
            },
        })?;
        Ok(Some(time_ns))
    }
}

/// All rows of a query.
fn rows<T>(
    database: &Connection,
    query: &str,
    row: impl FnMut(&Row) -> rusqlite::Result<T>,
) -> rusqlite::Result<Vec<T>> {
    database.prepare(query)?.query_map([], row)?.collect()
}

/// The text of a definition, kept as text or as bytes.
fn text_of(row: &Row) -> rusqlite::Result<Vec<u8>> {
    Ok(row.get_ref(2)?.as_bytes()?.to_vec())
}

fn flags() -> OpenFlags {
    OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX
}

/// The file as one that nobody writes, unless a log beside it says otherwise: then nothing is written beside it.
fn uri(path: &Path) -> String {
    let mut wal = path.as_os_str().to_owned();
    wal.push("-wal");
    let path = path.to_string_lossy();
    let path = path
        .replace('%', "%25")
        .replace('?', "%3f")
        .replace('#', "%23");
    match Path::new(&wal).exists() {
        true => format!("file:{path}"),
        false => format!("file:{path}?immutable=1"),
    }
}

fn no_bag(path: &Path, error: &dyn Display) -> FileError {
    let advice = "if it is cut: sqlite3 FILE .recover; else convert it: ros2 bag convert, or rosbags-convert, to mcap";
    FileError::format(
        path,
        error.to_string(),
        "a rosbag2 recording in SQLite",
        advice,
    )
}
