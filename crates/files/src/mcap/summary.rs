//! Summary at the end of an MCAP file: the topics once more and where the chunks are. With it, one
//! broken record does not hide the chunks behind it.

use std::io::{self, Read, Seek, SeekFrom};

use mcap::records::op;

use crate::bytes::{Bytes, Short};
use crate::mcap::chunk::Topics;
use crate::mcap::record::{self, ChunkIndex, LENGTH_LIMIT};

/// Length of the footer record with its head, and of the magic bytes behind it.
const FOOTER: u64 = 9 + 20;
const MAGIC: u64 = 8;

/// The last bytes of a file: its footer and the magic bytes.
type End = [u8; (FOOTER + MAGIC) as usize];

/// What the end of the file says about its content.
#[derive(Debug, Default)]
pub(crate) struct Summary {
    pub(crate) topics: Topics,
    /// In order of offset.
    pub(crate) chunks: Vec<ChunkIndex>,
}

impl Summary {
    fn take(&mut self, opcode: u8, body: &[u8]) -> Result<(), Short> {
        match opcode {
            // what is wrong with a definition is told where it stands before the messages
            op::SCHEMA | op::CHANNEL => drop(self.topics.define(opcode, body)),
            op::CHUNK_INDEX => self.chunks.push(record::chunk_index(body)?),
            _ => {}
        }
        Ok(())
    }
}

/// Reads the summary; an empty one where the writer left it out, or why the end of the file cannot
/// be used.
pub(crate) fn read<R: Read + Seek>(
    file: &mut R,
    length: u64,
) -> io::Result<Result<Summary, String>> {
    let Some(footer_at) = length.checked_sub(FOOTER + MAGIC).filter(|&at| at >= MAGIC) else {
        return Ok(Err("the file is cut".into()));
    };
    let mut end: End = [0; (FOOTER + MAGIC) as usize];
    read_at(file, footer_at, &mut end)?;
    let (start, size) = match place(&end, footer_at) {
        Ok(Some(place)) => place,
        Ok(None) => return Ok(Ok(Summary::default())),
        Err(reason) => return Ok(Err(reason)),
    };
    let mut section = vec![0; size as usize];
    read_at(file, start, &mut section)?;
    if !is_sound(&section, &end) {
        return Ok(Err("the checksum of the summary fails".into()));
    }
    Ok(parse(&section).map_err(|short| format!("the summary is broken: {short}")))
}

fn read_at<R: Read + Seek>(file: &mut R, offset: u64, bytes: &mut [u8]) -> io::Result<()> {
    file.seek(SeekFrom::Start(offset))?;
    file.read_exact(bytes)
}

/// Where the summary begins and how long it is; `None` where the writer left it out.
fn place(end: &End, footer_at: u64) -> Result<Option<(u64, u64)>, String> {
    if end[FOOTER as usize..] != *mcap::MAGIC || end[0] != op::FOOTER {
        return Err("the file has no end: it was cut, or its writer did not finish".into());
    }
    let start = u64::from_le_bytes(end[9..17].try_into().unwrap_or_default());
    if start == 0 {
        return Ok(None);
    }
    match footer_at.checked_sub(start) {
        Some(size) if size <= LENGTH_LIMIT => Ok(Some((start, size))),
        _ => Err(format!(
            "the footer puts the summary at byte {start}, which cannot be"
        )),
    }
}

/// Whether the checksum in the footer, if there is one, is that of summary and footer.
fn is_sound(section: &[u8], end: &End) -> bool {
    let crc = u32::from_le_bytes(end[25..29].try_into().unwrap_or_default());
    let mut found = crc32fast::Hasher::new_with_initial_len(0, 0);
    found.update(section);
    found.update(&end[..25]);
    record::holds(found.finalize(), crc)
}

fn parse(section: &[u8]) -> Result<Summary, Short> {
    let mut bytes = Bytes::new(section);
    let mut summary = Summary::default();
    while bytes.left() > 0 {
        let [opcode] = bytes.array()?;
        let body = bytes.long_block()?;
        summary.take(opcode, body)?;
    }
    summary.chunks.sort_by_key(|chunk| chunk.offset);
    Ok(summary)
}
