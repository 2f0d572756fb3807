//! Common Data Representation (CDR), the wire format of ROS 2 messages: a four-byte header naming
//! the byte order, then every number aligned to its own size, counted from behind the header (OMG
//! DDS-RTPS 2.2 section 10, CORBA 3.0 section 15.3).

use thiserror::Error;

use crate::bytes::{Bytes, Short};
use crate::ros::field::Primitive;
use crate::ros::layout::Trace;

/// Why bytes are not the message they should be.
#[derive(Debug, Clone, PartialEq, Error)]
pub(crate) enum CdrError {
    /// The header names an encoding that is not plain CDR.
    #[error(
        "the payload's header is {found:02x?}, needed 00 00 (CDR big endian) or 00 01 (CDR little endian); \
         XCDR2 and parameter lists are not read"
    )]
    Encoding {
        /// The first two bytes.
        found: [u8; 2],
    },
    /// The message is compressed by itself.
    #[error(
        "the message is compressed by zstd, one by one; decompress the bag: ros2 bag convert, with compression_mode file or none"
    )]
    Compressed,
    /// The message ends early, or claims a length beyond its end.
    #[error("field {field}: {short}")]
    Short {
        /// The field being read.
        field: String,
        /// What was needed and what is left.
        short: Short,
    },
    /// The message goes on after its last field.
    #[error(
        "{left} bytes are left after the last field: the message is of another type than its schema says"
    )]
    Trailing {
        /// How many.
        left: usize,
    },
    /// A text is not UTF-8 or not closed by a NUL.
    #[error("field {field}: the text is not UTF-8 closed by a NUL")]
    Text {
        /// The field being read.
        field: String,
    },
    /// A type whose encoding differs between middlewares.
    #[error(
        "field {field}: wstring has no agreed encoding (it differs between middlewares) and is not read"
    )]
    WideText {
        /// The field being read.
        field: String,
    },
}

/// Reads one message of either byte order.
#[derive(Debug, Clone)]
pub(crate) struct CdrReader<'a> {
    body: Bytes<'a>,
    big_endian: bool,
    field: String,
    trace: Option<Trace>,
}

/// Makes the readers of the fixed-size numbers: aligned to their own size, in the message's byte
/// order.
macro_rules! number {
    ($($name:ident: $doc:literal),*) => {
        $(
            #[doc = $doc]
            ///
            /// # Errors
            /// [`CdrError::Short`].
            pub(crate) fn $name(&mut self) -> Result<$name, CdrError> {
                self.align(size_of::<$name>())?;
                let bytes = self.body.array().map_err(|short| self.short(short))?;
                Ok(if self.big_endian { $name::from_be_bytes(bytes) } else { $name::from_le_bytes(bytes) })
            }
        )*
    };
}

impl<'a> CdrReader<'a> {
    /// Opens a message and reads its header.
    ///
    /// # Errors
    /// [`CdrError::Encoding`] for anything but plain CDR, [`CdrError::Short`].
    pub(crate) fn new(message: &'a [u8]) -> Result<Self, CdrError> {
        let mut bytes = Bytes::new(message);
        let field = String::from("header");
        let header = match bytes.array() {
            Ok(header) => header,
            Err(short) => return Err(CdrError::Short { field, short }),
        };
        Ok(Self {
            field,
            ..Self::headless(bytes.rest(), is_big_endian(header)?)
        })
    }

    /// Reads what begins with these bytes, aligned, in the byte order that a header named before.
    pub(crate) fn headless(bytes: &'a [u8], big_endian: bool) -> Self {
        Self {
            body: Bytes::new(bytes),
            big_endian,
            field: String::new(),
            trace: None,
        }
    }

    /// The same as [`CdrReader::new`], noting what stands where.
    ///
    /// # Errors
    /// As [`CdrReader::new`].
    pub(crate) fn tracing(message: &'a [u8]) -> Result<Self, CdrError> {
        Ok(Self {
            trace: Some(Trace::default()),
            ..Self::new(message)?
        })
    }

    /// What stood where.
    pub(crate) fn into_trace(self) -> Trace {
        self.trace.unwrap_or_default()
    }

    /// Notes the number of `size` bytes that was just read; returns its place if that is what is asked for.
    pub(crate) fn note_number(&mut self, kind: Primitive, size: usize) -> Option<usize> {
        let place = self.body.at() - size;
        let trace = self.trace.as_mut()?;
        trace.numbers.push((place, kind));
        Some(place)
    }

    /// Notes the last `size` bytes as what a layout rests on.
    fn note_fixed(&mut self, size: usize) {
        let end = self.body.at();
        if let Some(trace) = &mut self.trace {
            trace.fixed.push((end - size, end));
        }
    }

    /// Names the field that is read next, for the errors.
    pub(crate) fn enter(&mut self, field: &str) {
        field.clone_into(&mut self.field);
    }

    fn short(&self, short: Short) -> CdrError {
        CdrError::Short {
            field: self.field.clone(),
            short,
        }
    }

    /// The next bytes, whatever they are.
    fn take(&mut self, count: usize) -> Result<&'a [u8], CdrError> {
        let taken = self.body.take(count as u64);
        taken.map_err(|short| self.short(short))
    }

    fn align(&mut self, size: usize) -> Result<(), CdrError> {
        let padding = self.body.at().wrapping_neg() & (size - 1);
        self.take(padding).map(drop)
    }

    number! {
        u8: "An octet, also `byte`, `char` and `bool`.", i8: "A signed octet.",
        u16: "An unsigned 16-bit integer.", i16: "A signed 16-bit integer.",
        u32: "An unsigned 32-bit integer.", i32: "A signed 32-bit integer.",
        u64: "An unsigned 64-bit integer.", i64: "A signed 64-bit integer.",
        f32: "A 32-bit number.", f64: "A 64-bit number."
    }

    /// A count of elements of at least `least_size` bytes each, checked against the bytes left, so
    /// that nothing larger than the message is ever allocated for it.
    ///
    /// # Errors
    /// [`CdrError::Short`].
    pub(crate) fn count(&mut self, least_size: usize) -> Result<usize, CdrError> {
        let count = self.u32()? as usize;
        self.note_fixed(size_of::<u32>());
        self.fits(count, least_size)
    }

    /// The same check for a count that the message's definition fixes.
    ///
    /// # Errors
    /// [`CdrError::Short`].
    pub(crate) fn fits(&self, count: usize, least_size: usize) -> Result<usize, CdrError> {
        let needed = (count as u64).saturating_mul(least_size as u64);
        if needed > self.body.left() as u64 {
            return Err(self.short(self.body.short_of(needed)));
        }
        Ok(count)
    }

    /// Why a text of wide characters is not read.
    #[must_use]
    pub(crate) fn wide_text(&self) -> CdrError {
        CdrError::WideText {
            field: self.field.clone(),
        }
    }

    /// A text, borrowed from the message.
    ///
    /// # Errors
    /// [`CdrError::Short`], [`CdrError::Text`].
    pub(crate) fn text(&mut self) -> Result<&'a str, CdrError> {
        let length = self.count(1)?;
        let text = closed_text(self.take(length)?);
        self.note_fixed(length);
        text.ok_or_else(|| CdrError::Text {
            field: self.field.clone(),
        })
    }

    /// A sequence of texts.
    ///
    /// # Errors
    /// As [`CdrReader::text`].
    pub(crate) fn texts(&mut self) -> Result<Vec<&'a str>, CdrError> {
        (0..self.count(4)?).map(|_| self.text()).collect()
    }

    /// A sequence of 64-bit numbers.
    ///
    /// # Errors
    /// [`CdrError::Short`].
    pub(crate) fn f64s(&mut self) -> Result<Vec<f64>, CdrError> {
        (0..self.count(8)?).map(|_| self.f64()).collect()
    }

    /// Ends the message. Some middlewares pad it to a multiple of four bytes; anything more means
    /// that it was read wrongly.
    ///
    /// # Errors
    /// [`CdrError::Trailing`].
    pub(crate) fn finish(&self) -> Result<(), CdrError> {
        let left = self.body.left();
        let padded = (self.body.at() + left).is_multiple_of(4) && left < 4;
        if left == 0 || padded {
            Ok(())
        } else {
            Err(CdrError::Trailing { left })
        }
    }
}

/// The byte order that a header names.
fn is_big_endian([first, second, ..]: [u8; 4]) -> Result<bool, CdrError> {
    match [first, second] {
        [0, 0] => Ok(true),
        [0, 1] => Ok(false),
        [0x28, 0xb5] => Err(CdrError::Compressed),
        found => Err(CdrError::Encoding { found }),
    }
}

/// The text before the closing NUL, which some writers leave out of an empty one.
fn closed_text(bytes: &[u8]) -> Option<&str> {
    match bytes.split_last() {
        None => Some(""),
        Some((0, text)) => std::str::from_utf8(text).ok(),
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::cdr_write::CdrWriter;
    use serde::{Deserialize, Serialize};

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Odd {
        number: i32,
        text: String,
        empty: Vec<f64>,
        texts: Vec<String>,
        values: Vec<f64>,
    }

    fn odd(k: usize) -> Odd {
        Odd {
            number: -(k as i32),
            text: "x".repeat(k % 7),
            empty: vec![],
            texts: (0..k % 4).map(|i| "joint".repeat(i)).collect(),
            values: (0..k % 5).map(|i| 0.1 * (i + k) as f64).collect(),
        }
    }

    fn read(message: &[u8]) -> Result<Odd, CdrError> {
        let mut cdr = CdrReader::new(message)?;
        let odd = Odd {
            number: cdr.i32()?,
            text: cdr.text()?.into(),
            empty: cdr.f64s()?,
            texts: cdr.texts()?.into_iter().map(String::from).collect(),
            values: cdr.f64s()?,
        };
        cdr.finish().map(|()| odd)
    }

    /// The crate `cdr` is somebody else's encoder: ours must agree byte for byte, in both byte
    /// orders when reading.
    #[test]
    fn agrees_with_the_cdr_crate() {
        for odd in (0..50).map(odd) {
            let mut ours = CdrWriter::default();
            ours.i32(odd.number);
            ours.text(&odd.text);
            ours.f64s(&odd.empty);
            ours.texts(&odd.texts);
            ours.f64s(&odd.values);
            let theirs = cdr::serialize::<_, _, cdr::CdrLe>(&odd, cdr::Infinite).expect("encodes");
            assert_eq!(ours.bytes(), theirs);
            assert_eq!(read(&theirs), Ok(odd.clone()));
            let big_endian =
                cdr::serialize::<_, _, cdr::CdrBe>(&odd, cdr::Infinite).expect("encodes");
            assert_eq!(read(&big_endian), Ok(odd));
        }
    }

    #[test]
    fn cut_and_hostile_messages_are_refused() {
        let whole = cdr::serialize::<_, _, cdr::CdrLe>(&odd(11), cdr::Infinite).expect("encodes");
        for length in 0..whole.len() {
            let cut = read(&whole[..length]);
            assert!(
                matches!(cut, Err(CdrError::Short { .. })),
                "cut at {length}: {cut:?}"
            );
        }
        let longer = [&whole[..], &[0; 8]].concat();
        assert_eq!(read(&longer), Err(CdrError::Trailing { left: 8 }));
        let hostile = [0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 1, 2, 3];
        assert!(matches!(
            CdrReader::new(&hostile).and_then(|mut cdr| cdr.f64s()),
            Err(CdrError::Short { .. })
        ));
        assert_eq!(
            CdrReader::new(&[0, 7, 0, 0]).err(),
            Some(CdrError::Encoding { found: [0, 7] })
        );
    }
}
