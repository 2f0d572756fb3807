//! Sizes of arguments: lists, views and copies that cannot be held are refused before room is made
//! for them.

use std::iter::zip;

use frfid_signals::room::room;
use ndarray::{Array, ArrayView, Dimension};
use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::conversion::FromPyObject;
use pyo3::exceptions::{PyOverflowError, PyValueError};
use pyo3::prelude::*;

use crate::error;

/// Most entries of a list, and most values that a view may show which are not in memory: half a
/// gigabyte of them, as many as the longest signal has samples.
const MOST: usize = 1 << 26;

/// A list, tuple, array or other sequence. Its length is looked at before room is made for it: a
/// `range` may be of any.
pub(crate) struct List<T>(pub Vec<T>);

impl<'a, 'py, T> FromPyObject<'a, 'py> for List<T>
where
    Vec<T>: FromPyObject<'a, 'py, Error = PyErr>,
{
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        check_length(&object)?;
        object.extract().map(Self)
    }
}

/// Refuses what says that it has more entries than can be held; what has no length is refused by
/// whoever needs a list.
pub(crate) fn check_length(object: &Bound<'_, PyAny>) -> PyResult<()> {
    let length = object.len();
    let is_held = match &length {
        Ok(length) => *length <= MOST,
        Err(error) => !error.is_instance_of::<PyOverflowError>(object.py()),
    };
    if is_held {
        return Ok(());
    }
    let length = length.map_or("too many".into(), |length| length.to_string());
    let kind = object.get_type().name()?;
    Err(PyValueError::new_err(format!(
        "a {kind} of {length} entries, needed at most 2^26"
    )))
}

/// Refuses a view that shows the same values over and over, as that of `numpy.broadcast_to`, where
/// a copy of it would be of another size than what is in memory; and one that shows none in more
/// rows than can be counted.
pub(crate) fn check_view(name: &str, view: &Bound<'_, PyUntypedArray>) -> PyResult<()> {
    let axes = || zip(view.shape(), view.strides()).map(|(&n, &stride)| (n.max(1) as f64, stride));
    let shown: f64 = axes().map(|(n, _)| n).product();
    let bytes: f64 = axes()
        .map(|(n, stride)| (n - 1.0) * stride.unsigned_abs() as f64)
        .sum();
    let in_memory = match view.is_empty() {
        true => 0.0,
        false => 1.0 + bytes / view.dtype().itemsize() as f64,
    };
    if shown <= MOST as f64 || shown <= in_memory {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} is a view that shows {shown} values of {in_memory} in memory, needed at most 2^26: give fewer"
    )))
}

/// A copy in standard layout.
///
/// # Errors
/// `MemoryError`.
pub(crate) fn copied<T: Clone, D: Dimension>(array: &ArrayView<'_, T, D>) -> PyResult<Array<T, D>> {
    let mut values = room(array.len()).map_err(error::signal)?;
    match array.as_slice() {
        Some(slice) => values.extend_from_slice(slice),
        None => values.extend(array.iter().cloned()),
    }
    let copy = Array::from_shape_vec(array.raw_dim(), values);
    Ok(copy.expect("as many values as the array"))
}
