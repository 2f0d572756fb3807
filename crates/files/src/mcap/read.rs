//! Reader of MCAP files as they come out of robots and disks: cut, flipped, hostile. Every chunk is
//! unpacked on its own and only after its checksum was verified; what cannot be read is reported as
//! [`Damage`], the rest is delivered.

use std::io::{Read, Seek};
use std::path::Path;

use mcap::records::op;

use crate::budget::Budget;
use crate::error::FileError;
use crate::loss::Damage;
use crate::mcap::chunk::{Topics, Visit, unpack, unpacked_bytes};
use crate::mcap::open::open_mcap;
use crate::mcap::record::RawRecord;
use crate::mcap::walk::Walk;

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

impl Part {
    /// Whether a chunk with these log times is read.
    pub(crate) fn holds(self, (from_ns, to_ns): (u64, u64)) -> bool {
        match self {
            Self::All => true,
            Self::Description => false,
            Self::Window(first_ns, last_ns) => from_ns <= last_ns && to_ns >= first_ns,
        }
    }
}

/// Reads the file at `path` by [`scan`].
pub(crate) fn scan_file(
    path: &Path,
    part: Part,
    visit: &mut Visit,
) -> Result<Vec<Damage>, FileError> {
    scan(open_mcap(path)?, path, part, visit)
}

/// Reads a file from start to end and hands everything sound to `visit`.
pub(crate) fn scan<R: Read + Seek>(
    file: R,
    path: &Path,
    part: Part,
    visit: &mut Visit,
) -> Result<Vec<Damage>, FileError> {
    let failed = FileError::cannot("read", path);
    let (mut walk, mut topics) = Walk::begin(file, part).map_err(failed)?;
    let budget = Budget::allowed(path);
    while let Some(record) = walk.next_record(part).map_err(failed)? {
        let n_bytes = record.bytes.len() as u64 + unpacked_bytes(&record);
        budget.check("one of its records", n_bytes)?;
        let delivered = deliver(&record, &mut walk, &mut topics, visit);
        delivered
            .map_err(|error| error.beside(walk.damages.first().map(|damage| &*damage.reason)))?;
    }
    if let Some(reason) = topics.orphaned() {
        walk.damaged(None, reason);
    }
    Ok(walk.damages)
}

/// Hands what a record holds to `visit`; what is broken in it is noted as damage.
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
    } else if let Err(reason) = topics.take(record.opcode(), record.body(), visit)? {
        walk.damaged(
            None,
            format!("the record before byte {} is broken: {reason}", walk.at),
        );
    }
    Ok(())
}
