//! MAT files, level 5, as MATLAB, Octave and scipy open them.
//!
//! After a header of 128 bytes comes an element for each array: a tag (type and number of bytes,
//! 32 bits each), then the data, padded to 8 bytes. An array is an element `miMATRIX` that holds
//! others: its class and flags, its lengths, its name, its values, column by column, and the
//! imaginary parts. Names and units are cell arrays of texts. Nothing is compressed.
//!
//! The MathWorks, MAT-File Format, R2024a, chapter 1 (level 5).

use std::io;

use ndarray::ArrayViewD;
use num_complex::Complex64;

/// Types of data elements.
const MI_INT8: u32 = 1;
const MI_UINT8: u32 = 2;
const MI_INT32: u32 = 5;
const MI_UINT32: u32 = 6;
const MI_DOUBLE: u32 = 9;
const MI_MATRIX: u32 = 14;
const MI_UTF8: u32 = 16;

/// Classes of arrays.
const MX_CELL: u32 = 1;
const MX_CHAR: u32 = 4;
const MX_DOUBLE: u32 = 6;
const MX_UINT8: u32 = 9;

/// Flags of arrays, in the byte above the class.
const COMPLEX: u32 = 0x0800;
const LOGICAL: u32 = 0x0200;

/// 116 bytes of text, 8 that point to nothing, the version, and the order of bytes.
pub(crate) fn header() -> Vec<u8> {
    let text = "MATLAB 5.0 MAT-file, written by frfid";
    let mut header = format!("{text:<116}").into_bytes();
    header.extend([0; 8]);
    header.extend(0x0100_u16.to_le_bytes());
    header.extend(b"IM");
    header
}

/// The element of real numbers.
pub(crate) fn reals(name: &str, values: ArrayViewD<f64>) -> io::Result<Vec<u8>> {
    let shape = values.shape().to_vec();
    variable(MX_DOUBLE, name, &shape, &[doubles(values, |value| *value)?])
}

/// The element of complex numbers.
pub(crate) fn complexes(name: &str, values: ArrayViewD<Complex64>) -> io::Result<Vec<u8>> {
    let shape = values.shape().to_vec();
    let parts = [
        doubles(values.view(), |value| value.re)?,
        doubles(values, |value| value.im)?,
    ];
    variable(MX_DOUBLE | COMPLEX, name, &shape, &parts)
}

/// The element of a number.
pub(crate) fn number(name: &str, number: f64) -> io::Result<Vec<u8>> {
    let number = element(MI_DOUBLE, &number.to_le_bytes())?;
    variable(MX_DOUBLE, name, &[], &[number])
}

/// The element of flags, true or false.
pub(crate) fn flags(name: &str, flags: &[bool]) -> io::Result<Vec<u8>> {
    let bytes: Vec<u8> = flags.iter().map(|&flag| flag.into()).collect();
    let values = element(MI_UINT8, &bytes)?;
    variable(MX_UINT8 | LOGICAL, name, &[flags.len()], &[values])
}

/// The element of a list of texts.
pub(crate) fn texts(name: &str, texts: &[String]) -> io::Result<Vec<u8>> {
    let cells = texts.iter().map(|text| row_of("", text));
    let cells = cells.collect::<io::Result<Vec<_>>>()?;
    variable(MX_CELL, name, &[texts.len()], &cells)
}

/// The element of a text: a row of characters. UTF-8, because Octave reads no UTF-16.
pub(crate) fn row_of(name: &str, text: &str) -> io::Result<Vec<u8>> {
    let shape = [usize::from(!text.is_empty()), text.encode_utf16().count()];
    variable(MX_CHAR, name, &shape, &[element(MI_UTF8, text.as_bytes())?])
}

/// `miMATRIX`: class and flags, lengths, name, values. A list is a column, a number 1 x 1.
fn variable(class: u32, name: &str, shape: &[usize], values: &[Vec<u8>]) -> io::Result<Vec<u8>> {
    let shape = match *shape {
        [] => vec![1, 1],
        [length] => vec![length, 1],
        _ => shape.to_vec(),
    };
    let lengths: io::Result<Vec<[u8; 4]>> = shape.iter().copied().map(int32).collect();
    let mut parts = element(MI_UINT32, &[class.to_le_bytes(), [0; 4]].concat())?;
    parts.extend(element(MI_INT32, &lengths?.concat())?);
    parts.extend(element(MI_INT8, name.as_bytes())?);
    parts.extend(values.concat());
    element(MI_MATRIX, &parts)
}

/// Values column by column: the first axis is the first to change.
fn doubles<T>(array: ArrayViewD<T>, part: impl Fn(&T) -> f64) -> io::Result<Vec<u8>> {
    let columns = array.reversed_axes();
    let bytes = columns.iter().flat_map(|value| part(value).to_le_bytes());
    element(MI_DOUBLE, &bytes.collect::<Vec<_>>())
}

/// A data element: its tag, its data, zeros up to 8 bytes.
fn element(kind: u32, data: &[u8]) -> io::Result<Vec<u8>> {
    let mut element = [kind.to_le_bytes(), int32(data.len())?].concat();
    element.extend(data);
    element.resize(element.len().next_multiple_of(8), 0);
    Ok(element)
}

/// A length as the format has it.
fn int32(length: usize) -> io::Result<[u8; 4]> {
    i32::try_from(length).map(i32::to_le_bytes).map_err(|_| {
        let too_long = format!("an array of {length}: MAT files hold less than 2 GiB of each");
        io::Error::new(io::ErrorKind::InvalidInput, too_long)
    })
}
