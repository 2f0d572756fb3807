//! Pickling and copying: an object is made again by a call, by every protocol.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// What `__reduce__` returns: a callable, and its arguments.
pub(crate) type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// A call of the class, whose constructor takes the attributes `names` of the object as keywords.
pub(crate) fn attributes<'py, T>(object: &Bound<'py, T>, names: &[&str]) -> PyResult<Reduced<'py>> {
    let keywords = PyDict::new(object.py());
    for name in names {
        keywords.set_item(name, object.as_any().getattr(*name)?)?;
    }
    call(
        object.as_any().get_type().as_any(),
        PyTuple::empty(object.py()),
        &keywords,
    )
}

/// A call with keywords: they are bound to the callable, since old protocols know none.
pub(crate) fn call<'py>(
    callable: &Bound<'py, PyAny>,
    arguments: Bound<'py, PyTuple>,
    keywords: &Bound<'py, PyDict>,
) -> PyResult<Reduced<'py>> {
    let functools = callable.py().import("functools")?;
    let bound = functools.call_method("partial", (callable,), Some(keywords))?;
    Ok((bound, arguments))
}
