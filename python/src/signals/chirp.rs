//! `frfid.Chirp`.

use frfid_signals::{Chirp as Signal, Profile};
use numpy::PyArray3;
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::choice::choice;
use crate::error;
use crate::pickle::{Reduced, attributes};
use crate::signals::profile::{points, profiles};
use crate::threads::detached;

/// A sine whose frequency rises exponentially from ``low_hz`` to ``high_hz``, SK15 (15) and (16).
///
/// Parameters
/// ----------
/// low_hz, high_hz : float
///     Frequencies at start and end in Hz.
/// duration_s : float
///     Length of the sweep in s, without the tail.
/// amplitude : float, list of (hz, value), or a list of these per channel, optional
///     Amplitude over frequency, constant outside the points and smooth between them.
/// fade_s : float, optional
///     Length of the half-cosine fades at both ends in s.
/// tail_s : float, optional
///     Rest after the sweep in s.
///
/// Raises
/// ------
/// ValueError
///     For a parameter out of range.
#[pyclass(frozen, eq, module = "frfid")]
#[derive(PartialEq)]
pub(crate) struct Chirp {
    pub signal: Signal,
}

#[pymethods]
impl Chirp {
    #[new]
    #[pyo3(signature = (*, low_hz, high_hz, duration_s, amplitude = None, fade_s = 0.0, tail_s = 0.0))]
    fn new(
        low_hz: f64,
        high_hz: f64,
        duration_s: f64,
        amplitude: Option<&Bound<'_, PyAny>>,
        fade_s: f64,
        tail_s: f64,
    ) -> PyResult<Self> {
        let amplitude = amplitude.map_or_else(
            || Ok(vec![Profile::constant(1.0)]),
            |amplitude| profiles("amplitude", amplitude),
        )?;
        let signal = Signal {
            low_hz,
            high_hz,
            duration_s,
            amplitude,
            fade_s,
            tail_s,
        };
        signal.check().map_err(error::signal)?;
        Ok(Self { signal })
    }

    /// The chirp of every experiment and channel, tail included.
    ///
    /// Parameters
    /// ----------
    /// sample_time_s : float
    ///     Sample time in s.
    /// n_inputs : int, optional
    ///     Number of inputs, and so of experiments.
    /// mimo : {"sign-flip", "orthogonal"}, optional
    ///     Phases between channels and experiments: SK15 (26) or (9).
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape (experiment, input, sample)
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a band that reaches Nyquist, or neither one amplitude nor one per input.
    #[pyo3(signature = (*, sample_time_s, n_inputs = 1, mimo = "sign-flip"))]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        sample_time_s: f64,
        n_inputs: usize,
        mimo: &str,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let phasing = choice("mimo", mimo)?;
        let sampled = detached(py, || self.signal.sample(sample_time_s, n_inputs, phasing))?
            .map_err(error::signal)?;
        Ok(c_ordered(py, sampled))
    }

    /// Instantaneous frequency in Hz at ``time_s`` after the start.
    fn frequency_at(&self, time_s: f64) -> f64 {
        self.signal.frequency_at(time_s)
    }

    /// Time in s after the start at which the chirp passes ``hz``.
    fn instant_of(&self, hz: f64) -> f64 {
        self.signal.instant_of(hz)
    }

    /// Frequency at the start in Hz.
    #[getter]
    fn low_hz(&self) -> f64 {
        self.signal.low_hz
    }

    /// Frequency at the end in Hz.
    #[getter]
    fn high_hz(&self) -> f64 {
        self.signal.high_hz
    }

    /// Length of the sweep in s.
    #[getter]
    fn duration_s(&self) -> f64 {
        self.signal.duration_s
    }

    /// Points (hz, value) of the amplitude: one list for all channels, or one for each.
    #[getter]
    fn amplitude(&self) -> Vec<Vec<(f64, f64)>> {
        self.signal.amplitude.iter().map(points).collect()
    }

    /// Length of the fades in s.
    #[getter]
    fn fade_s(&self) -> f64 {
        self.signal.fade_s
    }

    /// Rest after the sweep in s.
    #[getter]
    fn tail_s(&self) -> f64 {
        self.signal.tail_s
    }

    fn __repr__(&self) -> String {
        let Signal {
            low_hz,
            high_hz,
            duration_s,
            tail_s,
            ..
        } = self.signal;
        format!("<frfid.Chirp: {low_hz} Hz to {high_hz} Hz in {duration_s} s, tail {tail_s} s>")
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        attributes(
            slf,
            &[
                "low_hz",
                "high_hz",
                "duration_s",
                "amplitude",
                "fade_s",
                "tail_s",
            ],
        )
    }
}
