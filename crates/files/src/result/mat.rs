//! MAT file of a result, level 5.

use std::io::{self, Write};
use std::path::Path;

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::mat_write::{complexes, flags, header, number, reals, texts};
use crate::result::arrays::{NamedArray, named_arrays};
use crate::result::result_file::ResultFile;

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

/// The element of an array.
fn matrix(name: &str, array: &NamedArray) -> io::Result<Vec<u8>> {
    match array {
        NamedArray::Real(values) => reals(name, values.view()),
        NamedArray::Complex(values) => complexes(name, values.view()),
        NamedArray::Number(value) => number(name, *value),
        NamedArray::Flags(values) => flags(name, values),
        NamedArray::Texts(values) => texts(name, values),
    }
}
