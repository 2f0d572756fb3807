//! Results: what belongs to an FRF besides its numbers, `frfid.load`, and the picture.

use std::path::PathBuf;

use frfid_files::{ResultFile, read_result};
use frfid_signals::{Frf as Response, Uncertainty};
use pyo3::prelude::*;

use crate::error;
use crate::frf::matrix::Frf;
use crate::frf::parts::Arrays;
use crate::sources::Sources;
use crate::threads::detached;

impl Frf {
    /// A result with everything that belongs to it.
    pub(crate) fn of(result: ResultFile) -> Self {
        Self::read_from(result, Sources::default())
    }

    /// The same, made of files.
    pub(crate) fn read_from(result: ResultFile, sources: Sources) -> Self {
        Self {
            result,
            sources,
            arrays: Arrays::default(),
        }
    }
}

/// An FRF of which only the numbers are known: channels are numbered, their units empty.
impl From<Response> for Frf {
    fn from(frf: Response) -> Self {
        let (inputs, outputs) = (
            numbered("input", frf.n_inputs()),
            numbered("output", frf.n_outputs()),
        );
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self::of(ResultFile {
            provenance: [("frfid_version".to_owned(), version)].into(),
            ..ResultFile::between(frf, inputs, outputs)
        })
    }
}

/// Numbered names without units.
fn numbered(word: &str, count: usize) -> [Vec<String>; 2] {
    let names = (1..=count).map(|channel| format!("{word} {channel}"));
    [names.collect(), vec![String::new(); count]]
}

/// Reads a result: what ``Frf.save`` or ``frfid estimate`` wrote.
///
/// Parameters
/// ----------
/// path : str or path-like
///     The JSON file.
///
/// Returns
/// -------
/// Frf
///
/// Raises
/// ------
/// OSError
///     If the file cannot be read.
/// ValueError
///     If it is no result, or contradicts itself.
#[pyfunction]
pub(crate) fn load(py: Python<'_>, path: PathBuf) -> PyResult<Frf> {
    error::check_there(&path)?;
    let result = detached(py, || read_result(&path))?.map_err(error::file)?;
    Ok(Frf::read_from(result, Sources::of([path])))
}

/// Size, band and which variances are known, in one line.
pub(crate) fn described(frf: &Response) -> String {
    let hz = &frf.frequency_hz;
    let (low, high) = (
        hz.first().copied().unwrap_or(f64::NAN),
        hz.last().copied().unwrap_or(f64::NAN),
    );
    let measured = |known: &Option<Uncertainty>| if known.is_some() { "measured" } else { "None" };
    format!(
        "<frfid.Frf: {} outputs x {} inputs at {} frequencies from {low:.4} Hz to {high:.4} Hz, noise variance {}, \
         total variance {}>",
        frf.n_outputs(),
        frf.n_inputs(),
        hz.len(),
        measured(&frf.noise),
        measured(&frf.total)
    )
}
