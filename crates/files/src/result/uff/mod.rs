//! Universal file of a result, dataset 58 (function at nodal degree of freedom), as programs for
//! modal analysis and pyuff open it.
//!
//! Text in columns, as Fortran wrote it: a dataset stands between lines of `-1`. First come the
//! units (dataset 164, SI), then a function for each entry: its frequency response, and below it
//! its variances where they were measured, as functions of the general type that say so in their
//! second line. The format keeps 13 digits of an ordinate and six of a frequency, it has no word for
//! what is not known: such lines are left out, and the fourth line of the function counts them.
//!
//! SDRC, Universal File Datasets Summary, dataset 58.

mod dataset;

use std::io::Write;
use std::path::Path;

use ndarray::{Array3, s};
use num_complex::Complex64;

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::result::result_file::ResultFile;
use crate::result::uff::dataset::{
    Channel, FREQUENCY_RESPONSE, Function, GENERAL, even_spacing, scientific, write_function,
};

/// Units of the numbers: SI, as the format lists them, and what converts them to SI.
const UNITS: &str = "    -1
   164
         1  SI: Meter (newton)         2
  1.00000000000000000D+00  1.00000000000000000D+00  1.00000000000000000D+00
  2.73149999999999977D+02
    -1
";

/// Writes a function for each entry, and one for each variance of it that was measured.
///
/// # Errors
/// Those of writing (see [`Overwrite`]); [`FileError::Shape`] for frequencies that agree in six
/// digits, and for a result of which no line is known.
pub(crate) fn write_frf_uff(
    path: &Path,
    overwrite: Overwrite,
    result: &ResultFile,
) -> Result<(), FileError> {
    let functions = functions(result);
    if functions.is_empty() {
        let needed = "a frequency response with a line that is known";
        return Err(FileError::shape("response", "nothing but NaN", needed));
    }
    functions.iter().try_for_each(check_abscissa)?;
    write_file(path, overwrite, |file| {
        file.write_all(UNITS.as_bytes())?;
        functions.iter().try_for_each(|function| {
            write_function(file, function)?;
            Ok(())
        })
    })
}

/// All functions, those without a known line left out.
fn functions(result: &ResultFile) -> Vec<Function<'_>> {
    let frf = &result.frf;
    let mut functions = Vec::new();
    let variances = [
        ("noise", &frf.noise, frf.noise_variance()),
        ("total", &frf.total, frf.total_variance()),
    ];
    for output in 0..frf.n_outputs() {
        for input in 0..frf.n_inputs() {
            let entry = (output, input);
            let what = "frequency response".to_owned();
            let response = frf.response.slice(s![.., output, input]).to_vec();
            functions.push(function(result, entry, what, response));
            for (name, known, variance) in &variances {
                let (Some(known), Some(variance)) = (known, variance) else {
                    continue;
                };
                let freedom = known.degrees_of_freedom;
                let what = format!(
                    "{name} variance of the response, E|dG|^2; {freedom} degrees of freedom"
                );
                let values = reals(variance, entry);
                functions.push(as_variance(function(result, entry, what, values)));
            }
        }
    }
    functions.retain(|function| !function.values.is_empty());
    for (number, function) in functions.iter_mut().enumerate() {
        function.number = number + 1;
    }
    functions
}

/// The values of one entry.
fn reals(values: &Array3<f64>, (output, input): (usize, usize)) -> Vec<Complex64> {
    let values = values.slice(s![.., output, input]);
    values.iter().map(|&value| value.into()).collect()
}

/// A function of this entry, with what is known of these values.
fn function(
    result: &ResultFile,
    (output, input): (usize, usize),
    what: String,
    values: Vec<Complex64>,
) -> Function<'_> {
    let lines = result.frf.frequency_hz.iter().copied().zip(values);
    let n_lines = result.frf.n_frequencies();
    let known = lines.filter(|(_, value)| value.is_finite());
    let (frequency_hz, values): (Vec<f64>, Vec<Complex64>) = known.unzip();
    Function {
        kind: FREQUENCY_RESPONSE,
        what,
        number: 0,
        output: channel(&result.output_names[output], &result.output_units[output]),
        input: channel(&result.input_names[input], &result.input_units[input]),
        nodes: (output + 1, input + 1),
        n_unknown: n_lines - values.len(),
        frequency_hz,
        values,
    }
}

/// The same as a variance: real, of no type that the format has, in squared units.
fn as_variance(mut function: Function) -> Function {
    function.kind = GENERAL;
    for channel in [&mut function.output, &mut function.input] {
        channel.unit = format!("({})^2", channel.unit);
        channel.kind.0 = 0;
    }
    function
}

fn channel<'a>(name: &'a str, unit: &str) -> Channel<'a> {
    Channel {
        name,
        unit: unit.to_owned(),
        kind: kind(unit),
    }
}

/// Type of the data and direction of a unit: a joint turns or slides along the z axis of its own
/// frame, as Denavit and Hartenberg have it; anything else is a scalar of an unknown type.
fn kind(unit: &str) -> (u32, u32) {
    let (displacement, velocity, acceleration, force) = (8, 11, 12, 13);
    let (along_z, about_z) = (3, 6);
    match unit {
        "rad" => (displacement, about_z),
        "rad/s" => (velocity, about_z),
        "rad/s^2" => (acceleration, about_z),
        "N m" => (force, about_z),
        "m" => (displacement, along_z),
        "m/s" => (velocity, along_z),
        "m/s^2" => (acceleration, along_z),
        "N" => (force, along_z),
        _ => (0, 0),
    }
}

/// Refuses frequencies that the format cannot tell apart.
fn check_abscissa(function: &Function) -> Result<(), FileError> {
    if even_spacing(&function.frequency_hz).is_some() {
        return Ok(());
    }
    for pair in function.frequency_hz.windows(2) {
        let [low, high] = [pair[0], pair[1]].map(|hz| scientific(hz, 13, 5));
        if low == high {
            let found = format!("{:?} and {:?} Hz, unevenly spaced", pair[0], pair[1]);
            let needed =
                "frequencies that differ in the six digits a UFF has; export CSV, NPZ or MAT";
            return Err(FileError::shape("frequency_hz", found, needed));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::testing::result;

    fn written(result: &ResultFile) -> Result<String, FileError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("frf.uff");
        write_frf_uff(&path, Overwrite::Refuse, result)?;
        Ok(std::fs::read_to_string(&path).expect("written"))
    }

    /// The lines of the functions, without those that open and close them.
    fn functions_of(text: &str) -> Vec<Vec<&str>> {
        let datasets: Vec<&str> = text
            .split("    -1\n")
            .filter(|part| !part.is_empty())
            .collect();
        datasets[1..]
            .iter()
            .map(|text| text.lines().collect())
            .collect()
    }

    #[test]
    fn every_record_stands_in_its_columns_and_what_is_unknown_is_left_out() {
        let text = written(&result()).expect("sound");
        assert!(text.lines().all(|line| line.len() <= 80) && text.is_ascii());
        let functions = functions_of(&text);
        assert_eq!(functions.len(), 4); // two entries, noise of each; no total
        let [response, variance] = [&functions[0], &functions[1]];
        assert_eq!(response[0], format!("{:>6}{:74}", 58, ""));
        assert!(response[1].starts_with("axis 1 / torque ") && response[1].len() == 80);
        assert_eq!(response[2].trim_end(), "frequency response");
        assert_eq!(
            response[4].trim_end(),
            "1 of 4 lines are not known and left out"
        );
        assert_eq!(
            response[6],
            "    4         1    0         0 NONE               1   6 NONE               1   6"
        );
        let even = "         6         3         0  0.00000E+00  0.00000E+00  0.00000E+00";
        assert_eq!(response[7], even);
        assert_eq!(
            response[9].trim_end(),
            "        11    0    0    0 axis 1               rad/s"
        );
        assert_eq!(
            response[10].trim_end(),
            "        13    0    0    0 torque               N m"
        );
        assert_eq!(
            response[12],
            "  1.00000E-01  0.000000000000E+00 -1.000000000000E+00"
        );
        assert_eq!(response.len(), 15);
        assert_eq!(
            variance[2].trim_end(),
            "noise variance of the response, E|dG|^2; 40 degrees of freedom"
        );
        assert!(variance[6].starts_with("    0         2") && variance[9].contains("(rad/s)^2"));
    }

    #[test]
    fn even_lines_have_no_abscissae_and_uneven_ones_must_differ() {
        let mut even = result();
        even.frf.frequency_hz = vec![0.1, 0.2, 0.1 + 0.2, 0.4];
        even.frf.noise = None;
        even.frf.response[[2, 0, 0]] = Complex64::ONE;
        let text = written(&even).expect("sound");
        let functions = functions_of(&text);
        assert!(functions[0][7].ends_with("         1  1.00000E-01  1.00000E-01  0.00000E+00"));
        assert_eq!((functions[0].len(), functions[0][12].len()), (14, 80));
        even.frf.frequency_hz = vec![1000.0, 1000.0001, 1000.5, 1001.0];
        let error = written(&even).expect_err("they agree").to_string();
        assert!(error.contains("1000.0 and 1000.0001 Hz"), "{error}");
        even.frf.response.fill(Complex64::new(f64::NAN, 0.0));
        let error = written(&even).expect_err("nothing is known").to_string();
        assert!(error.contains("nothing but NaN"), "{error}");
    }
}
