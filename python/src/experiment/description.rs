//! `frfid.Experiment`: the workflow of the command line without its files.

use std::path::PathBuf;

use frfid_experiment::{Experiment as Description, TomlText};
use pyo3::prelude::*;

use crate::error;
use crate::experiment::plan::Plan;

/// An experiment as its TOML file describes it; made by ``Experiment.load``.
#[pyclass(frozen, eq, module = "frfid")]
#[derive(PartialEq)]
pub(crate) struct Experiment {
    pub(super) description: Description,
}

#[pymethods]
impl Experiment {
    /// Reads and checks ``experiment.toml``.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The file; a robot file that it names is looked up beside it.
    ///
    /// Returns
    /// -------
    /// Experiment
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     With file, line and caret of what is wrong in it.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        error::check_there(&path)?;
        Ok(Self {
            description: Description::load(&path).map_err(error::config)?,
        })
    }

    /// An experiment from the text of a file that stands alone, as ``to_toml`` writes it.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     TOML.
    ///
    /// Returns
    /// -------
    /// Experiment
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     As ``load``, and if it names another file.
    #[staticmethod]
    fn from_toml(text: String) -> PyResult<Self> {
        let description = Description::travelled(TomlText::new("text of an experiment", text));
        Ok(Self {
            description: description.map_err(error::config)?,
        })
    }

    /// The plan of all runs.
    fn design(&self) -> Plan {
        Plan::from(self.description.clone())
    }

    /// The description as one TOML text that stands alone.
    fn to_toml(&self) -> String {
        self.description.to_toml()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let from_toml = slf.get_type().getattr("from_toml")?;
        Ok((from_toml, (slf.get().to_toml(),)))
    }

    fn __repr__(&self) -> String {
        format!(
            "<frfid.Experiment: {}, {} runs>",
            self.description.text().name,
            self.description.plan().n_runs()
        )
    }
}
