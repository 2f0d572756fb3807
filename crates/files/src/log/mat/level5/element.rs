//! Data elements of a MAT file: a type, and bytes, in either order of bytes, packed by zlib or not.

use std::io::Read;

use flate2::read::{DeflateDecoder, ZlibDecoder};

use crate::budget::most_of;
use crate::bytes::{Bytes, Short};
use crate::run::header::MOST_VALUES;

pub(super) const MATRIX: u32 = 14;
pub(super) const COMPRESSED: u32 = 15;
/// No array needs more bytes than this.
const LARGEST_BYTES: u64 = 8 * MOST_VALUES as u64 + 4096;
/// Enough of a packed array to tell its name.
const BEGINNING: u64 = 4096;
/// Length of what comes before the packed bytes.
const ZLIB_HEADER: usize = 2;

/// An element and its bytes.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    pub(super) kind: u32,
    pub(super) data: &'a [u8],
    pub(super) is_big: bool,
}

/// The elements of some bytes, one after the other.
pub(super) struct Elements<'a> {
    bytes: Bytes<'a>,
    is_big: bool,
}

impl<'a> Elements<'a> {
    pub(super) fn of(bytes: &'a [u8], is_big: bool) -> Self {
        Self {
            bytes: Bytes::new(bytes),
            is_big,
        }
    }

    /// The next element; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Element<'a>>, Short> {
        if self.bytes.left() == 0 {
            return Ok(None);
        }
        let first = self.number()?;
        // a small element has its length above its type and its data in the tag
        let (kind, length, is_small) = match first >> 16 {
            0 => (first, self.number()?, false),
            length => (first & 0xffff, length, true),
        };
        let data = self.bytes.take(u64::from(length))?;
        let boundary = if is_small { 4 } else { 8 };
        if kind != COMPRESSED {
            let padding = (boundary - length as usize % boundary) % boundary;
            self.bytes.take(padding.min(self.bytes.left()) as u64)?;
        }
        Ok(Some(Element {
            kind,
            data,
            is_big: self.is_big,
        }))
    }

    fn number(&mut self) -> Result<u32, Short> {
        let bytes = self.bytes.array()?;
        Ok(if self.is_big {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        })
    }
}

impl Element<'_> {
    /// The beginning of what a packed element holds, as far as it can be unpacked: without a look at the
    /// checksum, so that an array has its name even where its numbers are damaged.
    pub(super) fn beginning(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let deflated = self.data.get(ZLIB_HEADER..).unwrap_or_default();
        let _ = DeflateDecoder::new(deflated)
            .take(BEGINNING)
            .read_to_end(&mut bytes);
        bytes
    }

    /// What a packed element holds; `None` where its checksum says that it is not what was packed.
    pub(super) fn unpacked(&self) -> Option<Vec<u8>> {
        let most = most_of(self.data.len() as u64).min(LARGEST_BYTES);
        let (mut bytes, unpacking) = (Vec::new(), ZlibDecoder::new(self.data));
        unpacking.take(most).read_to_end(&mut bytes).ok()?;
        Some(bytes)
    }

    /// The text of names.
    pub(super) fn text(&self) -> String {
        let text = String::from_utf8_lossy(self.data);
        text.trim_end_matches('\0').to_owned()
    }

    /// The numbers; `None` of a type that holds none.
    pub(super) fn numbers(&self) -> Option<Vec<f64>> {
        match self.kind {
            7 => Some(self.each(|bytes: [u8; 4]| f64::from(f32::from_le_bytes(bytes)))),
            9 => Some(self.each(f64::from_le_bytes)),
            _ => {
                let integers = self.integers()?;
                Some(integers.into_iter().map(|value| value as f64).collect())
            }
        }
    }

    /// The integers; `None` of another type.
    pub(super) fn integers(&self) -> Option<Vec<i64>> {
        Some(match self.kind {
            1 => self.each(|bytes| i64::from(i8::from_le_bytes(bytes))),
            2 | 16 => self.each(|bytes| i64::from(u8::from_le_bytes(bytes))),
            3 => self.each(|bytes| i64::from(i16::from_le_bytes(bytes))),
            4 => self.each(|bytes| i64::from(u16::from_le_bytes(bytes))),
            5 => self.each(|bytes| i64::from(i32::from_le_bytes(bytes))),
            6 => self.each(|bytes| i64::from(u32::from_le_bytes(bytes))),
            12 => self.each(i64::from_le_bytes),
            13 => self.each(|bytes| i64::try_from(u64::from_le_bytes(bytes)).unwrap_or(i64::MAX)),
            _ => return None,
        })
    }

    /// Every number of so many bytes, in their little-endian order.
    fn each<const N: usize, T>(&self, number: impl Fn([u8; N]) -> T) -> Vec<T> {
        let chunks = self.data.as_chunks::<N>().0.iter();
        let ordered = |mut bytes: [u8; N]| {
            if self.is_big {
                bytes.reverse();
            }
            bytes
        };
        chunks.map(|bytes| number(ordered(*bytes))).collect()
    }
}
