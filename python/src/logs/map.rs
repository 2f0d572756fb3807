//! Log maps from Python: a dict, or the path of a TOML file.

use std::path::PathBuf;

use frfid_experiment::TomlText;
use frfid_files::LogMap;
use pyo3::prelude::*;

use crate::choice::from_python;
use crate::error;
use crate::size::List;

/// The map that is meant, checked as that of a file.
pub(crate) fn log_map(map: &Bound<'_, PyAny>) -> PyResult<LogMap> {
    match map.extract::<PathBuf>() {
        Ok(path) => {
            error::check_there(&path)?;
            let text = TomlText::read(&path).map_err(error::config)?;
            text.parse().map_err(error::config)
        }
        Err(_) => from_python("map", map),
    }
}

/// One path or several.
pub(crate) fn paths(paths: &Bound<'_, PyAny>) -> PyResult<Vec<PathBuf>> {
    match paths.extract::<PathBuf>() {
        Ok(path) => Ok(vec![path]),
        Err(_) => Ok(paths.extract::<List<PathBuf>>()?.0),
    }
}
