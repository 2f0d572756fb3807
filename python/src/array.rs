//! Arrays in and out: any real array in, without a copy where it is already float64; C-ordered
//! numpy arrays out.

use ndarray::{Array, Dimension};
use num_complex::Complex64;
use numpy::{
    Element, IntoPyArray, PyArray, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyList, PyTuple};

use crate::size::{check_length, check_view};

/// Names of the axes of one shape an argument may have.
pub(crate) type Axes = &'static [&'static str];

/// The argument `name` as float64, of one of the `shapes`: integers and float32 are converted,
/// anything else (complex, text, ragged lists, another number of axes) is a `ValueError` that tells
/// what was found and needed.
pub(crate) fn real<'py, D: Dimension>(
    name: &str,
    value: &Bound<'py, PyAny>,
    shapes: &[Axes],
) -> PyResult<PyReadonlyArray<'py, f64, D>> {
    numbers(name, value, shapes, "iuf", "real numbers")
}

/// The argument `name` as complex128, of one of the `shapes`.
pub(crate) fn complex<'py, D: Dimension>(
    name: &str,
    value: &Bound<'py, PyAny>,
    shapes: &[Axes],
) -> PyResult<PyReadonlyArray<'py, Complex64, D>> {
    numbers(name, value, shapes, "iufc", "complex numbers")
}

fn numbers<'py, T: Element, D: Dimension>(
    name: &str,
    value: &Bound<'py, PyAny>,
    shapes: &[Axes],
    kinds: &str,
    words: &str,
) -> PyResult<PyReadonlyArray<'py, T, D>> {
    let numpy = value.py().import("numpy")?;
    let found = regular(&numpy, name, value, &|| needed(words, shapes))?;
    let kind = char::from(found.dtype().kind());
    if !kinds.contains(kind) || shapes.iter().all(|axes| axes.len() != found.ndim()) {
        let is_channel = found.ndim() == 1 && shapes.iter().any(|axes| axes.len() == 2);
        let hint = if is_channel {
            format!("; a single channel is {name}[None, :]")
        } else {
            String::new()
        };
        return Err(PyValueError::new_err(format!(
            "{name} has dtype {} and shape {}, {}{hint}",
            found.dtype(),
            found.getattr("shape")?,
            needed(words, shapes),
        )));
    }
    native(&numpy, &found)
}

/// The argument as an array of numpy that can be held, without a mask: what a list holds, and what
/// an object says that it is.
fn regular<'py>(
    numpy: &Bound<'py, PyModule>,
    name: &str,
    value: &Bound<'py, PyAny>,
    needed: &dyn Fn() -> String,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    check_length(value)?;
    refuse_masked_items(numpy, name, value)?;
    let found = numpy
        .call_method1("asanyarray", (value,))
        .map_err(|error| {
            if error.is_instance_of::<PyMemoryError>(numpy.py()) {
                return error;
            }
            PyValueError::new_err(format!(
                "{name} is no regular array ({error}), {}",
                needed()
            ))
        })?;
    refuse_masked(numpy, name, &found)?;
    let found = numpy.call_method1("asarray", (found,))?;
    let found = found.cast_into::<PyUntypedArray>()?;
    check_view(name, &found)?;
    Ok(found)
}

/// Refuses masked arrays in lists, and objects in them that say that they are such.
fn refuse_masked_items(
    numpy: &Bound<'_, PyModule>,
    name: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<()> {
    if !(value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>()) {
        return Ok(());
    }
    for item in value.try_iter()? {
        let item = item?;
        if item.hasattr("__array__")? {
            refuse_masked(numpy, name, &numpy.call_method1("asanyarray", (item,))?)?;
        } else {
            refuse_masked_items(numpy, name, &item)?;
        }
    }
    Ok(())
}

/// Refuses masked entries: `numpy.asarray` would take what stands below the mask.
fn refuse_masked(
    numpy: &Bound<'_, PyModule>,
    name: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let masked = numpy.getattr("ma")?;
    if !value.is_instance(&masked.getattr("MaskedArray")?)? {
        return Ok(());
    }
    let count: usize = masked.call_method1("count_masked", (value,))?.extract()?;
    if count == 0 {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} is a masked array with {count} masked entries, needed numbers everywhere: leave out \
         the periods that hold them, or put numbers in their place with {name}.filled(...)"
    )))
}

fn needed(words: &str, shapes: &[Axes]) -> String {
    let shapes: Vec<String> = shapes
        .iter()
        .map(|axes| format!("({})", axes.join(", ")))
        .collect();
    format!("needed {words} of shape {}", shapes.join(" or "))
}

/// The array in the machine's own numbers, aligned.
fn native<'py, T: Element, D: Dimension>(
    numpy: &Bound<'py, PyModule>,
    found: &Bound<'py, PyUntypedArray>,
) -> PyResult<PyReadonlyArray<'py, T, D>> {
    let native = numpy.call_method1("require", (found, numpy::dtype::<T>(numpy.py()), "A"))?;
    let native = native.cast_into::<PyArray<T, D>>()?;
    // rust-numpy divides strides by the item size: a field of a packed structured array would be
    // read from the wrong places
    let is_whole = |stride: &isize| stride.unsigned_abs().is_multiple_of(size_of::<T>());
    if native.strides().iter().all(is_whole) {
        return Ok(native.try_readonly()?);
    }
    let packed = numpy.call_method1("ascontiguousarray", (native,))?;
    Ok(packed.cast_into::<PyArray<T, D>>()?.try_readonly()?)
}

/// A new C-ordered numpy array; the memory is handed over, not copied, if it is in this order
/// already.
pub(crate) fn c_ordered<T: Element + Clone, D: Dimension>(
    py: Python<'_>,
    array: Array<T, D>,
) -> Bound<'_, PyArray<T, D>> {
    let ordered = if array.is_standard_layout() {
        array
    } else {
        array.as_standard_layout().into_owned()
    };
    ordered.into_pyarray(py)
}

/// A numpy array, or its absence, made when it is first asked for; read-only and the same object
/// from then on.
pub(crate) struct Shared(PyOnceLock<Option<Py<PyAny>>>);

impl Default for Shared {
    fn default() -> Self {
        Self(PyOnceLock::new())
    }
}

impl Shared {
    /// The array, from `make` the first time.
    pub(crate) fn get<'py, T: Element + Clone, D: Dimension>(
        &self,
        py: Python<'py>,
        make: impl FnOnce() -> Option<Array<T, D>>,
    ) -> Option<Bound<'py, PyAny>> {
        let made = || {
            Some(
                c_ordered(py, make()?)
                    .readwrite()
                    .make_nonwriteable()
                    .as_any()
                    .clone()
                    .unbind(),
            )
        };
        Some(self.0.get_or_init(py, made).as_ref()?.bind(py).clone())
    }
}
