//! Parts of a `frfid.Frf`: arrays, uncertainty, lists of names.

use frfid_signals::Uncertainty;
use ndarray::Ix1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, Shared, complex, real};
use crate::size::{List, copied};

const ENTRIES: Axes = &["frequency", "output * input", "output * input"];

/// Its arrays as numpy shows them.
#[derive(Default)]
pub(crate) struct Arrays {
    pub frequency_hz: Shared,
    pub response: Shared,
    pub noise_variance: Shared,
    pub total_variance: Shared,
    pub nonlinear_variance: Shared,
    pub noise_covariance: Shared,
    pub total_covariance: Shared,
    pub condition: Shared,
}

/// The keywords of the constructor, attributes of the FRF too.
pub(crate) const PARTS: [&str; 19] = [
    "frequency_hz",
    "response",
    "noise_covariance",
    "noise_degrees_of_freedom",
    "total_covariance",
    "total_degrees_of_freedom",
    "condition",
    "relative_resolution",
    "torque_rms_nm",
    "flagged",
    "distortion",
    "harmonics",
    "input_names",
    "output_names",
    "input_units",
    "output_units",
    "verdicts",
    "checks",
    "provenance",
];

/// Covariance and degrees of freedom: both or none.
pub(crate) fn uncertainty(
    name: &str,
    covariance: Option<&Bound<'_, PyAny>>,
    degrees: Option<f64>,
) -> PyResult<Option<Uncertainty>> {
    match (covariance, degrees) {
        (None, None) => Ok(None),
        (Some(covariance), Some(degrees_of_freedom)) => {
            let covariance = complex(&format!("{name}_covariance"), covariance, &[ENTRIES])?;
            let covariance = copied(&covariance.as_array())?;
            Ok(Some(Uncertainty {
                covariance,
                degrees_of_freedom,
            }))
        }
        _ => Err(PyValueError::new_err(format!(
            "{name}_covariance and {name}_degrees_of_freedom belong together: only one of them was given"
        ))),
    }
}

/// Complex degrees of freedom of what is known.
pub(crate) fn degrees_of_freedom(known: &Option<Uncertainty>) -> Option<f64> {
    Some(known.as_ref()?.degrees_of_freedom)
}

/// Puts the list that is given in place of another, as long as that is.
pub(crate) fn replace<T>(name: &str, list: &mut Vec<T>, given: Option<List<T>>) -> PyResult<()> {
    let Some(List(given)) = given else {
        return Ok(());
    };
    if given.len() != list.len() {
        let (found, needed) = (given.len(), list.len());
        return Err(PyValueError::new_err(format!(
            "{name} has {found} entries, needed {needed}"
        )));
    }
    *list = given;
    Ok(())
}

/// A number for every frequency.
pub(crate) fn per_frequency(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let values = real::<Ix1>(name, value, &[&["frequency"]])?;
    Ok(copied(&values.as_array())?.to_vec())
}
