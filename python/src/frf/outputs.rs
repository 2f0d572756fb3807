//! An FRF in files for other tools and for the browser: the bytes of `frfid export` and `frfid
//! report`.

use std::path::{Path, PathBuf};

use frfid_files::{EXPORTS, write_bytes};
use frfid_report::result_page;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::choice::overwrite_if;
use crate::error;
use crate::frf::matrix::Frf;
use crate::threads::detached;

#[pymethods]
impl Frf {
    /// Writes a CSV as ``frfid export`` does: a row for each frequency, a column for each part of
    /// each entry.
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
    fn to_csv(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        self.export(py, "csv", &path, overwrite)
    }

    /// Writes an NPZ as ``frfid export`` does: ``frequency_hz``, shape (frequency,), ``response``,
    /// shape (frequency, output, input), variances and covariances where measured, names and units.
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
    fn to_npz(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        self.export(py, "npz", &path, overwrite)
    }

    /// Writes a MAT file of level 5 as ``frfid export`` does, for MATLAB and Octave: the arrays of
    /// ``to_npz``, lists as columns, names and units as cell arrays.
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
    fn to_mat(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        self.export(py, "mat", &path, overwrite)
    }

    /// Writes a universal file as ``frfid export`` does, for programs of modal analysis: a dataset
    /// 58 for each entry, and one for each of its variances. Lines without an estimate are left out.
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
    /// ValueError
    ///     For frequencies that agree in the six digits a UFF has, or nothing but unknown lines.
    #[pyo3(signature = (path, *, overwrite = false))]
    fn to_uff(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> PyResult<()> {
        self.export(py, "uff", &path, overwrite)
    }

    /// Writes the page for the browser that ``frfid report`` makes of a result: Bode diagrams,
    /// verdicts, checks and provenance.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The file.
    /// title : str, optional
    ///     Title of the page, and name of the curve; the name of the file without its ending.
    /// note : str, optional
    ///     A paragraph above the diagram.
    /// overwrite : bool, optional
    ///     Whether a file of this name may be replaced.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If the file exists and may not be replaced, or is one that the FRF was made of.
    /// OSError
    ///     If it cannot be written.
    /// ValueError
    ///     For a frequency that is not above 0.
    #[pyo3(signature = (path, title = None, note = None, *, overwrite = false))]
    fn report(
        &self,
        py: Python<'_>,
        path: PathBuf,
        title: Option<String>,
        note: Option<String>,
        overwrite: bool,
    ) -> PyResult<()> {
        self.sources.check(&path)?;
        let stem = || path.file_stem().unwrap_or_default().to_string_lossy();
        let title = title.unwrap_or_else(|| stem().into_owned());
        let notes = note.into_iter().collect();
        let page = detached(py, || result_page(&title, &self.result, notes))?;
        let page = page.map_err(error::report)?;
        detached(py, || {
            write_bytes(&path, overwrite_if(overwrite), page.as_bytes())
        })?
        .map_err(error::file)
    }
}

impl Frf {
    /// Writes the export of that name.
    fn export(&self, py: Python<'_>, name: &str, path: &Path, overwrite: bool) -> PyResult<()> {
        self.sources.check(path)?;
        let export = EXPORTS.iter().find(|export| export.name == name);
        let export = export.ok_or_else(|| PyValueError::new_err(format!("no export {name}")))?;
        detached(py, || {
            (export.write)(path, overwrite_if(overwrite), &self.result)
        })?
        .map_err(error::file)
    }
}
