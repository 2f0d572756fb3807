//! What a `frfid.Frf` is put together from.

use frfid_signals::Uncertainty;
use ndarray::Ix1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, Shared, complex, real};

const ENTRIES: Axes = &["frequency", "output * input", "output * input"];

/// Its arrays as numpy shows them.
#[derive(Default)]
pub struct Arrays {
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
pub const PARTS: [&str; 14] = [
    "frequency_hz",
    "response",
    "noise_covariance",
    "noise_degrees_of_freedom",
    "total_covariance",
    "total_degrees_of_freedom",
    "condition",
    "relative_resolution",
    "input_names",
    "output_names",
    "input_units",
    "output_units",
    "checks",
    "provenance",
];

/// Covariance and degrees of freedom: both or none.
pub fn uncertainty(
    name: &str,
    covariance: Option<&Bound<'_, PyAny>>,
    degrees: Option<usize>,
) -> PyResult<Option<Uncertainty>> {
    match (covariance, degrees) {
        (None, None) => Ok(None),
        (Some(covariance), Some(degrees_of_freedom)) => {
            let covariance = complex(&format!("{name}_covariance"), covariance, &[ENTRIES])?
                .as_array()
                .to_owned();
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

/// One entry for each of `needed` channels.
pub fn channels(
    name: &str,
    given: Option<Vec<String>>,
    default: Vec<String>,
    needed: usize,
) -> PyResult<Vec<String>> {
    match given {
        None => Ok(default),
        Some(list) if list.len() == needed => Ok(list),
        Some(list) => Err(PyValueError::new_err(format!(
            "{name} has {} entries, needed {needed}",
            list.len()
        ))),
    }
}

/// A number for every frequency.
pub fn per_frequency(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    Ok(real::<Ix1>(name, value, &[&["frequency"]])?
        .as_array()
        .to_vec())
}
