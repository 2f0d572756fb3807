//! NPZ recordings: arrays of numbers as `numpy.savez` writes them.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use ndarray::{ArrayD, Axis};
use npyz::npz::NpzArchive;

use crate::budget::Budget;
use crate::error::FileError;
use crate::log::arrays::npy::{parse_npy, parse_npy_integers};
use crate::log::arrays::{self, Arrays, bad_array, name_and_channel};
use crate::log::listing::Listing;
use crate::log::map::{LogMap, Signals};
use crate::log::recording::Recording;
use crate::run::header;

/// Reads one array as `f64`, C-ordered; 64-bit integers beyond 2^53 are rounded.
///
/// # Errors
/// [`FileError::Io`], [`FileError::Format`] if the file is no NPZ, [`FileError::Content`] if the
/// array is not there (the error lists those that are), is not of real numbers, or is damaged.
pub fn read_npz_array(path: &Path, name: &str) -> Result<ArrayD<f64>, FileError> {
    read_array(path, name, parse_npy)
}

/// Reads the file of an array, if it is of numbers of a type.
type Parse<T> = fn(&[u8]) -> Option<ArrayD<T>>;

fn read_array<T>(path: &Path, name: &str, parse: Parse<T>) -> Result<ArrayD<T>, FileError> {
    let bytes = entry_bytes(path, name)?;
    parse(&bytes).ok_or_else(|| bad_numbers(path, name, &bytes))
}

fn bad_numbers(path: &Path, name: &str, bytes: &[u8]) -> FileError {
    let needed = "an array of real numbers, as long as its shape says";
    bad_array(path, name, start_of(bytes), needed)
}

/// The beginning of an array's file, where its header is.
fn start_of(bytes: &[u8]) -> String {
    let header = String::from_utf8_lossy(bytes.get(..128).unwrap_or(bytes));
    format!("{:?}", header.trim_end())
}

/// The NPY file of an array.
fn entry_bytes(path: &Path, name: &str) -> Result<Vec<u8>, FileError> {
    let mut archive = open(path)?;
    let known = array_names(&archive);
    let file_name = npyz::npz::file_name_from_array_name(name);
    // the entry is read here rather than by npyz, whose reader multiplies a hostile shape beyond
    // its integers
    let entry = archive.zip_archive().by_name(&file_name);
    let no_such = |_| {
        bad_array(
            path,
            name,
            "no such array".into(),
            format!("one of {known}"),
        )
    };
    let damaged = |error: io::Error| bad_array(path, name, error.to_string(), "an undamaged array");
    let entry = entry.map_err(no_such)?;
    let (budget, what) = (Budget::of_file(path)?, format!("array {name}"));
    budget.check(&what, entry.size())?;
    // packed numbers, numbers, and a copy of them in order
    Budget::allowed(path).check(&what, entry.size().saturating_mul(3))?;
    let bytes = all_bytes(entry, budget.most()).map_err(damaged)?;
    budget.check(&what, bytes.len() as u64)?;
    Ok(bytes)
}

fn array_names(archive: &NpzArchive<BufReader<File>>) -> String {
    let mut names: Vec<_> = archive.array_names().collect();
    names.sort();
    names.join(", ")
}

/// The bytes of an entry, up to one more than `most`: its size may be none of its own.
fn all_bytes(entry: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let most = most.min(LARGEST_ARRAY_BYTES);
    entry.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// No array needs more bytes than this.
const LARGEST_ARRAY_BYTES: u64 = 8 * header::MOST_VALUES as u64;

fn open(path: &Path) -> Result<NpzArchive<BufReader<File>>, FileError> {
    let file = File::open(path).map_err(FileError::cannot("open", path))?;
    NpzArchive::new(BufReader::new(file)).map_err(|error| no_npz(path, error))
}

fn no_npz(path: &Path, error: io::Error) -> FileError {
    let found = error.to_string();
    FileError::format(path, found, "an NPZ archive", "write it by numpy.savez")
}

/// The mapped arrays of a recording: `name` for one channel, `name[row]` for a row of (channel,
/// sample).
pub(crate) fn read(path: &Path, map: &LogMap, signals: &Signals) -> Result<Recording, FileError> {
    arrays::read(path, map, signals, &Npz { path })
}

/// Lists its arrays: those of one length are sampled together.
pub(crate) fn list(path: &Path) -> Result<Listing, FileError> {
    let archive = open(path)?;
    let mut names: Vec<String> = archive.array_names().map(str::to_owned).collect();
    names.sort();
    let arrays = names.into_iter().filter_map(|name| {
        let array = read_array(path, &name, parse_npy).ok()?;
        Some((name, array))
    });
    let channels = arrays.flat_map(|(name, array)| channels(&name, &array));
    Ok(arrays::listing("NPZ", channels))
}

/// The channels of an array, each with its source.
fn channels(name: &str, array: &ArrayD<f64>) -> Vec<(String, Vec<f64>)> {
    let rows = match array.ndim() {
        2 => array.len_of(Axis(0)).min(arrays::MOST_CHANNELS),
        _ => 0,
    };
    let sources = (0..rows).map(|row| (format!("{name}[{row}]"), Some(row)));
    let whole = (rows == 0).then(|| (name.to_owned(), None));
    let all = sources.chain(whole);
    all.filter_map(|(source, row)| Some((source, samples(array, row)?)))
        .collect()
}

struct Npz<'p> {
    path: &'p Path,
}

impl Arrays for Npz<'_> {
    fn numbers(&self, source: &str) -> Result<Vec<f64>, FileError> {
        row(self.path, source, parse_npy)
    }

    fn integers(&self, source: &str) -> Option<Vec<i64>> {
        row(self.path, source, parse_npy_integers).ok()
    }
}

/// The samples of a source in the log map, as `parse` reads their array.
fn row<T: Copy>(path: &Path, source: &str, parse: Parse<T>) -> Result<Vec<T>, FileError> {
    let (name, place) = name_and_channel(source);
    let array = read_array(path, name, parse)?;
    samples(&array, place).ok_or_else(|| other_shape(path, source, array.shape()))
}

fn other_shape(path: &Path, source: &str, shape: &[usize]) -> FileError {
    let what = format!("source {source} in the log map");
    let found = format!("an array of shape {shape:?}");
    let needed = "name for an array (sample), name[row] for one (channel, sample)";
    FileError::content(path, what, found, needed)
}

/// The samples of an array (sample), or of a row of one (channel, sample).
fn samples<T: Copy>(array: &ArrayD<T>, row: Option<usize>) -> Option<Vec<T>> {
    match (array.ndim(), row) {
        (1, None) => Some(array.iter().copied().collect()),
        (2, Some(row)) => Some(array.outer_iter().nth(row)?.iter().copied().collect()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic_write::Overwrite;
    use crate::result::npz::write_frf_npz;
    use crate::result::testing::result;

    #[test]
    fn what_we_write_comes_back_and_nothing_that_was_not_measured() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("frf.npz");
        write_frf_npz(&path, Overwrite::Refuse, &result()).expect("sound");
        let read =
            |name| read_npz_array(&path, name).map(|array| array.into_raw_vec_and_offset().0);
        let frf = result().frf;
        assert_eq!(read("frequency_hz").expect("there"), frf.frequency_hz);
        let variance = frf.noise_variance().expect("measured");
        assert_eq!(
            read("noise_variance").expect("there"),
            variance.into_raw_vec_and_offset().0
        );
        assert_eq!(read("noise_degrees_of_freedom").expect("there"), [40.0]);
        assert_eq!(read("relative_resolution").expect("there"), [0.125]);
        assert_eq!(read("torque_rms_nm").expect("there"), [1.0 / 3.0]);
        assert_eq!(read("flagged").expect("there"), [0.0, 1.0, 0.0, 0.0]);
        let names = read("total_variance")
            .expect_err("was not measured")
            .to_string();
        assert!(
            names.contains("one of condition, flagged, frequency_hz, input_names, input_units, noise_covariance, noise_degrees_of_freedom, noise_variance, output_names"),
            "{names}"
        );
        assert!(
            read("response")
                .expect_err("complex")
                .to_string()
                .contains("<c16")
        );
        let first = std::fs::read(&path).expect("written");
        write_frf_npz(&path, Overwrite::Replace, &result()).expect("sound");
        assert_eq!(std::fs::read(&path).expect("written"), first);
    }
}
