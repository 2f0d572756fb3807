//! Result: an FRF with names, units, checks, and where it came from.

use std::collections::BTreeMap;

use frfid_signals::{Amplitudes, Distortion, Frf, Harmonics};
use serde::{Deserialize, Serialize};

use crate::result::json_array::Flaw;
use crate::result::verdict::Verdict;

/// One condition that a measurement should fulfil, and whether it did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// What was checked.
    pub name: String,
    /// Whether it holds.
    pub passed: bool,
    /// What was found, with unit.
    pub found: String,
    /// What was needed, with unit.
    pub needed: String,
    /// What to do if it does not hold.
    pub advice: String,
}

/// An FRF with everything that belongs to it.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultFile {
    /// The frequency response with its uncertainty.
    pub frf: Frf,
    /// Name of each input.
    pub input_names: Vec<String>,
    /// Name of each output.
    pub output_names: Vec<String>,
    /// SI unit of each input.
    pub input_units: Vec<String>,
    /// SI unit of each output.
    pub output_units: Vec<String>,
    /// Rms of the motor torque of each input in N m, where the inputs are torques and it was
    /// measured: which of two results had the stronger excitation.
    pub torque_rms_nm: Option<Vec<f64>>,
    /// Whether what remains of the torque ripple exceeds the noise, frequency by frequency; `None`
    /// where that cannot be told.
    pub flagged: Option<Vec<bool>>,
    /// Harmonics of a chirp in inputs and outputs; `None` of other excitations.
    pub harmonics: Option<Harmonics>,
    /// Levels of noise and nonlinear distortion at every input and output; `None` where the excitation leaves no
    /// lines out on which they show.
    pub distortion: Option<Distortion>,
    /// What each axis suffers from; empty where nobody judged it.
    pub verdicts: Vec<Verdict>,
    /// What was checked.
    pub checks: Vec<Check>,
    /// Versions, seeds, hashes, amplitudes, limits, ...
    pub provenance: BTreeMap<String, String>,
}

impl ResultFile {
    /// An FRF of which nothing else is known, between channels of these names and SI units.
    #[must_use]
    pub fn between(
        frf: Frf,
        [input_names, input_units]: [Vec<String>; 2],
        [output_names, output_units]: [Vec<String>; 2],
    ) -> Self {
        Self {
            frf,
            input_names,
            output_names,
            input_units,
            output_units,
            torque_rms_nm: None,
            flagged: None,
            harmonics: None,
            distortion: None,
            verdicts: Vec::new(),
            checks: Vec::new(),
            provenance: BTreeMap::new(),
        }
    }

    /// An FRF from the motor torques to the motor velocities of these joints.
    #[must_use]
    pub fn torque_to_velocity(frf: Frf, joints: &[String]) -> Self {
        let channels = |quantity: &str, unit: &str| {
            let names = joints.iter().map(|joint| format!("{joint} {quantity}"));
            [names.collect(), vec![unit.to_owned(); joints.len()]]
        };
        Self::between(
            frf,
            channels("torque", "N m"),
            channels("velocity", "rad/s"),
        )
    }
}

/// Refuses lists that do not fit the FRF: what, found, needed.
pub(crate) fn check(result: &ResultFile) -> Result<(), Flaw> {
    let frf = &result.frf;
    frf.check().map_err(|error| {
        (
            "frf",
            error.to_string(),
            "arrays that fit each other".into(),
        )
    })?;
    if let Some(torque) = &result.torque_rms_nm {
        check_length("torque_rms_nm", torque, frf.n_inputs())?;
    }
    if let Some(flagged) = &result.flagged {
        check_length("flagged", flagged, frf.n_frequencies())?;
    }
    if let Some(harmonics) = &result.harmonics {
        check_harmonics(harmonics, [frf.n_inputs(), frf.n_outputs()])?;
    }
    if let Some(distortion) = &result.distortion {
        check_length("distortion.inputs", &distortion.inputs, frf.n_inputs())?;
        check_length("distortion.outputs", &distortion.outputs, frf.n_outputs())?;
    }
    check_length("input_names", &result.input_names, frf.n_inputs())?;
    check_length("output_names", &result.output_names, frf.n_outputs())?;
    check_length("input_units", &result.input_units, frf.n_inputs())?;
    check_length("output_units", &result.output_units, frf.n_outputs())
}

/// Refuses harmonics of other channels than the FRF, or arrays that do not fit.
fn check_harmonics(harmonics: &Harmonics, [inputs, outputs]: [usize; 2]) -> Result<(), Flaw> {
    let (orders, lines) = (harmonics.orders.len(), harmonics.frequency_hz.len());
    check_amplitudes("harmonics.input", &harmonics.input, (inputs, orders, lines))?;
    check_amplitudes(
        "harmonics.output",
        &harmonics.output,
        (outputs, orders, lines),
    )?;
    let found = harmonics.response.as_ref().map(ndarray::Array2::dim);
    match found.filter(|found| *found != (orders, lines)) {
        Some(found) => Err(unfit("harmonics.response", &found, &(orders, lines))),
        None => Ok(()),
    }
}

fn check_amplitudes(
    what: &'static str,
    amplitudes: &Amplitudes,
    needed: (usize, usize, usize),
) -> Result<(), Flaw> {
    let Amplitudes {
        amplitude,
        floor,
        deviation,
    } = amplitudes;
    let mut found = [amplitude, floor]
        .into_iter()
        .chain(deviation)
        .map(ndarray::Array3::dim);
    match found.find(|found| *found != needed) {
        Some(found) => Err(unfit(what, &found, &needed)),
        None => Ok(()),
    }
}

fn unfit(what: &'static str, found: &impl std::fmt::Debug, needed: &impl std::fmt::Debug) -> Flaw {
    (what, format!("shape {found:?}"), format!("{needed:?}"))
}

fn check_length<T>(what: &'static str, list: &[T], needed: usize) -> Result<(), Flaw> {
    match list.len() {
        found if found == needed => Ok(()),
        found => Err((what, found.to_string(), needed.to_string())),
    }
}
