//! Packed numbers in JSON: base64 of zlib of little-endian complex128, every bit of them. In Python
//! `numpy.frombuffer(zlib.decompress(base64.b64decode(text)), complex)` reads them.

use std::io::{Read, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use num_complex::Complex64;

use crate::budget::most_of;

/// Arrays of more numbers are packed: digits of as many nobody reads.
const MOST_PLAIN: usize = 20_000;
/// Bytes of a number.
const WIDTH: usize = size_of::<f64>();

/// Whether an array of so many numbers is packed.
pub(crate) fn is_packed(count: usize) -> bool {
    count > MOST_PLAIN
}

pub(crate) fn packed(values: impl Iterator<Item = Complex64>) -> String {
    let mut packing = ZlibEncoder::new(Vec::new(), Compression::default());
    for value in values {
        for part in [value.re, value.im] {
            packing
                .write_all(&part.to_le_bytes())
                .expect("memory takes all");
        }
    }
    STANDARD.encode(packing.finish().expect("memory takes all"))
}

/// The numbers of a text; `None` of a damaged one, and of one that unpacks beyond reason.
pub(crate) fn unpacked(text: &str) -> Option<Vec<Complex64>> {
    let packed = STANDARD.decode(text).ok()?;
    let most = most_of(packed.len() as u64);
    let mut bytes = Vec::new();
    let unpacking = ZlibDecoder::new(&packed[..]);
    unpacking
        .take(most.saturating_add(1))
        .read_to_end(&mut bytes)
        .ok()?;
    if bytes.len() as u64 > most {
        return None;
    }
    let (numbers, rest) = bytes.as_chunks::<{ 2 * WIDTH }>();
    rest.is_empty()
        .then(|| numbers.iter().map(number).collect())
}

fn number(bytes: &[u8; 2 * WIDTH]) -> Complex64 {
    let part = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| bytes[at + k]));
    Complex64::new(part(0), part(WIDTH))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_back_and_a_bomb_does_not() {
        let values = [0.1, -0.0, f64::NAN, f64::INFINITY, 5e-324];
        let values = values.map(|value| Complex64::new(value, -value));
        let text = packed(values.into_iter());
        let back = unpacked(&text).expect("sound");
        let bits = |value: &Complex64| [value.re.to_bits(), value.im.to_bits()];
        assert!(back.iter().map(bits).eq(values.iter().map(bits)));
        for damaged in ["", "x", "AAAA", &text[4..]] {
            assert!(unpacked(damaged).is_none(), "{damaged}");
        }
        let zeros = std::iter::repeat_n(Complex64::ZERO, 5 << 20);
        assert!(unpacked(&packed(zeros)).is_none());
    }
}
