//! NPZ recordings: arrays of numbers as `numpy.savez` writes them.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use ndarray::ArrayD;
use npyz::npz::NpzArchive;

use crate::error::FileError;
use crate::log::map::{LogMap, Signal, Signals};
use crate::log::npy::{parse_npy, parse_npy_integers};
use crate::log::recording::{Recording, Series};
use crate::log::sample_times::{SampleTimes, TimeColumn, nth_stamp_ns};
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

fn bad_array(path: &Path, name: &str, found: String, needed: impl Into<String>) -> FileError {
    FileError::content(path, format!("array {name}"), found, needed)
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
    all_bytes(entry.map_err(no_such)?).map_err(damaged)
}

fn array_names(archive: &NpzArchive<BufReader<File>>) -> String {
    let mut names: Vec<_> = archive.array_names().collect();
    names.sort();
    names.join(", ")
}

fn all_bytes(entry: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    entry.take(LARGEST_ARRAY_BYTES).read_to_end(&mut bytes)?;
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
    let columns = columns(path, signals)?;
    let stamps_ns = stamps(path, map, &Length::of(&signals[0].source, &columns[0]))?;
    Ok(Recording {
        series: vec![Series {
            topic: "samples".into(),
            is_recorders: false,
            stamps_ns,
            signals: (0..signals.len()).collect(),
            columns,
        }],
        ..Default::default()
    })
}

/// The samples of every signal, of one length.
fn columns(path: &Path, signals: &Signals) -> Result<Vec<Vec<f64>>, FileError> {
    let column = |signal: &&Signal| row(path, &signal.source, parse_npy);
    let columns = signals.iter().map(column).collect::<Result<Vec<_>, _>>()?;
    check_lengths(path, signals, &columns)?;
    Ok(columns)
}

/// Refuses signals that are not as long as the first one.
fn check_lengths(path: &Path, signals: &Signals, columns: &[Vec<f64>]) -> Result<(), FileError> {
    let first = Length::of(&signals[0].source, &columns[0]);
    for (signal, column) in signals.iter().zip(columns) {
        Length::of(&signal.source, column).check(path, &first)?;
    }
    Ok(())
}

/// The sample times, as many as the first signal has samples.
fn stamps(path: &Path, map: &LogMap, first: &Length) -> Result<Vec<i64>, FileError> {
    match SampleTimes::of(path, map, |_| Ok(0))? {
        SampleTimes::Counted(step_ns) => Ok(counted(first.n_samples, step_ns)),
        SampleTimes::Column(column) => {
            let source = map.time.as_ref().map_or("", |time| &time.source);
            let stamps = stamps_of(path, source, column)?;
            Length::of(source, &stamps).check(path, first)?;
            Ok(stamps)
        }
    }
}

fn counted(n_samples: usize, step_ns: f64) -> Vec<i64> {
    let stamp = |number| nth_stamp_ns(number, step_ns);
    (0..n_samples).map(stamp).collect()
}

/// The sample times of an array; integers keep their last digit.
fn stamps_of(path: &Path, source: &str, column: TimeColumn) -> Result<Vec<i64>, FileError> {
    let numbers = row(path, source, parse_npy)?.into_iter();
    let stamps: Option<Vec<i64>> = match row(path, source, parse_npy_integers) {
        Ok(integers) => {
            let integers = integers.into_iter();
            integers.map(|time| column.stamp_of_integer(time)).collect()
        }
        Err(_) => numbers.map(|time| column.stamp_of_number(time)).collect(),
    };
    stamps.ok_or_else(|| no_time(path, source))
}

fn no_time(path: &Path, source: &str) -> FileError {
    let found = "a time that is no number".to_owned();
    bad_array(path, source, found, "a time for every sample")
}

/// A signal and how many samples it has.
struct Length<'s> {
    source: &'s str,
    n_samples: usize,
}

impl<'s> Length<'s> {
    fn of<T>(source: &'s str, samples: &[T]) -> Self {
        Self {
            source,
            n_samples: samples.len(),
        }
    }

    /// Refuses a signal that is not as long as the first one.
    fn check(&self, path: &Path, first: &Length) -> Result<(), FileError> {
        if self.n_samples == first.n_samples {
            return Ok(());
        }
        Err(self.other_than(path, first))
    }

    fn other_than(&self, path: &Path, first: &Length) -> FileError {
        let found = format!("{} samples", self.n_samples);
        let needed = format!("{}, as in {}", first.n_samples, first.source);
        bad_array(path, self.source, found, needed)
    }
}

/// The samples of a source in the log map, as `parse` reads their array.
fn row<T: Copy>(path: &Path, source: &str, parse: Parse<T>) -> Result<Vec<T>, FileError> {
    let (name, place) = name_and_place(source);
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

/// `name` and `row` of `name[row]`; the whole source is a name where the row is no number.
fn name_and_place(source: &str) -> (&str, Option<usize>) {
    let parts = source
        .strip_suffix(']')
        .and_then(|inside| inside.split_once('['));
    let row = parts.and_then(|(_, row)| row.parse().ok());
    match parts {
        Some((name, _)) if row.is_some() => (name, row),
        _ => (source, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic_write::Overwrite;
    use crate::result::npz::write_frf_npz;
    use crate::result::testing::result;

    #[test]
    fn a_row_is_a_number_and_nothing_else() {
        assert_eq!(name_and_place("u[2]"), ("u", Some(2)));
        for whole in ["u", "u[", "u[x]", "u[-1]"] {
            assert_eq!(name_and_place(whole), (whole, None));
        }
    }

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
