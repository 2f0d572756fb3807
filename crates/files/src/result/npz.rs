//! NPZ of a result: arrays that `numpy.load` gives back, with the names that the Python package
//! uses.

use std::io;
use std::io::{Seek, Write};
use std::path::Path;

use npyz::npz::NpzWriter;
use npyz::zip::{CompressionMethod, DateTime, write::FileOptions};
use npyz::{DType, WriterBuilder};

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::result::arrays::{NamedArray, named_arrays};
use crate::result::result_file::ResultFile;

/// Writes `frequency_hz`, `response` (frequency, output, input; complex128), names and units, and
/// what else is known (docs/formats.md has the list).
///
/// # Errors
/// Those of writing (see [`Overwrite`]).
pub(crate) fn write_frf_npz(
    path: &Path,
    overwrite: Overwrite,
    result: &ResultFile,
) -> Result<(), FileError> {
    write_file(path, overwrite, |file| {
        let mut npz = NpzWriter::new(file);
        for (name, array) in named_arrays(result) {
            put(&mut npz, &name, &array)?;
        }
        npz.zip_writer().finish()?;
        Ok(())
    })
}

/// Adds an array, in the type that numpy has for it.
fn put<W: Write + Seek>(npz: &mut NpzWriter<W>, name: &str, array: &NamedArray) -> io::Result<()> {
    match array {
        NamedArray::Real(array) => put_numbers(npz, name, array.shape(), array.iter().copied()),
        NamedArray::Complex(array) => put_numbers(npz, name, array.shape(), array.iter().copied()),
        NamedArray::Number(number) => put_numbers(npz, name, &[], [*number]),
        NamedArray::Flags(flags) => put_numbers(npz, name, &[flags.len()], flags.iter().copied()),
        NamedArray::Texts(texts) => put_texts(npz, name, texts),
    }
}

fn put_numbers<W: Write + Seek, T: npyz::AutoSerialize>(
    npz: &mut NpzWriter<W>,
    name: &str,
    shape: &[usize],
    numbers: impl IntoIterator<Item = T>,
) -> io::Result<()> {
    let shape: Vec<u64> = shape.iter().map(|&length| length as u64).collect();
    let array = npz.array(name, options())?;
    let mut writer = array.default_dtype().shape(&shape).begin_nd()?;
    writer.extend(numbers)?;
    writer.finish()
}

/// Texts as numpy's `<U`, as wide as the longest.
fn put_texts<W: Write + Seek>(
    npz: &mut NpzWriter<W>,
    name: &str,
    texts: &[String],
) -> io::Result<()> {
    let lengths = texts.iter().map(|text| text.chars().count());
    let kind = format!("<U{}", lengths.max().unwrap_or(0).max(1));
    let kind = kind.parse().map_err(io::Error::other)?;
    let array = npz.array::<str>(name, options())?;
    let shape = [texts.len() as u64];
    let mut writer = array.dtype(DType::Plain(kind)).shape(&shape).begin_nd()?;
    for text in texts {
        writer.push(text)?;
    }
    writer.finish()
}

/// No time of writing: the same content gives the same bytes.
fn options() -> FileOptions {
    FileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .large_file(true)
}
