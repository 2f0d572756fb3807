//! JSON of a result: named arrays, what was checked, and where it came from.
//!
//! Arrays are flat, last axis first to change, with their shape beside them; complex ones have `re`
//! and `im`. A variance that was not measured is absent. A number that is not known (a line without
//! an estimate) is `null`.

use std::collections::BTreeMap;
use std::path::Path;

use frfid_signals::{Distortion, Frf, Uncertainty};
use ndarray::ArrayBase;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::result::harmonics_json::HarmonicsJson;
use crate::result::json_array::{Complexes, Flaw, Reals};
use crate::result::packed_numbers::is_packed;
use crate::result::result_file::{Check, ResultFile, check};
use crate::result::sealed::{Sealed, seal};
use crate::result::verdict::Verdict;

const FORMAT: &str = "frfid-result";
/// Version of results whose arrays are all plain, and of those with packed ones.
const PLAIN: u32 = 1;
const PACKED: u32 = 2;

#[derive(Serialize, Deserialize)]
struct Json {
    format: String,
    version: u32,
    input_names: Vec<String>,
    output_names: Vec<String>,
    input_units: Vec<String>,
    output_units: Vec<String>,
    frequency_hz: Reals,
    response: Complexes,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    noise: Option<UncertaintyJson>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    total: Option<UncertaintyJson>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    condition: Option<Reals>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    relative_resolution: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    torque_rms_nm: Option<Reals>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    flagged: Option<Vec<bool>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    harmonics: Option<HarmonicsJson>,
    distortion: Option<Distortion>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    verdicts: Vec<Verdict>,
    checks: Vec<Check>,
    provenance: BTreeMap<String, String>,
    /// The seal, which the file ends with.
    #[serde(default, skip_serializing)]
    sha256: Option<IgnoredAny>,
}

#[derive(Serialize, Deserialize)]
struct UncertaintyJson {
    degrees_of_freedom: f64,
    covariance: Complexes,
}

/// Writes a result.
///
/// ```
/// use frfid_files::{Overwrite, ResultFile, read_result, write_result};
/// use frfid_signals::Frf;
/// use ndarray::Array3;
/// use num_complex::Complex64;
///
/// let frf = Frf {
///     frequency_hz: vec![1.0 / 3.0],
///     response: Array3::from_elem((1, 1, 1), Complex64::new(0.1, f64::INFINITY)),
///     noise: None,
///     total: None,
///     condition: None,
///     relative_resolution: None,
/// };
/// let path = std::env::temp_dir().join(format!("frfid-{}.json", std::process::id()));
/// let result = ResultFile::torque_to_velocity(frf, &["joint_1".into()]);
/// write_result(&path, Overwrite::Replace, &result)?;
/// assert_eq!(read_result(&path)?, result); // every bit
/// # Ok::<(), frfid_files::FileError>(())
/// ```
///
/// # Errors
/// [`FileError::Shape`] if names or units do not fit the FRF, and those of writing (see
/// [`Overwrite`]).
pub fn write_result(
    path: &Path,
    overwrite: Overwrite,
    result: &ResultFile,
) -> Result<(), FileError> {
    check(result).map_err(|(what, found, needed)| FileError::shape(what, found, needed))?;
    let json = Json::of(result);
    write_file(path, overwrite, |file| {
        let mut sealed = Sealed::new(file);
        serde_json::to_writer(&mut sealed, &json)?;
        Ok(sealed.seal()?)
    })
}

impl Json {
    fn of(result: &ResultFile) -> Self {
        let frf = &result.frf;
        Self {
            format: FORMAT.into(),
            version: version_of(result),
            input_names: result.input_names.clone(),
            output_names: result.output_names.clone(),
            input_units: result.input_units.clone(),
            output_units: result.output_units.clone(),
            frequency_hz: Reals::of(&frf.frequency_hz),
            response: Complexes::of(&frf.response),
            noise: frf.noise.as_ref().map(UncertaintyJson::of),
            total: frf.total.as_ref().map(UncertaintyJson::of),
            condition: frf.condition.as_deref().map(Reals::of),
            relative_resolution: frf.relative_resolution,
            torque_rms_nm: result.torque_rms_nm.as_deref().map(Reals::of),
            flagged: result.flagged.clone(),
            harmonics: result.harmonics.as_ref().map(HarmonicsJson::of),
            distortion: result.distortion.clone(),
            verdicts: result.verdicts.clone(),
            checks: result.checks.clone(),
            provenance: result.provenance.clone(),
            sha256: None,
        }
    }
}

/// The version of a result: older frfids refuse one that they cannot read.
fn version_of(result: &ResultFile) -> u32 {
    let frf = &result.frf;
    let covariances = [&frf.noise, &frf.total].into_iter().flatten();
    let covariances = covariances.map(|known| known.covariance.len());
    let harmonics = result.harmonics.iter().flat_map(|known| &known.response);
    let harmonics = harmonics.map(ArrayBase::len);
    let mut counts = covariances.chain(harmonics).chain([frf.response.len()]);
    match counts.any(is_packed) {
        true => PACKED,
        false => PLAIN,
    }
}

impl UncertaintyJson {
    fn of(known: &Uncertainty) -> Self {
        Self {
            degrees_of_freedom: known.degrees_of_freedom,
            covariance: Complexes::of(&known.covariance),
        }
    }

    fn read(self, what: &'static str) -> Result<Uncertainty, Flaw> {
        Ok(Uncertainty {
            covariance: self.covariance.into_array(what)?,
            degrees_of_freedom: self.degrees_of_freedom,
        })
    }
}

/// Reads a result.
///
/// # Errors
/// [`FileError::Io`]; [`FileError::Format`] if it is no result of ours; [`FileError::Content`] if
/// arrays contradict their shapes or each other.
pub fn read_result(path: &Path) -> Result<ResultFile, FileError> {
    let content = |(what, found, needed): Flaw| FileError::content(path, what, found, needed);
    let result = from_json(read_json(path)?).map_err(content)?;
    check(&result).map_err(content)?;
    Ok(result)
}

/// The JSON as it stands in the file, if it is a result in the version that is read.
fn read_json(path: &Path) -> Result<Json, FileError> {
    let format = |found: String| {
        let needed = "a result written by frfid (JSON, frfid-result version 1 or 2)";
        FileError::format(
            path,
            found,
            needed,
            "estimate it again, or give another file",
        )
    };
    let bytes = std::fs::read(path).map_err(FileError::cannot("open", path))?;
    let json: Json = serde_json::from_slice(&bytes).map_err(|error| format(error.to_string()))?;
    if json.format != FORMAT || !(PLAIN..=PACKED).contains(&json.version) {
        return Err(format(format!("{} version {}", json.format, json.version)));
    }
    let is_whole = seal(&bytes).unwrap_or(json.sha256.is_none());
    if !is_whole {
        let found = "not the checksum of what stands before it";
        let needed = "the file as frfid wrote it: it is damaged; if it was changed on purpose, take out this key";
        return Err(FileError::content(path, "sha256", found, needed));
    }
    Ok(json)
}

fn from_json(json: Json) -> Result<ResultFile, Flaw> {
    let uncertainty =
        |what, json: Option<UncertaintyJson>| json.map(|json| json.read(what)).transpose();
    let list = |what, json: Option<Reals>| json.map(|json| json.into_list(what)).transpose();
    Ok(ResultFile {
        frf: Frf {
            frequency_hz: json.frequency_hz.into_list("frequency_hz")?,
            response: json.response.into_array("response")?,
            noise: uncertainty("noise.covariance", json.noise)?,
            total: uncertainty("total.covariance", json.total)?,
            condition: list("condition", json.condition)?,
            relative_resolution: json.relative_resolution,
        },
        input_names: json.input_names,
        output_names: json.output_names,
        input_units: json.input_units,
        output_units: json.output_units,
        torque_rms_nm: list("torque_rms_nm", json.torque_rms_nm)?
            .or_else(|| torque_of_old(&json.provenance)),
        flagged: json.flagged,
        harmonics: json.harmonics.map(HarmonicsJson::read).transpose()?,
        distortion: json.distortion,
        verdicts: json.verdicts,
        checks: json.checks,
        provenance: json.provenance,
    })
}

/// The torques that results of frfid 0.1.0 hold as a text among their provenance.
fn torque_of_old(provenance: &BTreeMap<String, String>) -> Option<Vec<f64>> {
    serde_json::from_str(provenance.get("effort_rms_nm")?).ok()
}

#[cfg(test)]
mod tests {
    use ndarray::Array3;
    use num_complex::Complex64;

    use super::*;
    use crate::result::testing::result;

    /// A result as it stands in its file.
    fn written(path: &Path) -> String {
        write_result(path, Overwrite::Refuse, &result()).expect("sound");
        std::fs::read_to_string(path).expect("written")
    }

    /// What is read of a result whose text was changed on purpose, its seal taken out.
    fn rewritten(edit: impl FnOnce(String) -> String) -> Result<ResultFile, FileError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("r.json");
        let text = written(&path);
        let (content, _) = text.rsplit_once(",\"sha256\"").expect("sealed");
        std::fs::write(&path, edit(format!("{content}}}"))).expect("written");
        read_result(&path)
    }

    #[test]
    fn no_flipped_bit_is_believed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("r.json");
        let sound = written(&path).into_bytes();
        let text = |result: &ResultFile| format!("{result:?}");
        for bit in (0..8 * sound.len()).step_by(3) {
            let mut flipped = sound.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&path, flipped).expect("written");
            if let Ok(read) = read_result(&path) {
                // a bit in the name of the key that seals
                assert_eq!(text(&read), text(&result()), "bit {bit}");
            }
        }
    }

    #[test]
    fn degrees_of_freedom_are_whole_in_old_files_and_any_number_in_new_ones() {
        let with = |number: &str| {
            let key = |number: &str| format!("\"degrees_of_freedom\":{number}");
            rewritten(|text| text.replace(&key("40.0"), &key(number)))
        };
        for (number, expected) in [("40", 40.0), ("3.75", 3.75)] {
            let known = with(number).expect("sound").frf.noise.expect("measured");
            assert_eq!(known.degrees_of_freedom, expected);
        }
        assert!(with("-1").is_err() && with("null").is_err());
    }

    #[test]
    fn a_result_comes_back_and_what_was_not_measured_is_absent() {
        let back = rewritten(|text| {
            assert!(
                !text.contains("total")
                    && text.contains("\"inf\"")
                    && text.contains("\"shape\":[4,2,1]"),
                "{text}"
            );
            text
        });
        let back = back.expect("sound");
        let text = |result: &ResultFile| format!("{result:?}");
        assert_eq!(text(&back), text(&result()));
        assert!(back.frf.response[[2, 0, 0]].re.is_nan());
    }

    #[test]
    fn many_numbers_are_packed_and_come_back_to_the_last_bit() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("r.json");
        let n_lines = 2000;
        let number = |k: usize| Complex64::new((k as f64).sin() / 3.0, (k as f64).cos());
        let covariance = |(k, row, column): (usize, usize, usize)| match row.abs_diff(column) {
            0 => Complex64::new(2.0 + (k as f64).sin(), 0.0),
            _ if row / 6 == column / 6 => number(k + row.min(column) * row.max(column)),
            _ => Complex64::ZERO,
        };
        let known = Uncertainty {
            covariance: Array3::from_shape_fn((n_lines, 36, 36), covariance),
            degrees_of_freedom: 7.5,
        };
        let frf = Frf {
            frequency_hz: (1..=n_lines).map(|k| k as f64 / 3.0).collect(),
            response: Array3::from_shape_fn((n_lines, 6, 6), |(k, o, i): (usize, usize, usize)| {
                number(k * o + i)
            }),
            noise: Some(known.clone()),
            total: Some(known),
            condition: None,
            relative_resolution: None,
        };
        let names: Vec<String> = (1..=6).map(|k| format!("joint_{k}")).collect();
        let result = ResultFile::torque_to_velocity(frf, &names);
        write_result(&path, Overwrite::Refuse, &result).expect("sound");
        let n_bytes = std::fs::metadata(&path).expect("written").len();
        assert!(n_bytes < 15_000_000, "{n_bytes} bytes");
        assert!(read_result(&path).expect("sound") == result);
    }

    #[test]
    fn contradictions_are_named() {
        for (from, to, told) in [
            ("\"shape\":[4,2,1]", "\"shape\":[4,1,1]", "response"),
            ("\"shape\":[4,2,1]", "\"shape\":[8]", "response"),
            (
                "\"shape\":[4,2,1]",
                "\"shape\":[18446744073709551615,2,1]",
                "response",
            ),
            ("[\"torque\"]", "[]", "input_names"),
            ("\"version\":1", "\"version\":3", "version 3"),
            ("frfid-result", "other", "other version 1"),
            (
                "\"frequency_hz\"",
                "\"frequency\"",
                "missing field `frequency_hz`",
            ),
            ("0.30000000000000004", "\"x\"", "a number, null"),
        ] {
            let error = rewritten(|text| text.replacen(from, to, 1))
                .expect_err(to)
                .to_string();
            assert!(error.contains(told), "{error}");
        }
    }
}
