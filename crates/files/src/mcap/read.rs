//! Reads MCAP files as they come out of robots and disks: cut, flipped, hostile. Every chunk is
//! unpacked on its own and only after its checksum was verified; what cannot be read is reported as
//! [`Damage`], the rest is delivered.

use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use mcap::records::op;

use crate::error::FileError;
use crate::mcap::chunk::{Topics, Visit, unpack};
use crate::mcap::record::ChunkIndex;
use crate::mcap::summary::{self, Summary};

/// No record, packed or unpacked, may be longer: 256 MiB.
pub(crate) const LENGTH_LIMIT: u64 = 256 << 20;

/// Length of the opcode and the length in front of every record.
const HEAD: u64 = 9;

/// A part of the file that could not be read, with the log times it covered where these are known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Damage {
    pub(crate) times_ns: Option<(u64, u64)>,
    pub(crate) reason: String,
}

/// One top-level record, head included.
pub(crate) struct RawRecord {
    pub(crate) bytes: Vec<u8>,
    /// The file ends before the record does.
    pub(crate) is_cut: bool,
}

impl RawRecord {
    fn opcode(&self) -> u8 {
        self.bytes[0]
    }

    fn body(&self) -> &[u8] {
        &self.bytes[HEAD as usize..]
    }
}

/// Which part of a file to read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// Everything, so that the checksum over the whole file is verified too.
    All,
    /// What stands outside of chunks: metadata and attachments.
    Description,
    /// Chunks that hold anything between these log times, both included; the others are not even
    /// read.
    Window(u64, u64),
}

/// Reads a file from start to end and hands everything sound to `visit`.
pub(crate) fn scan<R: Read + Seek>(
    mut file: R,
    path: &Path,
    part: Part,
    visit: &mut Visit,
) -> Result<Vec<Damage>, FileError> {
    let failed = |error: io::Error| FileError::Io {
        path: path.into(),
        action: "read",
        reason: error.to_string(),
    };
    let length = file.seek(SeekFrom::End(0)).map_err(failed)?;
    let mut damages = Vec::new();
    let summary = summary::read(&mut file, length)
        .map_err(failed)?
        .unwrap_or_else(|reason| {
            damages.push(Damage {
                times_ns: None,
                reason,
            });
            Summary::default()
        });
    let at = mcap::MAGIC.len() as u64;
    file.seek(SeekFrom::Start(at)).map_err(failed)?;
    let mut crc = crc32fast::Hasher::new();
    crc.update(mcap::MAGIC);
    let crc = (part == Part::All).then_some(crc);
    let mut walk = Walk {
        file,
        length,
        at,
        chunks: summary.chunks,
        crc,
        damages,
    };
    let mut topics = summary.topics;
    while let Some(record) = walk.next_record(part).map_err(failed)? {
        deliver(&record, &mut walk, &mut topics, visit)?;
    }
    if topics.orphans > 0 {
        walk.damaged(
            None,
            format!(
                "{} messages belong to topics whose definition is lost",
                topics.orphans
            ),
        );
    }
    Ok(walk.damages)
}

fn deliver<R>(
    record: &RawRecord,
    walk: &mut Walk<R>,
    topics: &mut Topics,
    visit: &mut Visit,
) -> Result<(), FileError> {
    if record.opcode() == op::CHUNK {
        if let Err(reason) = unpack(record, &mut |opcode, body| topics.take(opcode, body, visit))? {
            walk.damaged(
                walk.times_of(record),
                format!("the chunk before byte {} cannot be read: {reason}", walk.at),
            );
        }
    } else if let Err(short) = topics.take(record.opcode(), record.body(), visit)? {
        walk.damaged(
            None,
            format!("the record before byte {} is broken: {short}", walk.at),
        );
    }
    Ok(())
}

/// Steps from record to record, and over the broken ones where the index knows the next sound
/// chunk.
struct Walk<R> {
    file: R,
    length: u64,
    at: u64,
    /// By offset; empty where the file has no index.
    chunks: Vec<ChunkIndex>,
    /// Checksum of the data section so far; none when parts of it are skipped.
    crc: Option<crc32fast::Hasher>,
    damages: Vec<Damage>,
}

impl<R> Walk<R> {
    fn damaged(&mut self, times_ns: Option<(u64, u64)>, reason: String) {
        self.damages.push(Damage { times_ns, reason });
    }

    /// The first indexed chunk that is not before this offset.
    fn chunk_from(&self, offset: u64) -> Option<ChunkIndex> {
        self.chunks
            .get(self.chunks.partition_point(|chunk| chunk.offset < offset))
            .copied()
    }

    /// The log times of the chunk that was just read: the index's, protected by a checksum, before
    /// the chunk's own.
    fn times_of(&self, chunk: &RawRecord) -> Option<(u64, u64)> {
        let offset = self.at - chunk.bytes.len() as u64;
        let indexed = self
            .chunk_from(offset)
            .filter(|index| index.offset == offset);
        let indexed = indexed.map(|index| (index.from_ns, index.to_ns));
        indexed.or_else(|| chunk.body().first_chunk().map(|times| times_ns(*times)))
    }
}

impl<R: Read + Seek> Walk<R> {
    /// The next record worth reading; `None` at the end of the data.
    fn next_record(&mut self, part: Part) -> io::Result<Option<RawRecord>> {
        loop {
            let left = self.length.saturating_sub(self.at);
            if left < HEAD {
                self.damaged(
                    None,
                    format!(
                        "the file ends in the middle of a record, at byte {}",
                        self.length
                    ),
                );
                return Ok(None);
            }
            let (head, room) = self.read_head()?;
            let (opcode, size) = (head[0], length_of(head));
            if size > room {
                match self.step_over(opcode, size, left)? {
                    Step::Resumed => continue,
                    Step::Cut => return self.read_record(head, left - HEAD, true).map(Some),
                    Step::Lost => return Ok(None),
                }
            }
            let skip = match opcode {
                op::DATA_END | op::FOOTER => {
                    self.check_data_crc(head)?;
                    return Ok(None);
                }
                op::CHUNK if !self.is_in(part)? => {
                    let Some(next) = self.behind(self.at + HEAD + size, part) else {
                        return Ok(None);
                    };
                    self.seek(next)?;
                    continue;
                }
                op::MESSAGE_INDEX => self.crc.is_none(),
                _ => false,
            };
            if size > LENGTH_LIMIT {
                let reason = format!(
                    "the record at byte {} claims {size} bytes; the limit is {LENGTH_LIMIT}",
                    self.at
                );
                self.damaged(None, reason);
            } else if !skip {
                return self.read_record(head, size, false).map(Some);
            }
            self.crc = None;
            self.seek(self.at + HEAD + size)?;
        }
    }

    /// The next head, and the room there is for the record: up to the next indexed chunk. Where the
    /// index says that a chunk begins, its word counts: it is protected by a checksum, the head is
    /// not.
    fn read_head(&mut self) -> io::Result<([u8; 9], u64)> {
        let mut head = [0; HEAD as usize];
        self.file.read_exact(&mut head)?;
        let mut end = self.length;
        match self.chunk_from(self.at) {
            Some(chunk) if chunk.offset == self.at => {
                head[0] = op::CHUNK;
                head[1..].copy_from_slice(&chunk.length.saturating_sub(HEAD).to_le_bytes());
            }
            Some(chunk) => end = end.min(chunk.offset),
            None => {}
        }
        Ok((head, end.saturating_sub(self.at + HEAD)))
    }

    /// What to do with a record that is longer than the room for it.
    fn step_over(&mut self, opcode: u8, size: u64, left: u64) -> io::Result<Step> {
        if let Some(chunk) = self
            .chunk_from(self.at + 1)
            .filter(|chunk| chunk.offset < self.length)
        {
            self.damaged(
                None,
                format!(
                    "the records between bytes {} and {} are broken",
                    self.at, chunk.offset
                ),
            );
            self.crc = None;
            self.seek(chunk.offset)?;
            return Ok(Step::Resumed);
        }
        let reason = format!(
            "the record at byte {} claims {size} bytes, {} are left: the file is cut",
            self.at,
            left - HEAD
        );
        self.damaged(None, reason);
        Ok(if opcode == op::CHUNK && left < LENGTH_LIMIT {
            Step::Cut
        } else {
            Step::Lost
        })
    }

    fn seek(&mut self, to: u64) -> io::Result<()> {
        self.at = to;
        self.file.seek(SeekFrom::Start(to)).map(drop)
    }

    /// Whether the chunk whose head was just read is in the part to be read.
    fn is_in(&mut self, part: Part) -> io::Result<bool> {
        match part {
            Part::All => Ok(true),
            Part::Description => Ok(false),
            Part::Window(..) if self.length - self.at < HEAD + 16 => Ok(true),
            Part::Window(from, to) => {
                let mut times = [0; 16];
                self.file.read_exact(&mut times)?;
                self.file.seek(SeekFrom::Start(self.at + HEAD))?;
                let (start, end) = times_ns(times);
                Ok(start <= to && end >= from)
            }
        }
    }

    /// Where to go on behind a chunk that is not in the part: with an index straight to the next
    /// one that is, or nowhere.
    fn behind(&self, offset: u64, part: Part) -> Option<u64> {
        match part {
            Part::Window(from, to) if !self.chunks.is_empty() => {
                let later =
                    &self.chunks[self.chunks.partition_point(|chunk| chunk.offset < offset)..];
                let next = later
                    .iter()
                    .find(|chunk| chunk.from_ns <= to && chunk.to_ns >= from)?;
                Some(next.offset).filter(|&offset| offset < self.length)
            }
            _ => Some(offset),
        }
    }

    fn read_record(&mut self, head: [u8; 9], size: u64, is_cut: bool) -> io::Result<RawRecord> {
        let mut bytes = vec![0; (HEAD + size) as usize];
        bytes[..HEAD as usize].copy_from_slice(&head);
        self.file.read_exact(&mut bytes[HEAD as usize..])?;
        if let Some(crc) = &mut self.crc {
            crc.update(&bytes);
        }
        self.at += HEAD + size;
        Ok(RawRecord { bytes, is_cut })
    }

    /// At the end of the data, the checksum over everything before it: the only one that covers
    /// metadata.
    fn check_data_crc(&mut self, head: [u8; 9]) -> io::Result<()> {
        let Some(crc) = self
            .crc
            .take()
            .filter(|_| head[0] == op::DATA_END && length_of(head) >= 4)
        else {
            return Ok(());
        };
        let mut saved = [0; 4];
        self.file.read_exact(&mut saved)?;
        let saved = u32::from_le_bytes(saved);
        if saved != 0 && saved != crc.finalize() && self.damages.is_empty() {
            let reason = "the checksum over the whole file fails while those of the chunks hold: metadata, attachments, the \
                          index or messages outside of chunks are damaged";
            self.damaged(None, reason.into());
        }
        Ok(())
    }
}

/// How the walk goes on behind a broken record.
enum Step {
    /// At the next indexed chunk.
    Resumed,
    /// With the first part of a chunk, the last thing in the file.
    Cut,
    /// Not at all.
    Lost,
}

fn length_of(head: [u8; 9]) -> u64 {
    let [_, length @ ..] = head;
    u64::from_le_bytes(length)
}

/// The first and last log time, as a chunk begins with them.
fn times_ns(times: [u8; 16]) -> (u64, u64) {
    let time = |at: usize| u64::from_le_bytes(std::array::from_fn(|k| times[at + k]));
    (time(0), time(8))
}
