//! CSV of a result: one row per frequency, every column named with its unit.

use std::io::Write;
use std::path::Path;

use ndarray::{Array3, s};

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::result::result_file::ResultFile;

/// A column: its name and its values.
type Column = (String, Vec<f64>);

/// Writes frequency, real and imaginary part, magnitude and phase of every entry of the FRF, and
/// the standard deviations and the condition number where they are known.
///
/// # Errors
/// Those of writing (see [`Overwrite`]).
pub(crate) fn write_frf_csv(
    path: &Path,
    overwrite: Overwrite,
    result: &ResultFile,
) -> Result<(), FileError> {
    let columns = columns(result);
    write_file(path, overwrite, |file| {
        let header: Vec<_> = columns.iter().map(|(name, _)| quoted(name)).collect();
        writeln!(file, "{}", header.join(","))?;
        for k in 0..result.frf.n_frequencies() {
            writeln!(file, "{}", numbers(&columns, k))?;
        }
        Ok(())
    })
}

/// The values of all columns at a frequency.
fn numbers(columns: &[Column], k: usize) -> String {
    let numbers = columns.iter().map(|(_, values)| format!("{:?}", values[k]));
    numbers.collect::<Vec<_>>().join(",")
}

fn columns(result: &ResultFile) -> Vec<Column> {
    let frf = &result.frf;
    let mut columns = vec![("frequency [Hz]".into(), frf.frequency_hz.clone())];
    let variances = [
        ("noise", frf.noise_variance()),
        ("total", frf.total_variance()),
    ];
    for output in 0..frf.n_outputs() {
        for input in 0..frf.n_inputs() {
            columns.extend(columns_of_entry(result, output, input, &variances));
        }
    }
    let condition = frf.condition.clone();
    columns.extend(condition.map(|condition| ("condition number of U [1]".into(), condition)));
    columns
}

/// Real and imaginary part, magnitude, phase and standard deviations of an entry.
fn columns_of_entry(
    result: &ResultFile,
    output: usize,
    input: usize,
    variances: &[(&str, Option<Array3<f64>>)],
) -> Vec<Column> {
    let (frf, entry) = (&result.frf, s![.., output, input]);
    let (name, unit) = (
        name_of_entry(result, output, input),
        unit_of_entry(result, output, input),
    );
    let response = frf.response.slice(entry);
    let (re, im) = (
        response.mapv(|value| value.re),
        response.mapv(|value| value.im),
    );
    let (db, deg) = (
        frf.magnitude_db(output, input),
        frf.phase_deg(output, input),
    );
    let mut columns = vec![
        (format!("re {name} [{unit}]"), re.to_vec()),
        (format!("im {name} [{unit}]"), im.to_vec()),
        (format!("magnitude {name} [dB re 1 {unit}]"), db),
        (format!("phase {name} [deg]"), deg),
    ];
    for (kind, variance) in variances {
        let Some(variance) = variance else { continue };
        let deviation = variance.slice(entry).mapv(f64::sqrt).to_vec();
        columns.push((
            format!("{kind} standard deviation {name} [{unit}]"),
            deviation,
        ));
    }
    columns
}

fn name_of_entry(result: &ResultFile, output: usize, input: usize) -> String {
    format!(
        "{} / {}",
        result.output_names[output], result.input_names[input]
    )
}

fn unit_of_entry(result: &ResultFile, output: usize, input: usize) -> String {
    format!(
        "{} per {}",
        result.output_units[output], result.input_units[input]
    )
}

/// In quotes where a name holds what separates fields.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n']) {
        format!("\"{}\"", name.replace('"', "\"\"").replace('\n', " "))
    } else {
        name.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::testing::result;

    #[test]
    fn every_column_has_a_unit_and_every_number_all_its_digits() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("frf.csv");
        write_frf_csv(&path, Overwrite::Refuse, &result()).expect("sound");
        let text = std::fs::read_to_string(&path).expect("written");
        let mut lines = text.lines();
        let header = lines.next().expect("a header");
        assert!(
            header.starts_with("frequency [Hz],re axis 1 / torque [rad/s per N m],"),
            "{header}"
        );
        assert!(
            header.contains("\"re axis \"\"2\"\" / torque") && !header.contains("total"),
            "{header}"
        );
        let rows: Vec<Vec<f64>> = lines
            .map(|line| {
                line.split(',')
                    .map(|field| field.parse().expect("a number"))
                    .collect()
            })
            .collect();
        assert_eq!((rows.len(), rows[0].len()), (4, 12));
        assert_eq!(
            (rows[2][0].to_bits(), rows[3][1]),
            ((0.1 + 0.2_f64).to_bits(), 1.0)
        );
        assert!(rows[2][1].is_nan() && rows[2][11].is_infinite());
    }
}
