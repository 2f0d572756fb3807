//! An FRF as an NPZ: arrays that `numpy.load` gives back, with the names that the Python package
//! uses.

use std::io;
use std::io::{Seek, Write};
use std::path::Path;

use frfid_signals::Frf;
use ndarray::{Array, Dimension};
use npyz::WriterBuilder;
use npyz::npz::NpzWriter;
use npyz::zip::{CompressionMethod, DateTime, write::FileOptions};

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;

/// Writes `frequency_hz`, `response` (frequency, output, input; complex128) and, where known,
/// `noise_variance`, `noise_covariance`, `noise_degrees_of_freedom`, the same for `total`, and
/// `condition`.
///
/// # Errors
/// Those of writing (see [`Overwrite`]).
pub fn write_frf_npz(path: &Path, overwrite: Overwrite, frf: &Frf) -> Result<(), FileError> {
    write_file(path, overwrite, |file| {
        let mut npz = NpzWriter::new(file);
        put(
            &mut npz,
            "frequency_hz",
            &ndarray::aview1(&frf.frequency_hz).to_owned(),
        )?;
        put(&mut npz, "response", &frf.response)?;
        let known = [
            ("noise", &frf.noise, frf.noise_variance()),
            ("total", &frf.total, frf.total_variance()),
        ];
        for (name, uncertainty, variance) in known {
            let (Some(uncertainty), Some(variance)) = (uncertainty, variance) else {
                continue;
            };
            put(&mut npz, &format!("{name}_variance"), &variance)?;
            put(
                &mut npz,
                &format!("{name}_covariance"),
                &uncertainty.covariance,
            )?;
            let degrees = ndarray::arr0(uncertainty.degrees_of_freedom as i64);
            put(&mut npz, &format!("{name}_degrees_of_freedom"), &degrees)?;
        }
        if let Some(condition) = &frf.condition {
            put(
                &mut npz,
                "condition",
                &ndarray::aview1(condition).to_owned(),
            )?;
        }
        npz.zip_writer().finish()?;
        Ok(())
    })
}

/// No time of writing: the same content gives the same bytes.
fn put<W, T, D>(npz: &mut NpzWriter<W>, name: &str, array: &Array<T, D>) -> io::Result<()>
where
    W: Write + Seek,
    T: npyz::AutoSerialize + Clone,
    D: Dimension,
{
    let options = FileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .large_file(true);
    let shape: Vec<u64> = array.shape().iter().map(|&length| length as u64).collect();
    let mut writer = npz
        .array(name, options)?
        .default_dtype()
        .shape(&shape)
        .begin_nd()?;
    writer.extend(array.iter().cloned())?;
    writer.finish()
}
