//! Arguments of `Record`: channels of one run or of a batch, and events.

use frfid_signals::Event;
use ndarray::IxDyn;
use numpy::{PyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, c_ordered, real};
use crate::choice::from_python;
use crate::size::copied;

const SHAPES: [Axes; 2] = [&["channel", "sample"], &["batch", "channel", "sample"]];

/// The events of every run: a list, or a list of lists for a batch.
pub(super) fn events_of_runs(
    events: Option<&Bound<'_, PyAny>>,
    batch: bool,
    n_runs: usize,
) -> PyResult<Vec<Vec<Event>>> {
    let events: Vec<Vec<Event>> = match events {
        None => vec![Vec::new(); n_runs],
        Some(events) if batch => from_python("events", events)?,
        Some(events) => vec![from_python("events", events)?],
    };
    if events.len() != n_runs {
        let found = events.len();
        return Err(PyValueError::new_err(format!(
            "events of {found} runs, needed {n_runs}"
        )));
    }
    Ok(events)
}

/// A signal of as many runs as one of this shape.
pub(super) fn signal_like(
    name: &str,
    value: &Bound<'_, PyAny>,
    shape: &[usize],
) -> PyResult<Py<PyArrayDyn<f64>>> {
    let other = signal(name, value)?;
    let found = other.bind(value.py()).shape();
    let is_batch = shape.len() == 3;
    if found.len() != shape.len() || (is_batch && found[0] != shape[0]) {
        return Err(PyValueError::new_err(format!(
            "{name} has shape {found:?}, needed as many runs as u {shape:?}"
        )));
    }
    Ok(other)
}

pub(super) fn signal(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Py<PyArrayDyn<f64>>> {
    let array = real::<IxDyn>(name, value, &SHAPES)?;
    if array.is_c_contiguous() {
        Ok((*array).clone().unbind())
    } else {
        Ok(c_ordered(value.py(), copied(&array.as_array())?).unbind())
    }
}
