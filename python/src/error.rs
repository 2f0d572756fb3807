//! Errors of the crates as Python exceptions: `ValueError` for bad input, `NumericalError` for singular or divergent.

use frfid_estimate::EstimateError;
use frfid_plant::PlantError;
use frfid_signals::{SignalError, TestbedError};
use pyo3::PyErr;
use pyo3::exceptions::{PyArithmeticError, PyValueError};

pyo3::create_exception!(
    frfid,
    NumericalError,
    PyArithmeticError,
    "The numbers gave out: a matrix that cannot be inverted, a simulation that diverged, a search that found nothing."
);

/// Bad input, in the words of the crate that found it.
pub fn signal(error: SignalError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A matrix that cannot be inverted is a matter of numbers, everything else of the recording that was given.
pub fn estimate(error: EstimateError) -> PyErr {
    match error {
        EstimateError::RankDeficient(_) => NumericalError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// A simulation that diverged is a matter of numbers.
pub fn testbed(error: TestbedError) -> PyErr {
    match &error {
        TestbedError::Diverged { .. } => NumericalError::new_err(error.to_string()),
        TestbedError::Foreign { source, .. } => match source.downcast_ref::<PlantError>() {
            Some(PlantError::Chatter { .. }) => NumericalError::new_err(error.to_string()),
            _ => PyValueError::new_err(error.to_string()),
        },
        TestbedError::Run(_) => PyValueError::new_err(error.to_string()),
    }
}
