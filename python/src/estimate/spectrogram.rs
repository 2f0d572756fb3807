//! `frfid.spectrogram`.

use frfid_estimate::{SpectrogramOptions, spectrogram as of_channel};
use frfid_signals::room::room;
use ndarray::{Array1, Array3, Axis, Ix2};
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;

use crate::array::{c_ordered, real};
use crate::error;
use crate::threads::detached;

/// Frequencies, times and densities, as scipy returns them.
type Density<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray3<f64>>,
);

/// One-sided power spectral density over time (SK15 figure 3), by Hann windows.
///
/// Parameters
/// ----------
/// signal : array_like, shape (channel, sample)
///     The signal.
/// sample_time_s : float
///     Sample time in s.
/// window_s : float, optional
///     Length of a window in s; frequencies are its inverse apart.
/// step_s : float, optional
///     Time from one window to the next in s.
///
/// Returns
/// -------
/// frequency_hz : ndarray, float64, shape (frequency,)
///     From 0 to the Nyquist frequency.
/// time_s : ndarray, float64, shape (time,)
///     Centres of the windows after the first sample.
/// density : ndarray, float64, shape (channel, frequency, time)
///     In squared units of the signal per Hz.
///
/// Raises
/// ------
/// ValueError
///     For samples that are not finite, or a window that does not fit the signal.
#[pyfunction]
#[pyo3(signature = (signal, *, sample_time_s, window_s = 1.0, step_s = 0.1))]
pub(crate) fn spectrogram<'py>(
    py: Python<'py>,
    signal: &Bound<'py, PyAny>,
    sample_time_s: f64,
    window_s: f64,
    step_s: f64,
) -> PyResult<Density<'py>> {
    let signal = real::<Ix2>("signal", signal, &[&["channel", "sample"]])?;
    let signal = signal.as_array();
    let options = SpectrogramOptions { window_s, step_s };
    let channels = detached(py, || {
        signal
            .rows()
            .into_iter()
            .map(|row| of_channel(row, sample_time_s, &options))
            .collect::<Result<Vec<_>, _>>()
    })?;
    let channels = channels.map_err(error::estimate)?;
    let (frequency_hz, time_s) = channels.first().map_or_else(Default::default, |first| {
        (first.frequency_hz.clone(), first.time_s.clone())
    });
    let n_values = channels.len() * frequency_hz.len() * time_s.len();
    room::<f64>(n_values).map_err(error::signal)?;
    let mut density = Array3::zeros((channels.len(), frequency_hz.len(), time_s.len()));
    density
        .axis_iter_mut(Axis(0))
        .zip(&channels)
        .for_each(|(mut to, channel)| to.assign(&channel.density));
    Ok((
        c_ordered(py, Array1::from(frequency_hz)),
        c_ordered(py, Array1::from(time_s)),
        c_ordered(py, density),
    ))
}
