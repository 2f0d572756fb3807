//! States of an arm: one or a batch of them, and the array of what follows from each.

use frfid_signals::SignalError;
use frfid_signals::room::room;
use ndarray::{ArrayD, Dimension, IxDyn};
use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

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
    let states = States::new(n_axes, arguments)?;
    let values = detached(py, || states.each(answer, &|| true, &of))?;
    Ok(c_ordered(py, values.map_err(error::signal)?))
}

/// What a function of states is given: an array for each argument, all of one shape.
pub(crate) struct States {
    n_axes: usize,
    arguments: Vec<ArrayD<f64>>,
}

impl States {
    /// The arguments by name, of shape (axis,) or (batch, axis).
    ///
    /// # Errors
    /// `ValueError` for shapes that do not fit and numbers that are not finite; `MemoryError`.
    pub(crate) fn new(
        n_axes: usize,
        arguments: &[(&'static str, &Bound<'_, PyAny>)],
    ) -> PyResult<Self> {
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
            check_finite(name, &state)?;
            states.push(state);
        }
        Ok(Self {
            n_axes,
            arguments: states,
        })
    }

    /// `of` at every state on the threads of the pool, in the order of the states: (*answer) or
    /// (batch, *answer).
    ///
    /// # Errors
    /// That of the first state that has one; [`SignalError::Memory`]; [`SignalError::Interrupted`]
    /// once `go_on` says no.
    pub(crate) fn each<T: Clone + Default + Send>(
        &self,
        answer: &[usize],
        go_on: &(dyn Fn() -> bool + Sync),
        of: impl Fn(&[&[f64]]) -> Result<Vec<T>, SignalError> + Sync,
    ) -> Result<ArrayD<T>, SignalError> {
        let shape = self.arguments[0].shape();
        let full = [&shape[..shape.len() - 1], answer].concat();
        let n_values = full.iter().product();
        let mut values = room(n_values)?;
        values.resize(n_values, T::default());
        let n_each = answer.iter().product::<usize>().max(1);
        let places = values.par_chunks_exact_mut(n_each).enumerate();
        let failed = places.find_map_first(|(state, place)| {
            if !go_on() {
                return Some(SignalError::Interrupted);
            }
            let found = of(&self.at(state));
            found.map(|found| place.clone_from_slice(&found)).err()
        });
        match failed {
            Some(error) => Err(error),
            None => Ok(ArrayD::from_shape_vec(full, values).expect("as many values as the shape")),
        }
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.arguments[0].is_empty()
    }

    /// The arguments of one state.
    fn at(&self, state: usize) -> Vec<&[f64]> {
        let rows = self.arguments.iter().map(|argument| {
            let values = argument.as_slice().expect("in standard layout");
            &values[state * self.n_axes..][..self.n_axes]
        });
        rows.collect()
    }
}

/// Refuses numbers that are not finite, and says where the first one is.
fn check_finite(name: &str, state: &ArrayD<f64>) -> PyResult<()> {
    if state.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    let mut values = state.indexed_iter();
    let first = values.find(|(_, value)| !value.is_finite());
    let found = first.map(|(place, value)| format!("{value} at {:?}", place.slice()));
    let found = found.unwrap_or_default();
    Err(PyValueError::new_err(format!(
        "{name} is {found}, needed finite numbers"
    )))
}
