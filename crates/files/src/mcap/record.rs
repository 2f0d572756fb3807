//! Records of an MCAP file that we read ourselves (<https://mcap.dev/spec>), bounds-checked;
//! chunks are unpacked by the `mcap` crate.

use std::collections::BTreeMap;

use crate::bytes::{Bytes, Short};

/// No record, packed or unpacked, may be longer: 256 MiB.
pub(crate) const LENGTH_LIMIT: u64 = 256 << 20;

/// Length of the opcode and the length in front of every record.
pub(crate) const HEAD: u64 = 9;

/// One top-level record, head included.
pub(crate) struct RawRecord {
    pub(crate) bytes: Vec<u8>,
    /// The file ends before the record does.
    pub(crate) is_cut: bool,
}

impl RawRecord {
    pub(crate) fn opcode(&self) -> u8 {
        self.bytes[0]
    }

    pub(crate) fn body(&self) -> &[u8] {
        &self.bytes[HEAD as usize..]
    }
}

/// A message type as the file describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Schema {
    pub(crate) name: String,
    pub(crate) encoding: String,
    pub(crate) text: Vec<u8>,
}

/// A topic as the file describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Channel {
    pub(crate) schema_id: u16,
    pub(crate) topic: String,
    pub(crate) encoding: String,
    pub(crate) metadata: BTreeMap<String, String>,
}

/// One message.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Message<'a> {
    pub(crate) channel_id: u16,
    pub(crate) sequence: u32,
    pub(crate) log_time_ns: u64,
    pub(crate) publish_time_ns: u64,
    pub(crate) data: &'a [u8],
}

/// An attached file. Its name comes from the file and is never used as a path.
#[derive(Debug, Clone)]
pub(crate) struct Attachment<'a> {
    pub(crate) log_time_ns: u64,
    pub(crate) create_time_ns: u64,
    pub(crate) name: String,
    pub(crate) media_type: String,
    pub(crate) data: &'a [u8],
    pub(crate) is_sound: bool,
}

/// Where a chunk is and which log times it covers, as the index at the end of the file says.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChunkIndex {
    pub(crate) from_ns: u64,
    pub(crate) to_ns: u64,
    pub(crate) offset: u64,
    pub(crate) length: u64,
}

impl ChunkIndex {
    /// The first and the last log time.
    pub(crate) fn times_ns(&self) -> (u64, u64) {
        (self.from_ns, self.to_ns)
    }
}

fn text_map(bytes: &mut Bytes) -> Result<BTreeMap<String, String>, Short> {
    let mut pairs = Bytes::new(bytes.block()?);
    let mut map = BTreeMap::new();
    while pairs.left() > 0 {
        map.insert(pairs.text()?, pairs.text()?);
    }
    Ok(map)
}

pub(crate) fn schema(body: &[u8]) -> Result<(u16, Schema), Short> {
    let mut bytes = Bytes::new(body);
    let id = bytes.u16()?;
    let schema = Schema {
        name: bytes.text()?,
        encoding: bytes.text()?,
        text: bytes.block()?.to_vec(),
    };
    Ok((id, schema))
}

pub(crate) fn channel(body: &[u8]) -> Result<(u16, Channel), Short> {
    let mut bytes = Bytes::new(body);
    let id = bytes.u16()?;
    let channel = Channel {
        schema_id: bytes.u16()?,
        topic: bytes.text()?,
        encoding: bytes.text()?,
        metadata: text_map(&mut bytes)?,
    };
    Ok((id, channel))
}

pub(crate) fn message(body: &[u8]) -> Result<Message<'_>, Short> {
    let mut bytes = Bytes::new(body);
    Ok(Message {
        channel_id: bytes.u16()?,
        sequence: bytes.u32()?,
        log_time_ns: bytes.u64()?,
        publish_time_ns: bytes.u64()?,
        data: bytes.rest(),
    })
}

pub(crate) fn metadata(body: &[u8]) -> Result<(String, BTreeMap<String, String>), Short> {
    let mut bytes = Bytes::new(body);
    Ok((bytes.text()?, text_map(&mut bytes)?))
}

pub(crate) fn attachment(body: &[u8]) -> Result<Attachment<'_>, Short> {
    let mut bytes = Bytes::new(body);
    Ok(Attachment {
        log_time_ns: bytes.u64()?,
        create_time_ns: bytes.u64()?,
        name: bytes.text()?,
        media_type: bytes.text()?,
        data: bytes.long_block()?,
        is_sound: holds(crc32fast::hash(&body[..bytes.at()]), bytes.u32()?),
    })
}

/// Whether a checksum is the one that was saved; 0 says that the writer made none.
pub(crate) fn holds(found: u32, saved: u32) -> bool {
    saved == 0 || saved == found
}

pub(crate) fn chunk_index(body: &[u8]) -> Result<ChunkIndex, Short> {
    let mut bytes = Bytes::new(body);
    Ok(ChunkIndex {
        from_ns: bytes.u64()?,
        to_ns: bytes.u64()?,
        offset: bytes.u64()?,
        length: bytes.u64()?,
    })
}
