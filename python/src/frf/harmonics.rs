//! Harmonics of a `frfid.Frf` as dicts of arrays.

use frfid_signals::{Amplitudes, Frf as Response, Harmonics};
use ndarray::{Array1, Array2, Array3};
use num_complex::Complex64;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{Axes, c_ordered, complex, real};
use crate::frf::matrix::Frf;
use crate::frf::parts::per_frequency;
use crate::size::{List, copied};

const AMPLITUDE: Axes = &["channel", "order", "frequency"];

#[pymethods]
impl Frf {
    /// Harmonics that a chirp makes, told apart up to order 5; None of other excitations.
    ///
    /// A dict of ``frequency_hz`` (those of the fundamental), ``orders``, ``input`` and ``output``, each a dict of
    /// ``amplitude`` (in the unit of the signal, shape (channel, order, frequency), NaN where a harmonic does not stand
    /// out), ``floor`` (what it must exceed) and ``deviation`` (its standard deviation; None without repeats), and
    /// ``response``: harmonic FRFs, shape (order, frequency), complex; None of several inputs or outputs.
    #[getter]
    fn harmonics<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let known = self.result.harmonics.as_ref();
        known.map(|harmonics| dict(py, harmonics)).transpose()
    }
}

fn dict<'py>(py: Python<'py>, harmonics: &Harmonics) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let frequency_hz = Array1::from(harmonics.frequency_hz.clone());
    let response = harmonics.response.clone();
    dict.set_item("frequency_hz", c_ordered(py, frequency_hz))?;
    dict.set_item("orders", &harmonics.orders)?;
    dict.set_item("input", dict_of_amplitudes(py, &harmonics.input)?)?;
    dict.set_item("output", dict_of_amplitudes(py, &harmonics.output)?)?;
    dict.set_item("response", response.map(|response| c_ordered(py, response)))?;
    Ok(dict)
}

fn dict_of_amplitudes<'py>(
    py: Python<'py>,
    amplitudes: &Amplitudes,
) -> PyResult<Bound<'py, PyDict>> {
    let array = |array: &Array3<f64>| c_ordered(py, array.clone());
    let dict = PyDict::new(py);
    dict.set_item("amplitude", array(&amplitudes.amplitude))?;
    dict.set_item("floor", array(&amplitudes.floor))?;
    dict.set_item("deviation", amplitudes.deviation.as_ref().map(array))?;
    Ok(dict)
}

/// Harmonics from the dict that the attribute gives, of as many channels as the FRF has.
pub(crate) fn of_dict(given: &Bound<'_, PyAny>, frf: &Response) -> PyResult<Harmonics> {
    let List(orders) = item(given, "orders")?.extract::<List<usize>>()?;
    let frequency_hz = per_frequency("harmonics frequency_hz", &item(given, "frequency_hz")?)?;
    let amplitudes = |key, n_channels| {
        let shape = [n_channels, orders.len(), frequency_hz.len()];
        amplitudes(&item(given, key)?, shape)
    };
    Ok(Harmonics {
        input: amplitudes("input", frf.n_inputs())?,
        output: amplitudes("output", frf.n_outputs())?,
        response: optional(given, "response", of_orders)?,
        frequency_hz,
        orders,
    })
}

fn amplitudes(given: &Bound<'_, PyAny>, shape: [usize; 3]) -> PyResult<Amplitudes> {
    Ok(Amplitudes {
        amplitude: of_shape(&item(given, "amplitude")?, shape)?,
        floor: of_shape(&item(given, "floor")?, shape)?,
        deviation: optional(given, "deviation", |deviation| of_shape(deviation, shape))?,
    })
}

/// What a dict holds under a key.
fn item<'py>(given: &Bound<'py, PyAny>, key: &str) -> PyResult<Bound<'py, PyAny>> {
    let missing = |_| PyValueError::new_err(format!("harmonics has no entry {key:?}"));
    given.get_item(key).map_err(missing)
}

fn optional<'py, T>(
    given: &Bound<'py, PyAny>,
    key: &str,
    read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
) -> PyResult<Option<T>> {
    let found = item(given, key)?;
    (!found.is_none()).then(|| read(&found)).transpose()
}

fn of_orders(given: &Bound<'_, PyAny>) -> PyResult<Array2<Complex64>> {
    let response = complex("harmonics response", given, &[&["order", "frequency"]])?;
    copied(&response.as_array())
}

fn of_shape(given: &Bound<'_, PyAny>, shape: [usize; 3]) -> PyResult<Array3<f64>> {
    let array = real("harmonics", given, &[AMPLITUDE])?;
    let array = copied(&array.as_array())?;
    if array.shape() == shape {
        return Ok(array);
    }
    let found = array.shape();
    Err(PyValueError::new_err(format!(
        "harmonics have an array of shape {found:?}, needed {shape:?}, (channel, order, frequency)"
    )))
}
