//! NPY arrays, as `numpy.save` writes them: any real type, either byte order, either axis order.

use ndarray::{ArrayD, IxDyn, ShapeBuilder};

use crate::bytes::{Bytes, Short};

/// An array as `f64`.
pub(crate) fn parse_npy(file: &[u8]) -> Option<ArrayD<f64>> {
    parse(file, number)
}

/// An array of integers, to the last digit; `None` if it is of floats.
pub(crate) fn parse_npy_integers(file: &[u8]) -> Option<ArrayD<i64>> {
    parse(file, integer)
}

/// A number of a class (`f`, `i`, `u`, `b`) and size in bytes from its bits.
type FromBits<T> = fn(u8, usize, u64) -> Option<T>;

/// The NPY format, versions 1 to 3: magic, version, length of the header, a Python dictionary, the
/// numbers.
fn parse<T: Clone>(file: &[u8], number: FromBits<T>) -> Option<ArrayD<T>> {
    let mut bytes = Bytes::new(file.strip_prefix(b"\x93NUMPY")?);
    let header = header_text(&mut bytes)?;
    let shape = shape_of(header)?;
    let count = checked_product(&shape)?;
    let numbers = numbers(kind_of(header)?, bytes.rest(), count, number)?;
    let shape = IxDyn(&shape).set_f(is_fortran(header)?);
    let array = ArrayD::from_shape_vec(shape, numbers).ok()?;
    Some(array.as_standard_layout().into_owned())
}

/// The dictionary that says what the bytes behind it are.
fn header_text<'f>(bytes: &mut Bytes<'f>) -> Option<&'f str> {
    let length = header_length(bytes).ok()?;
    std::str::from_utf8(bytes.take(length).ok()?).ok()
}

fn header_length(bytes: &mut Bytes) -> Result<u64, Short> {
    match bytes.array()? {
        [1, _] => bytes.u16().map(u64::from),
        [_, _] => bytes.u32().map(u64::from),
    }
}

/// The type of the numbers, as `<f8`.
fn kind_of(header: &str) -> Option<&str> {
    let quoted = value_of(header, "descr")?;
    quoted.strip_prefix(['\'', '"'])?.get(..3)
}

/// Whether the first axis runs fastest.
fn is_fortran(header: &str) -> Option<bool> {
    Some(value_of(header, "fortran_order")?.starts_with("True"))
}

/// The lengths of the axes.
fn shape_of(header: &str) -> Option<Vec<usize>> {
    let behind = value_of(header, "shape")?.strip_prefix('(')?;
    let (tuple, _) = behind.split_once(')')?;
    lengths_of(tuple)
}

/// The entries of a tuple; a single one has a comma behind it.
fn lengths_of(tuple: &str) -> Option<Vec<usize>> {
    let entries = tuple.split(',').map(str::trim);
    let given = entries.filter(|entry| !entry.is_empty());
    given.map(length_of).collect()
}

/// The length of an axis; Python 2 writes an L behind it.
fn length_of(axis: &str) -> Option<usize> {
    axis.trim_end_matches('L').parse().ok()
}

fn checked_product(lengths: &[usize]) -> Option<usize> {
    let mut lengths = lengths.iter();
    lengths.try_fold(1_usize, |product, &length| product.checked_mul(length))
}

/// What stands behind a key of the header's dictionary.
fn value_of<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let (_, behind) = header.split_once(&format!("'{key}'"))?;
    behind.trim_start().strip_prefix(':').map(str::trim_start)
}

/// Numbers of the kind `<f8`, `>i2`, `|u1`, ...
fn numbers<T>(kind: &str, bytes: &[u8], count: usize, number: FromBits<T>) -> Option<Vec<T>> {
    let size = size_of(kind)?;
    if count.checked_mul(size)? != bytes.len() {
        return None;
    }
    let is_big = kind.starts_with('>');
    let class = kind.as_bytes()[1];
    let number = |bytes: &[u8]| number(class, size, bits(bytes, is_big));
    bytes.chunks_exact(size).map(number).collect()
}

/// Bytes of a number.
fn size_of(kind: &str) -> Option<usize> {
    let size = kind.get(2..)?.parse().ok()?;
    matches!(size, 1 | 2 | 4 | 8).then_some(size)
}

/// The bits of a number, the lowest first.
fn bits(bytes: &[u8], is_big: bool) -> u64 {
    let mut wide = [0; 8];
    let used = &mut wide[..bytes.len()];
    used.copy_from_slice(bytes);
    if is_big {
        used.reverse();
    }
    u64::from_le_bytes(wide)
}

/// A signed integer of so many bytes.
fn signed(size: usize, bits: u64) -> i64 {
    let unused = 64 - 8 * size as u32;
    ((bits << unused) as i64) >> unused
}

fn integer(class: u8, size: usize, bits: u64) -> Option<i64> {
    match class {
        b'i' => Some(signed(size, bits)),
        b'u' => i64::try_from(bits).ok(),
        _ => None,
    }
}

fn number(class: u8, size: usize, bits: u64) -> Option<f64> {
    match (class, size) {
        (b'f', 8) => Some(f64::from_bits(bits)),
        (b'f', 4) => Some(f64::from(f32::from_bits(bits as u32))),
        (b'i', _) => Some(signed(size, bits) as f64),
        (b'u', _) | (b'b', 1) => Some(bits as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(kind: &str, is_fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': '{kind}', 'fortran_order': {is_fortran}, 'shape': {shape}, }}\n");
        [
            b"\x93NUMPY\x01\x00",
            &(header.len() as u16).to_le_bytes()[..],
            header.as_bytes(),
            data,
        ]
        .concat()
    }

    #[test]
    fn every_real_type_and_order() {
        let values = |kind: &str, data: &[u8]| {
            parse_npy(&npy(kind, "False", "(2,)", data))
                .map(|array| array.into_raw_vec_and_offset().0)
        };
        assert_eq!(values("<i2", &[0xfe, 0xff, 3, 0]), Some(vec![-2.0, 3.0]));
        assert_eq!(values(">i2", &[0xff, 0xfe, 0, 3]), Some(vec![-2.0, 3.0]));
        assert_eq!(values("|b1", &[1, 0]), Some(vec![1.0, 0.0]));
        assert_eq!(
            values("<f4", &[0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0]),
            Some(vec![1.0, -2.0])
        );
        assert_eq!(
            values(">u4", &[0xff, 0xff, 0xff, 0xff, 0, 0, 0, 1]),
            Some(vec![4_294_967_295.0, 1.0])
        );
        assert_eq!(values("<c8", &[0; 16]), None);
        assert_eq!(values("<i2", &[0; 3]), None);
        let fortran = parse_npy(&npy("|u1", "True", "(2, 2)", &[1, 2, 3, 4])).expect("sound");
        assert_eq!(
            fortran.iter().copied().collect::<Vec<_>>(),
            [1.0, 3.0, 2.0, 4.0]
        );
        assert_eq!(
            parse_npy(&npy("|u1", "False", "(18446744073709551615, 3)", &[1])),
            None
        );
        assert_eq!(
            parse_npy(&npy("|u1", "False", "()", &[7])).map(|array| array.sum()),
            Some(7.0)
        );
    }
}
