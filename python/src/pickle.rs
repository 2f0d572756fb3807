//! Pickling and copying: an object is made again from its own attributes.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// What `__getnewargs_ex__` returns for a class whose constructor takes its attributes `names` as
/// keywords.
pub(crate) type NewArguments<'py> = (Bound<'py, PyTuple>, Bound<'py, PyDict>);

/// The attributes `names` of the object as keywords of its constructor.
pub(crate) fn attributes<'py, T>(
    object: &Bound<'py, T>,
    names: &[&str],
) -> PyResult<NewArguments<'py>> {
    let keywords = PyDict::new(object.py());
    for name in names {
        keywords.set_item(name, object.as_any().getattr(*name)?)?;
    }
    Ok((PyTuple::empty(object.py()), keywords))
}
