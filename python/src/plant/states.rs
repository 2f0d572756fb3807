//! Functions of an arm's state, for one state or a batch of them.

use frfid_signals::SignalError;
use ndarray::{ArrayD, IxDyn};
use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, c_ordered, real};
use crate::error;
use crate::size::copied;
use crate::threads::detached;

const STATES: [Axes; 2] = [&["axis"], &["batch", "axis"]];

/// `of` at every state: the arguments, by name, are of shape (axis,) or (batch, axis), the answer
/// is of shape `answer` or (batch, *answer).
pub(crate) fn per_state<'py>(
    py: Python<'py>,
    n_axes: usize,
    arguments: &[(&'static str, &Bound<'py, PyAny>)],
    answer: &[usize],
    of: impl Fn(&[&[f64]]) -> Result<Vec<f64>, SignalError> + Sync,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let states = states(n_axes, arguments)?;
    let shape = states[0].shape();
    let rows: Vec<_> = states
        .iter()
        .map(|state| state.as_slice().expect("in standard layout").chunks(n_axes))
        .collect();
    let values = detached(py, || {
        let mut values = Vec::new();
        for state in 0..shape.iter().product::<usize>() / n_axes {
            let at_state = rows.iter().filter_map(|rows| rows.clone().nth(state));
            values.extend(of(&at_state.collect::<Vec<&[f64]>>())?);
        }
        Ok(values)
    })?;
    let full = [&shape[..shape.len() - 1], answer].concat();
    let values = ArrayD::from_shape_vec(full, values.map_err(error::signal)?);
    let values = values.map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(c_ordered(py, values))
}

/// The arguments in standard layout; all must be of one shape.
fn states(
    n_axes: usize,
    arguments: &[(&'static str, &Bound<'_, PyAny>)],
) -> PyResult<Vec<ArrayD<f64>>> {
    let mut states: Vec<ArrayD<f64>> = Vec::new();
    for (name, value) in arguments {
        let state = real::<IxDyn>(name, value, &STATES)?;
        let state = copied(&state.as_array())?;
        let shape = states.first().unwrap_or(&state).shape();
        if state.shape() != shape || shape.last() != Some(&n_axes) {
            let (found, first) = (state.shape(), arguments[0].0);
            return Err(PyValueError::new_err(format!(
                "{name} has shape {found:?}, needed ({n_axes}) or (batch, {n_axes}), the same as {first}"
            )));
        }
        states.push(state);
    }
    Ok(states)
}
