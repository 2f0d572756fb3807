//! Walk through an MCAP file from record to record, over the broken ones where the index knows the
//! next sound chunk.

use std::io::{self, Read, Seek, SeekFrom};

use mcap::records::op;

use crate::loss::Damage;
use crate::mcap::chunk::{Topics, check_schema};
use crate::mcap::read::Part;
use crate::mcap::record::{self, ChunkIndex, HEAD, LENGTH_LIMIT, RawRecord};
use crate::mcap::summary::{self, Summary};

/// Opcode and length in front of a record.
type Head = [u8; HEAD as usize];

/// Where the walk is, and what it found broken.
pub(crate) struct Walk<R> {
    file: R,
    length: u64,
    /// Offset of the next record.
    pub(crate) at: u64,
    /// By offset; empty where the file has no index.
    chunks: Vec<ChunkIndex>,
    /// Checksum of the data section so far; none when parts of it are skipped.
    crc: Option<crc32fast::Hasher>,
    pub(crate) damages: Vec<Damage>,
}

impl<R> Walk<R> {
    pub(crate) fn damaged(&mut self, times_ns: Option<(u64, u64)>, reason: String) {
        self.damages.push(Damage { times_ns, reason });
    }

    /// The indexed chunks that are not before this offset.
    fn chunks_from(&self, offset: u64) -> &[ChunkIndex] {
        let before = self.chunks.partition_point(|chunk| chunk.offset < offset);
        &self.chunks[before..]
    }

    /// The first of them.
    fn chunk_from(&self, offset: u64) -> Option<ChunkIndex> {
        self.chunks_from(offset).first().copied()
    }

    /// The log times of the chunk that was just read: the index's, protected by a checksum, before
    /// the chunk's own.
    pub(crate) fn times_of(&self, chunk: &RawRecord) -> Option<(u64, u64)> {
        let offset = self.at - chunk.bytes.len() as u64;
        let index = self.chunk_from(offset);
        match index.filter(|index| index.offset == offset) {
            Some(index) => Some(index.times_ns()),
            None => chunk.body().first_chunk().copied().map(times_ns),
        }
    }
}

impl<R: Read + Seek> Walk<R> {
    /// Begins behind the magic bytes of a file; returns also the topics that its summary knows.
    pub(crate) fn begin(mut file: R, part: Part) -> io::Result<(Self, Topics)> {
        let length = file.seek(SeekFrom::End(0))?;
        let mut damages = Vec::new();
        let Summary { topics, chunks } =
            summary::read(&mut file, length)?.unwrap_or_else(|reason| {
                let times_ns = None;
                damages.push(Damage { times_ns, reason });
                Summary::default()
            });
        let at = mcap::MAGIC.len() as u64;
        file.seek(SeekFrom::Start(at))?;
        let mut crc = crc32fast::Hasher::new();
        crc.update(mcap::MAGIC);
        let walk = Self {
            file,
            length,
            at,
            chunks,
            crc: (part == Part::All).then_some(crc),
            damages,
        };
        Ok((walk, topics))
    }

    /// The next record worth reading; `None` at the end of the data.
    pub(crate) fn next_record(&mut self, part: Part) -> io::Result<Option<RawRecord>> {
        loop {
            match self.step(part)? {
                Step::Record(record) => return Ok(Some(record)),
                Step::Over => {}
                Step::End => return Ok(None),
            }
        }
    }

    /// Reads the next record, or steps over it.
    fn step(&mut self, part: Part) -> io::Result<Step> {
        let left = self.length.saturating_sub(self.at);
        if left < HEAD {
            let end = self.length;
            let reason = format!("the file ends in the middle of a record, at byte {end}");
            self.damaged(None, reason);
            return Ok(Step::End);
        }
        let (head, room) = self.read_head()?;
        let size = length_of(head);
        if size > room {
            return self.step_over_broken(head, left);
        }
        match head[0] {
            op::DATA_END | op::FOOTER => {
                self.check_data_crc(head)?;
                Ok(Step::End)
            }
            op::CHUNK if !self.is_in(part)? => self.step_over_chunk(size, part),
            op::MESSAGE_INDEX if self.crc.is_none() => self.step_over(size),
            opcode => match self.check_size(opcode, size) {
                Ok(()) => self.read_record(head, size, false).map(Step::Record),
                Err(reason) => {
                    self.damaged(None, reason);
                    self.step_over(size)
                }
            },
        }
    }

    /// Refuses a record by its size, before it is read.
    fn check_size(&self, opcode: u8, size: u64) -> Result<(), String> {
        if size > LENGTH_LIMIT {
            let at = self.at;
            return Err(format!(
                "the record at byte {at} claims {size} bytes; the limit is {LENGTH_LIMIT}"
            ));
        }
        if opcode == op::SCHEMA {
            return check_schema(size);
        }
        Ok(())
    }

    /// Leaves out a record of this size, and with it the checksum over the whole file.
    fn step_over(&mut self, size: u64) -> io::Result<Step> {
        self.crc = None;
        self.seek(self.at + HEAD + size)?;
        Ok(Step::Over)
    }

    /// Leaves out a chunk that is not in the part to be read, and those behind it that are not.
    fn step_over_chunk(&mut self, size: u64, part: Part) -> io::Result<Step> {
        let Some(next) = self.behind(self.at + HEAD + size, part) else {
            return Ok(Step::End);
        };
        self.seek(next)?;
        Ok(Step::Over)
    }

    /// The next head, and the room there is for the record: up to the next indexed chunk. Where the
    /// index says that a chunk begins, its word counts: it is protected by a checksum, the head is
    /// not.
    fn read_head(&mut self) -> io::Result<(Head, u64)> {
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

    /// Goes on behind a record that is longer than the room for it: at the next indexed chunk, or
    /// with what there is of the file.
    fn step_over_broken(&mut self, head: Head, left: u64) -> io::Result<Step> {
        let next = self.chunk_from(self.at + 1);
        match next.filter(|chunk| chunk.offset < self.length) {
            Some(chunk) => self.step_to(chunk.offset),
            None => self.step_over_cut(head, left),
        }
    }

    /// Leaves out the broken records before the chunk at this offset.
    fn step_to(&mut self, offset: u64) -> io::Result<Step> {
        let from = self.at;
        let reason = format!("the records between bytes {from} and {offset} are broken");
        self.damaged(None, reason);
        self.crc = None;
        self.seek(offset)?;
        Ok(Step::Over)
    }

    /// Takes what there is of a chunk at the end of a cut file, and nothing of any other record.
    fn step_over_cut(&mut self, head: Head, left: u64) -> io::Result<Step> {
        let (at, claimed, size) = (self.at, length_of(head), left - HEAD);
        let reason = format!(
            "the record at byte {at} claims {claimed} bytes, {size} are left: the file is cut"
        );
        self.damaged(None, reason);
        if head[0] == op::CHUNK && left < LENGTH_LIMIT {
            return self.read_record(head, size, true).map(Step::Record);
        }
        Ok(Step::End)
    }

    fn seek(&mut self, to: u64) -> io::Result<()> {
        self.at = to;
        self.file.seek(SeekFrom::Start(to)).map(drop)
    }

    /// Whether the chunk whose head was just read is in the part to be read.
    fn is_in(&mut self, part: Part) -> io::Result<bool> {
        if !matches!(part, Part::Window(..)) {
            return Ok(part == Part::All);
        }
        if self.length - self.at < HEAD + 16 {
            return Ok(true);
        }
        let mut times = [0; 16];
        self.file.read_exact(&mut times)?;
        self.file.seek(SeekFrom::Start(self.at + HEAD))?;
        Ok(part.holds(times_ns(times)))
    }

    /// Where to go on behind a chunk that is not in the part: with an index straight to the next
    /// one that is, or nowhere.
    fn behind(&self, offset: u64, part: Part) -> Option<u64> {
        if !matches!(part, Part::Window(..)) || self.chunks.is_empty() {
            return Some(offset);
        }
        let mut later = self.chunks_from(offset).iter();
        let next = later.find(|chunk| part.holds(chunk.times_ns()))?.offset;
        (next < self.length).then_some(next)
    }

    fn read_record(&mut self, head: Head, size: u64, is_cut: bool) -> io::Result<RawRecord> {
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
    fn check_data_crc(&mut self, head: Head) -> io::Result<()> {
        let has_crc = head[0] == op::DATA_END && length_of(head) >= 4;
        let Some(crc) = self.crc.take().filter(|_| has_crc) else {
            return Ok(());
        };
        let mut saved = [0; 4];
        self.file.read_exact(&mut saved)?;
        let holds = record::holds(crc.finalize(), u32::from_le_bytes(saved));
        if !holds && self.damages.is_empty() {
            let reason = "the checksum over the whole file fails while those of the chunks hold: metadata, attachments, the \
                          index or messages outside of chunks are damaged";
            self.damaged(None, reason.into());
        }
        Ok(())
    }
}

/// A step of the walk.
enum Step {
    /// A record was read.
    Record(RawRecord),
    /// Something was left out.
    Over,
    /// Nothing follows.
    End,
}

fn length_of(head: Head) -> u64 {
    let [_, length @ ..] = head;
    u64::from_le_bytes(length)
}

/// The first and last log time, as a chunk begins with them.
fn times_ns(times: [u8; 16]) -> (u64, u64) {
    let time = |at: usize| u64::from_le_bytes(std::array::from_fn(|k| times[at + k]));
    (time(0), time(8))
}
