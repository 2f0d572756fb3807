//! Arrays of numbers out of an NPZ, as `numpy.savez` writes it: any real type, either byte order,
//! either axis order.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use ndarray::{ArrayD, IxDyn, ShapeBuilder};
use npyz::npz::NpzArchive;

use crate::bytes::Bytes;
use crate::error::FileError;
use crate::log::csv::Times;
use crate::log::map::{LogMap, Signal};
use crate::log::{Recording, Series};
use crate::run::header;

/// Reads one array as `f64`, C-ordered; 64-bit integers beyond 2^53 are rounded.
///
/// # Errors
/// [`FileError::Io`], [`FileError::Format`] if the file is no NPZ, [`FileError::Content`] if the
/// array is not there (the error lists those that are), is not of real numbers, or is damaged.
pub fn read_npz_array(path: &Path, name: &str) -> Result<ArrayD<f64>, FileError> {
    let file = File::open(path).map_err(|error| FileError::Io {
        path: path.into(),
        action: "open",
        reason: error.to_string(),
    })?;
    let mut archive = NpzArchive::new(BufReader::new(file)).map_err(|error| FileError::Format {
        path: path.into(),
        found: error.to_string(),
        needed: "an NPZ archive",
        advice: "write it by numpy.savez".into(),
    })?;
    let mut known: Vec<_> = archive.array_names().map(String::from).collect();
    known.sort();
    let content = |found: String, needed: &str| FileError::Content {
        path: path.into(),
        what: format!("array {name}"),
        found,
        needed: needed.into(),
    };
    let limit = 8 * header::MOST_VALUES as u64;
    let mut bytes = Vec::new();
    // the entry is read here rather than by npyz, whose reader multiplies a hostile shape beyond
    // its integers
    let entry = archive
        .zip_archive()
        .by_name(&npyz::npz::file_name_from_array_name(name));
    let entry = entry.map_err(|_| {
        content(
            "no such array".into(),
            &format!("one of {}", known.join(", ")),
        )
    })?;
    let read = entry.take(limit).read_to_end(&mut bytes);
    read.map_err(|error| content(error.to_string(), "an undamaged array"))?;
    parse(&bytes).ok_or_else(|| {
        let header: String =
            String::from_utf8_lossy(bytes.get(..128).unwrap_or(&bytes)).into_owned();
        content(
            format!("{:?}", header.trim_end()),
            "an array of real numbers, as long as its shape says",
        )
    })
}

/// The NPY format, versions 1 to 3: magic, version, length of the header, a Python dictionary, the
/// numbers.
fn parse(file: &[u8]) -> Option<ArrayD<f64>> {
    let mut bytes = Bytes::new(file);
    if bytes.take(6).ok()? != b"\x93NUMPY" {
        return None;
    }
    let [major, _] = bytes.array().ok()?;
    let length = if major == 1 {
        u64::from(bytes.u16().ok()?)
    } else {
        u64::from(bytes.u32().ok()?)
    };
    let header = std::str::from_utf8(bytes.take(length).ok()?).ok()?;
    let kind = value_of(header, "descr")?
        .trim_start()
        .strip_prefix(['\'', '"'])?
        .get(..3)?;
    let is_fortran = value_of(header, "fortran_order")?
        .trim_start()
        .starts_with("True");
    let shape = value_of(header, "shape")?
        .trim_start()
        .strip_prefix('(')?
        .split_once(')')?
        .0;
    let shape = shape
        .split(',')
        .map(str::trim)
        .filter(|length| !length.is_empty());
    let shape: Vec<usize> = shape
        .map(|length| length.trim_end_matches('L').parse().ok())
        .collect::<Option<_>>()?;
    let count = shape
        .iter()
        .try_fold(1_usize, |product, &length| product.checked_mul(length))?;
    let numbers = numbers(kind, bytes.rest(), count)?;
    let array = ArrayD::from_shape_vec(IxDyn(&shape).set_f(is_fortran), numbers).ok()?;
    Some(array.as_standard_layout().into_owned())
}

/// What stands behind a key of the header's dictionary.
fn value_of<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let behind = &header[header.find(&format!("'{key}'"))? + key.len() + 2..];
    behind.trim_start().strip_prefix(':')
}

/// Numbers of the kind `<f8`, `>i2`, `|u1`, ...
fn numbers(kind: &str, bytes: &[u8], count: usize) -> Option<Vec<f64>> {
    let size: usize = kind.get(2..)?.parse().ok()?;
    if !matches!(size, 1 | 2 | 4 | 8) || count.checked_mul(size)? != bytes.len() {
        return None;
    }
    let is_big = kind.starts_with('>');
    let class = kind.as_bytes()[1];
    let number = |bytes: &[u8]| {
        let mut wide = [0; 8];
        for (k, byte) in bytes.iter().enumerate() {
            wide[if is_big { size - 1 - k } else { k }] = *byte;
        }
        let bits = u64::from_le_bytes(wide);
        let unused = 64 - 8 * size as u32;
        match (class, size) {
            (b'f', 8) => Some(f64::from_bits(bits)),
            (b'f', 4) => Some(f64::from(f32::from_bits(bits as u32))),
            (b'i', _) => Some((((bits << unused) as i64) >> unused) as f64),
            (b'u', _) | (b'b', 1) => Some(bits as f64),
            _ => None,
        }
    };
    bytes.chunks_exact(size).map(number).collect()
}

/// The mapped arrays of a recording: `name` for one channel, `name[row]` for a row of (channel,
/// sample).
pub(crate) fn read(path: &Path, map: &LogMap, signals: &[&Signal]) -> Result<Recording, FileError> {
    let rows = signals
        .iter()
        .map(|signal| row(path, &signal.source))
        .collect::<Result<Vec<_>, _>>()?;
    let times = map
        .time
        .as_ref()
        .map(|time| row(path, &time.source))
        .transpose()?;
    let n = rows.first().map_or(0, Vec::len);
    for (signal, row) in signals
        .iter()
        .zip(&rows)
        .chain(map.time.as_ref().iter().zip(&times))
    {
        if row.len() != n {
            return Err(FileError::Content {
                path: path.into(),
                what: format!("array {}", signal.source),
                found: format!("{} samples", row.len()),
                needed: format!("{n}, as in {}", signals[0].source),
            });
        }
    }
    let clock = Times::of(path, map, |_| Ok(0))?;
    let time = |k: usize| Ok(times.as_ref().map_or(0.0, |times| times[k]));
    let mut series = Series {
        topic: "samples".into(),
        signals: (0..signals.len()).collect(),
        ..Default::default()
    };
    for k in 0..n {
        series.stamps_ns.push(clock.stamp_ns(k, |_| time(k))?);
        series.rows.push(rows.iter().map(|row| row[k]).collect());
    }
    Ok(Recording {
        series: vec![series],
        sample_time_s: clock.sample_time_s(map),
        ..Default::default()
    })
}

fn row(path: &Path, source: &str) -> Result<Vec<f64>, FileError> {
    let (name, place) = match source
        .strip_suffix(']')
        .and_then(|source| source.split_once('['))
    {
        Some((name, place)) => (name, place.parse::<usize>().ok()),
        None => (source, None),
    };
    let array = read_npz_array(path, name)?;
    let row = match (array.ndim(), place) {
        (1, None) => Some(array.iter().copied().collect()),
        (2, Some(place)) => array
            .outer_iter()
            .nth(place)
            .map(|row| row.iter().copied().collect()),
        _ => None,
    };
    row.ok_or_else(|| FileError::Content {
        path: path.into(),
        what: format!("source {source} in the log map"),
        found: format!("an array of shape {:?}", array.shape()),
        needed: "name for an array (sample), name[row] for one (channel, sample)".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic_write::Overwrite;
    use crate::result::npz::write_frf_npz;
    use frfid_signals::{Frf, Uncertainty};
    use ndarray::Array3;
    use num_complex::Complex64;

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
            parse(&npy(kind, "False", "(2,)", data)).map(|array| array.into_raw_vec_and_offset().0)
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
        let fortran = parse(&npy("|u1", "True", "(2, 2)", &[1, 2, 3, 4])).expect("sound");
        assert_eq!(
            fortran.iter().copied().collect::<Vec<_>>(),
            [1.0, 3.0, 2.0, 4.0]
        );
        assert_eq!(
            parse(&npy("|u1", "False", "(18446744073709551615, 3)", &[1])),
            None
        );
        assert_eq!(
            parse(&npy("|u1", "False", "()", &[7])).map(|array| array.sum()),
            Some(7.0)
        );
    }

    #[test]
    fn what_we_write_comes_back_and_nothing_that_was_not_measured() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("frf.npz");
        let covariance =
            Array3::from_shape_fn((3, 1, 1), |(k, ..)| Complex64::from(0.1 * k as f64));
        let frf = Frf {
            frequency_hz: vec![1.0, 2.0, 3.0],
            response: Array3::from_elem((3, 1, 1), Complex64::new(1.0, -1.0)),
            noise: Some(Uncertainty {
                covariance,
                degrees_of_freedom: 9,
            }),
            total: None,
            condition: None,
            relative_resolution: None,
        };
        write_frf_npz(&path, Overwrite::Refuse, &frf).expect("sound");
        let read =
            |name| read_npz_array(&path, name).map(|array| array.into_raw_vec_and_offset().0);
        assert_eq!(read("frequency_hz").expect("there"), [1.0, 2.0, 3.0]);
        assert_eq!(read("noise_variance").expect("there"), [0.0, 0.1, 0.2]);
        assert_eq!(read("noise_degrees_of_freedom").expect("there"), [9.0]);
        let names = read("total_variance")
            .expect_err("was not measured")
            .to_string();
        assert!(
            names.contains("one of frequency_hz, noise_covariance, noise_degrees_of_freedom, noise_variance, response"),
            "{names}"
        );
        assert!(
            read("response")
                .expect_err("complex")
                .to_string()
                .contains("<c16")
        );
        let first = std::fs::read(&path).expect("written");
        write_frf_npz(&path, Overwrite::Replace, &frf).expect("sound");
        assert_eq!(std::fs::read(&path).expect("written"), first);
    }
}
