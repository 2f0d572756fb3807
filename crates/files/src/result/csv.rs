//! An FRF as a CSV: one row per frequency, every column named with its unit.

use std::io::Write;
use std::path::Path;

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::result::ResultFile;

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
            let row: Vec<_> = columns
                .iter()
                .map(|(_, values)| format!("{:?}", values[k]))
                .collect();
            writeln!(file, "{}", row.join(","))?;
        }
        Ok(())
    })
}

fn columns(result: &ResultFile) -> Vec<Column> {
    let frf = &result.frf;
    let mut columns = vec![("frequency [Hz]".into(), frf.frequency_hz.clone())];
    let (noise, total) = (frf.noise_variance(), frf.total_variance());
    for (output, output_name) in result.output_names.iter().enumerate() {
        for (input, input_name) in result.input_names.iter().enumerate() {
            let entry = format!("{output_name} / {input_name}");
            let unit = format!(
                "{} per {}",
                result.output_units[output], result.input_units[input]
            );
            let values =
                |of: &dyn Fn(usize) -> f64| (0..frf.n_frequencies()).map(of).collect::<Vec<_>>();
            columns.extend([
                (
                    format!("re {entry} [{unit}]"),
                    values(&|k| frf.response[[k, output, input]].re),
                ),
                (
                    format!("im {entry} [{unit}]"),
                    values(&|k| frf.response[[k, output, input]].im),
                ),
                (
                    format!("magnitude {entry} [dB re 1 {unit}]"),
                    frf.magnitude_db(output, input),
                ),
                (format!("phase {entry} [deg]"), frf.phase_deg(output, input)),
            ]);
            for (name, variance) in [("noise", &noise), ("total", &total)] {
                if let Some(variance) = variance {
                    let deviation = values(&|k| variance[[k, output, input]].sqrt());
                    columns.push((
                        format!("{name} standard deviation {entry} [{unit}]"),
                        deviation,
                    ));
                }
            }
        }
    }
    columns.extend(
        frf.condition
            .iter()
            .map(|condition| ("condition number of U [1]".into(), condition.clone())),
    );
    columns
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
    use crate::result::tests::result;

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
