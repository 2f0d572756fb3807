//! `frfid.Multisine`.

use frfid_signals::{Draw, GridDesign, LineGrid, Multisine as Signal, Profile, Waveform as _};
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyFloat;

use crate::array::c_ordered;
use crate::choice::{choice, to_python};
use crate::error;
use crate::interrupt::interruptible;
use crate::pickle::{Reduced, attributes};
use crate::signals::profile::{per_channel, points, profile};
use crate::size::List;

/// A multisine: sines on lines of the DFT of one period, with random phases.
///
/// ``Multisine.design`` finds the lines of a band; the constructor takes them as they are.
///
/// Parameters
/// ----------
/// sample_time_s : float
///     Sample time in s.
/// n_samples : int
///     Samples per period.
/// harmonics : sequence of int
///     Excited lines, multiples of the fundamental, rising.
/// detection : sequence of int, optional
///     Lines left out on purpose, to detect nonlinear distortion.
/// shape : float or list of (hz, value), optional
///     Amplitude over frequency; only ratios count.
/// phases : {"random", "low-crest"}, optional
///     Random phases, a new draw per realization, or phases chosen for a low crest factor.
///
/// Raises
/// ------
/// ValueError
///     For lines that do not rise or lie outside 1 to Nyquist.
#[pyclass(frozen, eq, module = "frfid")]
#[derive(PartialEq)]
pub(crate) struct Multisine {
    pub signal: Signal,
}

#[pymethods]
impl Multisine {
    #[new]
    #[pyo3(signature = (*, sample_time_s, n_samples, harmonics, detection = List(Vec::new()), shape = None, phases = "random"))]
    fn new(
        sample_time_s: f64,
        n_samples: usize,
        harmonics: List<usize>,
        detection: List<usize>,
        shape: Option<&Bound<'_, PyAny>>,
        phases: &str,
    ) -> PyResult<Self> {
        Self::on(
            LineGrid {
                sample_time_s,
                n_samples,
                excited: harmonics.0,
                detection: detection.0,
            },
            shape,
            phases,
        )
    }

    /// A multisine on the lines of a band, SK15 section 4.2.
    ///
    /// The period is at least ``1 / resolution_hz``: a power of two of samples of the analysis,
    /// whose sample time is ``1 / (5 high_hz)`` rounded down to a multiple of ``sample_time_s``.
    ///
    /// Parameters
    /// ----------
    /// low_hz, high_hz : float
    ///     Band in Hz; ``high_hz`` below Nyquist.
    /// sample_time_s : float
    ///     Sample time of the controller in s.
    /// resolution_hz : float
    ///     Largest spacing of the lines in Hz.
    /// n_lines : int, optional
    ///     Number of logarithmically spaced frequencies, each moved to the nearest line, duplicates
    ///     merged; every line of the band if left out.
    /// grid : {"odd", "full", "odd-random"}, optional
    ///     Odd multiples of the fundamental, all of them, or odd ones with one of four left out at
    ///     random.
    /// seed : int, optional
    ///     Seed for the lines left out by "odd-random".
    /// shape : float or list of (hz, value), optional
    ///     Amplitude over frequency; only ratios count.
    /// phases : {"random", "low-crest"}, optional
    ///     Random phases, a new draw per realization, or phases chosen for a low crest factor.
    ///
    /// Returns
    /// -------
    /// Multisine
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a parameter out of range, a band that reaches Nyquist or holds no line.
    #[staticmethod]
    #[pyo3(signature = (*, low_hz, high_hz, sample_time_s, resolution_hz, n_lines = None, grid = "odd", seed = 0,
                        shape = None, phases = "random"))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn design(
        low_hz: f64,
        high_hz: f64,
        sample_time_s: f64,
        resolution_hz: f64,
        n_lines: Option<usize>,
        grid: &str,
        seed: u64,
        shape: Option<&Bound<'_, PyAny>>,
        phases: &str,
    ) -> PyResult<Self> {
        let kind = choice("grid", grid)?;
        let design = GridDesign {
            low_hz,
            high_hz,
            sample_time_s,
            resolution_hz,
            n_lines,
            kind,
            seed,
        };
        Self::on(design.design().map_err(error::signal)?, shape, phases)
    }

    /// One period of every experiment and channel, SK15 (9).
    ///
    /// One factor over all channels and experiments makes the largest channel reach its peak; no
    /// channel exceeds its own. The same seed and realization give the same bytes.
    ///
    /// Parameters
    /// ----------
    /// seed : int
    ///     Seed of the random phases.
    /// n_inputs : int, optional
    ///     Number of inputs, and so of experiments.
    /// peak : float or sequence of float, optional
    ///     Largest value of each channel, between the samples too; one number stands for all.
    /// mimo : {"orthogonal", "sign-flip", "independent", "one-at-a-time", "all-at-once", "zippered"}, optional
    ///     Phases between channels and experiments: SK15 (9), SK15 (26), or (9) on top of random
    ///     phases for each channel.
    /// realization : int, optional
    ///     Number of the draw.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape (experiment, input, sample)
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For peaks that are not positive or not one per input.
    #[pyo3(signature = (*, seed, n_inputs = 1, peak = None, mimo = "orthogonal", realization = 0))]
    fn realize<'py>(
        &self,
        py: Python<'py>,
        seed: u64,
        n_inputs: usize,
        peak: Option<&Bound<'py, PyAny>>,
        mimo: &str,
        realization: usize,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let one = PyFloat::new(py, 1.0).into_any();
        let peak = per_channel("peak", peak.unwrap_or(&one), n_inputs)?;
        let draw = Draw {
            seed,
            realization,
            phasing: choice("mimo", mimo)?,
        };
        let signal = Signal {
            peak,
            ..self.signal.clone()
        };
        let drawn = interruptible(py, None, |progress| {
            signal.realize_while(&draw, &|| progress.goes_on())
        })?;
        let drawn = drawn.map_err(error::signal)?;
        Ok(c_ordered(py, drawn.signal))
    }

    /// Frequencies of the excited lines in Hz, shape (line,).
    #[getter]
    fn lines_hz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.signal.grid.lines_hz())
    }

    /// Excited lines as multiples of the fundamental, shape (line,).
    #[getter]
    fn harmonics<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        line_numbers(py, &self.signal.grid.excited)
    }

    /// Lines left out on purpose, shape (line,).
    #[getter]
    fn detection<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        line_numbers(py, &self.signal.grid.detection)
    }

    /// Spacing of the lines in Hz.
    #[getter]
    fn fundamental_hz(&self) -> f64 {
        self.signal.grid.fundamental_hz()
    }

    /// Length of the period in s.
    #[getter]
    fn period_s(&self) -> f64 {
        self.signal.grid.period_s()
    }

    /// Samples per period.
    #[getter]
    fn n_samples(&self) -> usize {
        self.signal.grid.n_samples
    }

    /// Sample time in s.
    #[getter]
    fn sample_time_s(&self) -> f64 {
        self.signal.grid.sample_time_s
    }

    /// Points (hz, value) of the amplitude over frequency.
    #[getter]
    fn shape(&self) -> Vec<(f64, f64)> {
        points(&self.signal.shape)
    }

    /// Choice of phases, "random" or "low-crest".
    #[getter]
    fn phases<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.signal.phases)
    }

    fn __repr__(&self) -> String {
        let grid = &self.signal.grid;
        let [low, high] = self.signal.band_hz();
        format!(
            "<frfid.Multisine: {} lines from {low:.4} Hz to {high:.4} Hz, period {} s = {} samples of {} s>",
            grid.excited.len(),
            grid.period_s(),
            grid.n_samples,
            grid.sample_time_s
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        attributes(
            slf,
            &[
                "sample_time_s",
                "n_samples",
                "harmonics",
                "detection",
                "shape",
                "phases",
            ],
        )
    }
}

impl Multisine {
    fn on(grid: LineGrid, shape: Option<&Bound<'_, PyAny>>, phases: &str) -> PyResult<Self> {
        grid.check().map_err(error::signal)?;
        let shape = shape.map_or_else(
            || Ok(Profile::constant(1.0)),
            |shape| profile("shape", shape),
        )?;
        shape.check().map_err(error::signal)?;
        Ok(Self {
            signal: Signal {
                grid,
                shape,
                phases: choice("phases", phases)?,
                peak: vec![1.0],
            },
        })
    }
}

fn line_numbers<'py>(py: Python<'py>, lines: &[usize]) -> Bound<'py, PyArray1<i64>> {
    PyArray1::from_iter(py, lines.iter().map(|&line| line as i64))
}
