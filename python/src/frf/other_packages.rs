//! An FRF in other hands: numpy, files, python-control, xarray, matplotlib, notebooks.

use std::path::PathBuf;

use frfid_files::write_result;
use frfid_report::result_figure;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;

use crate::choice::overwrite_if;
use crate::error;
use crate::frf::matrix::Frf;
use crate::threads::detached;

#[pymethods]
impl Frf {
    /// Part of the response: ``frf[key]`` is ``frf.response[key]``.
    fn __getitem__<'py>(
        slf: &Bound<'py, Self>,
        key: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.as_any().getattr("response")?.get_item(key)
    }

    /// The response, where numpy asks for an array.
    #[pyo3(signature = (dtype = None, copy = None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (numpy, response) = (py.import("numpy")?, self.response(py));
        match copy {
            None => numpy.call_method1("asarray", (response, dtype)), // numpy 1 knows no copy=None
            Some(copy) => numpy.call_method(
                "array",
                (response, dtype),
                Some(&[("copy", copy)].into_py_dict(py)?),
            ),
        }
    }

    /// Writes the result as JSON, first beside ``path`` and renamed when it is complete.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The file.
    /// overwrite : bool, optional
    ///     Whether a file of this name may be replaced.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If the file exists and may not be replaced, or is one that the FRF was made of.
    /// OSError
    ///     If it cannot be written.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn save(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        self.sources.check(&path)?;
        let overwrite = overwrite_if(overwrite);
        detached(py, || write_result(&path, overwrite, &self.result))?.map_err(error::file)
    }

    /// The FRF as ``control.FRD``: rad/s, response (output, input, frequency). It has no room for
    /// the uncertainty, nor for lines without an estimate: those are left out.
    fn to_control<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "to_control")
    }

    /// The FRF as ``xarray.Dataset`` with dimensions frequency, output and input; variances only
    /// where measured.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "to_xarray")
    }

    /// The Bode diagram as an SVG document, with the 95 % region of the largest variance that was
    /// measured.
    ///
    /// Returns
    /// -------
    /// str
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a frequency that is not above 0.
    fn to_svg(&self, py: Python<'_>) -> PyResult<String> {
        let figure = detached(py, || result_figure("G", &self.result))?;
        Ok(figure.map_err(error::report)?.svg())
    }

    /// Plots: ``frf.plot.bode()``, with matplotlib.
    #[getter]
    fn plot<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "Plot")
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python(slf, "repr_html")
    }
}

/// What needs another Python package is written in Python.
fn in_python<'py>(frf: &Bound<'py, Frf>, function: &str) -> PyResult<Bound<'py, PyAny>> {
    frf.py()
        .import("frfid._frf")?
        .call_method1(function, (frf,))
}
