//! Content of chunks, and of records outside of them: topics, messages, metadata and attachments.

use std::collections::{BTreeMap, HashMap};

use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::budget::by_length;
use crate::bytes::Short;
use crate::error::{FileError, chain};
use crate::mcap::plain_chunk::{plain, read_plain};
use crate::mcap::record::{self, Attachment, Channel, LENGTH_LIMIT, Message, RawRecord, Schema};

/// What a file holds, in the order of the file.
pub(crate) enum Entry<'a> {
    Metadata {
        name: String,
        values: BTreeMap<String, String>,
    },
    Attachment(Attachment<'a>),
    Message {
        channel: &'a Channel,
        schema: Option<&'a Schema>,
        message: Message<'a>,
    },
}

/// Takes the entries; an error stops the reading.
pub(crate) type Visit<'v> = dyn FnMut(Entry<'_>) -> Result<(), FileError> + 'v;

/// What became of a record: the outer error stops the reading, the inner one is damage, told in
/// words.
pub(crate) type Taken = Result<Result<(), String>, FileError>;

/// The topics defined so far, and how many messages had none.
#[derive(Debug, Default)]
pub(crate) struct Topics {
    schemas: HashMap<u16, Schema>,
    channels: HashMap<u16, Channel>,
    orphans: usize,
}

impl Topics {
    /// What was lost with the definitions of topics.
    pub(crate) fn orphaned(&self) -> Option<String> {
        let count = self.orphans;
        let reason = format!("{count} messages belong to topics whose definition is lost");
        (count > 0).then_some(reason)
    }

    /// Takes in a schema or channel record. Definitions are repeated in a file; the first one
    /// holds.
    pub(crate) fn define(&mut self, opcode: u8, body: &[u8]) -> Result<(), String> {
        if opcode == op::SCHEMA {
            check_schema(body.len() as u64)?;
            let (id, schema) = record::schema(body).map_err(in_words)?;
            self.schemas.entry(id).or_insert(schema);
        } else {
            let (id, channel) = record::channel(body).map_err(in_words)?;
            self.channels.entry(id).or_insert(channel);
        }
        Ok(())
    }

    /// Hands one record to `visit` if it is of interest.
    pub(crate) fn take(&mut self, opcode: u8, body: &[u8], visit: &mut Visit) -> Taken {
        if matches!(opcode, op::SCHEMA | op::CHANNEL) {
            return Ok(self.define(opcode, body));
        }
        match self.entry(opcode, body) {
            Ok(Some(entry)) => visit(entry).map(Ok),
            Ok(None) => Ok(Ok(())),
            Err(short) => Ok(Err(in_words(short))),
        }
    }

    /// What a record holds, if it is of interest.
    fn entry<'a>(&'a mut self, opcode: u8, body: &'a [u8]) -> Result<Option<Entry<'a>>, Short> {
        Ok(match opcode {
            op::METADATA => {
                let (name, values) = record::metadata(body)?;
                Some(Entry::Metadata { name, values })
            }
            op::ATTACHMENT => Some(Entry::Attachment(record::attachment(body)?)),
            op::MESSAGE => self.message(record::message(body)?),
            _ => None,
        })
    }

    /// A message with its topic; one without is counted.
    fn message<'a>(&'a mut self, message: Message<'a>) -> Option<Entry<'a>> {
        let Some(channel) = self.channels.get(&message.channel_id) else {
            self.orphans += 1;
            return None;
        };
        Some(Entry::Message {
            channel,
            schema: self.schemas.get(&channel.schema_id),
            message,
        })
    }
}

/// No message type needs a longer description: 1 MiB.
const LONGEST_SCHEMA: u64 = 1 << 20;

/// Refuses the description of a message type by its length.
pub(crate) fn check_schema(length: u64) -> Result<(), String> {
    if length <= LONGEST_SCHEMA {
        return Ok(());
    }
    Err(format!(
        "a schema has {length} bytes, no message type needs more than {LONGEST_SCHEMA}"
    ))
}

fn in_words(short: Short) -> String {
    short.to_string()
}

/// Takes a record of a chunk by opcode and body.
pub(crate) type Take<'t> = dyn FnMut(u8, &[u8]) -> Taken + 't;

/// Unpacks a chunk into `take`, after its checksum was verified. Of a chunk whose end is cut off,
/// which no checksum covers, it delivers what comes before the cut.
pub(crate) fn unpack(chunk: &RawRecord, take: &mut Take) -> Taken {
    if let Some((crc, records)) = plain(chunk) {
        return read_plain(crc, records, take);
    }
    let limit = limit_of(chunk);
    let mut reader = reader_of(chunk, limit);
    let mut left = &chunk.bytes[..];
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(count)) => left = feed(&mut reader, count, left),
            Ok(LinearReadEvent::Record { data, opcode }) => {
                if let Err(reason) = take(opcode, data)? {
                    return Ok(Err(reason));
                }
            }
            Err(error) => return Ok(Err(told(&error, limit))),
        }
    }
    Ok(Ok(()))
}

/// What a chunk may be unpacked to.
fn limit_of(chunk: &RawRecord) -> u64 {
    by_length(chunk.bytes.len() as u64).min(LENGTH_LIMIT)
}

/// Bytes that unpacking a record takes; none of what is no chunk, and of one that is refused.
pub(crate) fn unpacked_bytes(record: &RawRecord) -> u64 {
    let claimed = record
        .body()
        .get(16..24)
        .and_then(|bytes| bytes.first_chunk());
    let claimed = claimed.map_or(0, |bytes| u64::from_le_bytes(*bytes));
    let is_unpacked = record.opcode() == op::CHUNK && claimed <= limit_of(record);
    if is_unpacked { claimed } else { 0 }
}

/// A reader of a chunk's records, which verifies the checksum first unless the end is cut off.
fn reader_of(chunk: &RawRecord, limit: u64) -> LinearReader {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(!chunk.is_cut)
        .with_record_length_limit(limit as usize);
    LinearReader::new_with_options(options)
}

/// Gives the reader up to `count` of the bytes; returns those behind them.
fn feed<'b>(reader: &mut LinearReader, count: usize, left: &'b [u8]) -> &'b [u8] {
    let (now, later) = left.split_at(count.min(left.len()));
    reader.insert(now.len()).copy_from_slice(now);
    reader.notify_read(now.len());
    later
}

/// The reader's error with the numbers that a user can act upon.
fn told(error: &McapError, limit: u64) -> String {
    match error {
        McapError::ChunkTooLarge(found) | McapError::RecordTooLarge { len: found, .. } => {
            format!("it claims {found} bytes; the limit is {limit}")
        }
        other => chain(other),
    }
}
