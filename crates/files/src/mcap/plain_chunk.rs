//! Plain chunk: records that are not packed, taken where they lie.
//!
//! The library is left out of it: it counts down what is left of a chunk without a look at whether a
//! record goes beyond its end.

use mcap::McapError;

use crate::bytes::{Bytes, Short};
use crate::error::chain;
use crate::mcap::chunk::{Take, Taken};
use crate::mcap::record::RawRecord;

/// Checksum and records of a whole chunk that is not packed; `None` of another.
pub(crate) fn plain(chunk: &RawRecord) -> Option<(u32, &[u8])> {
    let mut body = Bytes::new(chunk.body());
    body.take(24).ok()?; // times and size
    let crc = body.u32().ok()?;
    let is_packed = !body.block().ok()?.is_empty();
    let records = body.long_block().ok()?;
    (!is_packed && !chunk.is_cut).then_some((crc, records))
}

/// Takes the records of a plain chunk after its checksum was verified.
pub(crate) fn read_plain(crc: u32, records: &[u8], take: &mut Take) -> Taken {
    let (saved, calculated) = (crc, crc32fast::hash(records));
    if saved != 0 && saved != calculated {
        return Ok(Err(chain(&McapError::BadChunkCrc { saved, calculated })));
    }
    let mut left = Bytes::new(records);
    while left.left() > 0 {
        let taken = match next(&mut left) {
            Ok((opcode, body)) => take(opcode, body)?,
            Err(short) => Err(short.to_string()),
        };
        if let Err(reason) = taken {
            return Ok(Err(reason));
        }
    }
    Ok(Ok(()))
}

/// The next record: opcode and body.
fn next<'a>(left: &mut Bytes<'a>) -> Result<(u8, &'a [u8]), Short> {
    let [opcode] = left.array()?;
    Ok((opcode, left.long_block()?))
}
