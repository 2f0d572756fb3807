//! Loading of what the calls need from Python and numpy: all of it at the import of the package.
//!
//! What is looked up at the first use, one thread may be looking up while another forks: the child
//! would wait for it for ever. And a Ctrl-C that comes then would panic.

use std::path::Path;
use std::thread;

use num_complex::Complex64;
use numpy::{PyArray1, PyArrayMethods, dtype};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PySequence;

/// Modules that the calls use. `numpy.ma` is not part of the import of numpy.
const MODULES: [&str; 6] = [
    "numpy",
    "numpy.ma",
    "functools",
    "inspect",
    "json",
    "pathlib",
];

/// Loads modules, and the tables of numpy's C interface.
///
/// # Errors
/// What the imports raise; `OSError` where the system refuses a thread.
pub(crate) fn load(py: Python<'_>) -> PyResult<()> {
    MODULES
        .iter()
        .try_for_each(|name| py.import(name).map(drop))?;
    py.detach(|| {
        thread::scope(|scope| {
            // signals reach the main thread alone, and numpy's interface does not bear one
            let touching = thread::Builder::new().spawn_scoped(scope, || Python::attach(touch))?;
            touching.join().unwrap_or_else(|_| {
                Err(PyOSError::new_err(
                    "the interface of numpy cannot be loaded",
                ))
            })
        })
    })
}

/// Uses everything once that is looked up at its first use.
fn touch(py: Python<'_>) -> PyResult<()> {
    let array = PyArray1::from_vec(py, vec![0.0]);
    array.try_readwrite()?;
    dtype::<Complex64>(py);
    Path::new("").into_pyobject(py)?;
    let _ = array.cast::<PySequence>(); // whether it is one does not matter
    Ok(())
}
