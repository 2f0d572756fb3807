//! `frfid.compare`.

use frfid_estimate::{CompareOptions, Comparison as Compared, Sides};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::choice::{choice, to_python};
use crate::error;
use crate::frf::matrix::Frf;
use crate::pickle::{Reduced, call};
use crate::threads::detached;

/// Two FRFs side by side; made by ``frfid.compare``. Printed, it is its verdict.
#[pyclass(frozen, module = "frfid")]
pub(crate) struct Comparison {
    compared: Compared,
    options: CompareOptions,
    frfs: Sides<Py<Frf>>,
}

#[pymethods]
impl Comparison {
    /// What the difference says about the machine, in a sentence; ``None`` if the FRFs agree within
    /// their noise, or nothing stands out.
    #[getter]
    fn verdict(&self) -> Option<String> {
        let judgement = self.compared.judgement;
        judgement.map(|judgement| judgement.verdict.to_string())
    }

    /// Entry (output, input) whose numbers the verdict gives; ``None`` where it speaks of all.
    #[getter]
    fn verdict_entry(&self) -> Option<(usize, usize)> {
        self.compared
            .judgement
            .and_then(|judgement| judgement.entry)
    }

    /// Whether they agree within their noise, by a test over all lines that they share; ``None``
    /// where that cannot be told.
    #[getter]
    fn agrees(&self) -> Option<bool> {
        self.compared.agreement.agrees()
    }

    /// The test as a dict: ``statistic``, by chance ``n_lines``, ``p_value``, the ``worst`` band; or
    /// the ``reason`` why it cannot be told.
    #[getter]
    fn agreement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.compared.agreement)
    }

    /// Band in Hz that both cover.
    #[getter]
    fn band_hz(&self) -> (f64, f64) {
        self.compared.band_hz
    }

    /// Lines of ``a`` and of ``b`` within that band of which nothing is known (NaN): they are left
    /// out.
    #[getter]
    fn unknown_lines(&self) -> (usize, usize) {
        let Sides { a, b } = self.compared.unknown_lines;
        (a, b)
    }

    /// Every entry of the matrix, outputs first, as a dict: ``changes`` holds each resonance and
    /// antiresonance of ``a``, what became of it in ``b``, and its shift, with standard deviations
    /// where the covariances are known.
    #[getter]
    fn entries<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.compared.entries)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, Self { options, frfs, .. }) = (slf.py(), slf.get());
        let keywords = PyDict::new(py);
        keywords.set_item("stronger", to_python(py, &options.stronger)?)?;
        keywords.set_item("prominence_db", options.prominence_db)?;
        keywords.set_item("largest_shift", options.largest_shift)?;
        let compare = py.import("frfid")?.getattr("compare")?;
        call(&compare, (&frfs.a, &frfs.b).into_pyobject(py)?, &keywords)
    }

    fn __str__(&self) -> String {
        let agrees = self.agrees() == Some(true);
        self.verdict().unwrap_or_else(|| {
            if agrees {
                self.compared.agreement.to_string()
            } else {
                "nothing stands out".to_owned()
            }
        })
    }

    fn __repr__(&self) -> String {
        let (low, high) = self.compared.band_hz;
        format!(
            "<frfid.Comparison from {low:.4} Hz to {high:.4} Hz: {}>",
            self.__str__()
        )
    }
}

/// Compares two FRFs: whether they agree within their noise, shift of resonances and antiresonances,
/// damping, and what that says about stiffness, inertia and friction.
///
/// Parameters
/// ----------
/// a, b : Frf
///     Of the same machine; the frequencies may differ.
/// stronger : {"a", "b"}, optional
///     Which of them was measured with the stronger excitation; without it a shift does not tell
///     growing from falling stiffness.
/// prominence_db : float, optional
///     Least height of a resonance, or depth of an antiresonance, in dB.
/// largest_shift : float, optional
///     Largest ratio of frequencies at which two resonances can be the same one.
///
/// Returns
/// -------
/// Comparison
///
/// Raises
/// ------
/// ValueError
///     For other numbers of channels, or fewer than three frequencies of either in the common band.
#[pyfunction]
#[pyo3(signature = (a, b, *, stronger = None, prominence_db = 3.0, largest_shift = 1.5))]
pub(crate) fn compare(
    py: Python<'_>,
    a: Bound<'_, Frf>,
    b: Bound<'_, Frf>,
    stronger: Option<&str>,
    prominence_db: f64,
    largest_shift: f64,
) -> PyResult<Comparison> {
    let stronger = stronger.map(|name| choice("stronger", name)).transpose()?;
    let options = CompareOptions {
        stronger,
        prominence_db,
        largest_shift,
    };
    let [of_a, of_b] = [&a, &b].map(|side| &side.get().result.frf);
    let compared = detached(py, || frfid_estimate::compare(of_a, of_b, &options))?;
    Ok(Comparison {
        compared: compared.map_err(error::estimate)?,
        options,
        frfs: Sides {
            a: a.unbind(),
            b: b.unbind(),
        },
    })
}
