//! MAT file of a result, level 5, as MATLAB, Octave and scipy open it.
//!
//! After a header of 128 bytes comes an element for each array: a tag (type and number of bytes,
//! 32 bits each), then the data, padded to 8 bytes. An array is an element `miMATRIX` that holds
//! others: its class and flags, its lengths, its name, its values, column by column, and the
//! imaginary parts. Names and units are cell arrays of texts. Nothing is compressed.
//!
//! The MathWorks, MAT-File Format, R2024a, chapter 1 (level 5).

use std::io::{self, Write};
use std::path::Path;

use ndarray::ArrayViewD;

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::result::arrays::{NamedArray, named_arrays};
use crate::result::result_file::ResultFile;

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

/// Writes the arrays that an NPZ holds under the same names: `frequency_hz`, `response` (frequency,
/// output, input), names and units, and what else is known.
///
/// # Errors
/// Those of writing (see [`Overwrite`]); an array of 2 GiB or more, which the format cannot hold.
pub(crate) fn write_frf_mat(
    path: &Path,
    overwrite: Overwrite,
    result: &ResultFile,
) -> Result<(), FileError> {
    write_file(path, overwrite, |file| {
        file.write_all(&header())?;
        for (name, array) in named_arrays(result) {
            file.write_all(&matrix(&name, &array)?)?;
        }
        Ok(())
    })
}

/// 116 bytes of text, 8 that point to nothing, the version, and the order of bytes.
fn header() -> Vec<u8> {
    let text = "MATLAB 5.0 MAT-file, written by frfid";
    let mut header = format!("{text:<116}").into_bytes();
    header.extend([0; 8]);
    header.extend(0x0100_u16.to_le_bytes());
    header.extend(b"IM");
    header
}

/// The element of an array.
fn matrix(name: &str, array: &NamedArray) -> io::Result<Vec<u8>> {
    match array {
        NamedArray::Real(values) => {
            let parts = [doubles(values.view(), |value| *value)?];
            variable(MX_DOUBLE, name, values.shape(), &parts)
        }
        NamedArray::Complex(values) => {
            let parts = [
                doubles(values.view(), |value| value.re)?,
                doubles(values.view(), |value| value.im)?,
            ];
            variable(MX_DOUBLE | COMPLEX, name, values.shape(), &parts)
        }
        NamedArray::Number(number) => {
            let number = element(MI_DOUBLE, &number.to_le_bytes())?;
            variable(MX_DOUBLE, name, &[], &[number])
        }
        NamedArray::Flags(flags) => {
            let bytes: Vec<u8> = flags.iter().map(|&flag| flag.into()).collect();
            let values = element(MI_UINT8, &bytes)?;
            variable(MX_UINT8 | LOGICAL, name, &[flags.len()], &[values])
        }
        NamedArray::Texts(texts) => {
            let cells = texts.iter().map(|text| row_of(text));
            let cells = cells.collect::<io::Result<Vec<_>>>()?;
            variable(MX_CELL, name, &[texts.len()], &cells)
        }
    }
}

/// A text: a row of characters, without a name of its own. UTF-8, because Octave reads no UTF-16.
fn row_of(text: &str) -> io::Result<Vec<u8>> {
    let shape = [usize::from(!text.is_empty()), text.encode_utf16().count()];
    variable(MX_CHAR, "", &shape, &[element(MI_UTF8, text.as_bytes())?])
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
