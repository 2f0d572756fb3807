//! Warnings of the crates as Python warnings.

use std::ffi::CString;

use frfid_files::visible;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

/// Warns of each in the caller's line.
pub(crate) fn warn(py: Python<'_>, warnings: impl IntoIterator<Item = String>) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    for warning in warnings {
        let text = CString::new(visible(&warning))?;
        PyErr::warn(py, &category, &text, 1)?;
    }
    Ok(())
}
