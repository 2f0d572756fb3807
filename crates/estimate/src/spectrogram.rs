//! Power spectral density over time (SK15 figure 3): a chirp as a line that rises, its harmonics as
//! lines above it.
//!
//! `S(f, t) = 2 |sum_k w_k x_k e^{-2 pi i f k T_s}|^2 T_s / sum_k w_k^2` over the window that
//! begins at sample t/T_s, w Hann's window; at 0 and at the Nyquist frequency without the 2. The
//! sum of S over all f, times their spacing, is the mean power of the windowed signal (Welch, IEEE
//! Trans. Audio Electroacoustics 15 (1967) 70).

use std::f64::consts::TAU;
use std::iter::zip;

use frfid_signals::check_finite;
use frfid_signals::checks::{positive, require};
use frfid_signals::room::room_for;
use frfid_transforms::TransformPlanner;
use ndarray::{Array2, ArrayView1, Axis, s};

use crate::error::EstimateError;

/// Windows of a spectrogram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrogramOptions {
    /// Length of a window in s; frequencies are its inverse apart.
    pub window_s: f64,
    /// Time from one window to the next in s; half a window or less sees every sample alike.
    pub step_s: f64,
}

impl Default for SpectrogramOptions {
    fn default() -> Self {
        Self {
            window_s: 1.0,
            step_s: 0.1,
        }
    }
}

/// One-sided power spectral density of one channel over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrogram {
    /// Frequencies in Hz, from 0 to the Nyquist frequency.
    pub frequency_hz: Vec<f64>,
    /// Centres of the windows in s after the first sample.
    pub time_s: Vec<f64>,
    /// Density in squared units of the signal per Hz, `(frequency, time)`.
    pub density: Array2<f64>,
}

/// Spectrogram of one channel.
///
/// # Errors
/// [`frfid_signals::SignalError`] for samples that are not finite, times that are not above 0, a
/// window of fewer than four samples or longer than the signal, or more windows than can be held.
pub fn spectrogram(
    signal: ArrayView1<f64>,
    sample_time_s: f64,
    options: &SpectrogramOptions,
) -> Result<Spectrogram, EstimateError> {
    check_finite("signal", signal.insert_axis(Axis(0)))?;
    let length = window_samples(signal.len(), sample_time_s, options)?;
    let step = (options.step_s / sample_time_s).round().max(1.0) as usize;
    let starts: Vec<usize> = (0..=signal.len() - length).step_by(step).collect();
    let quantity = "number of values of the spectrogram";
    room_for("step_s", quantity, &[length / 2 + 1, starts.len()])?;
    let hz = |bin: usize| bin as f64 / (length as f64 * sample_time_s);
    let centre_s = |&start: &usize| (start as f64 + 0.5 * length as f64) * sample_time_s;
    Ok(Spectrogram {
        frequency_hz: (0..=length / 2).map(hz).collect(),
        time_s: starts.iter().map(centre_s).collect(),
        density: densities(signal, &starts, length, sample_time_s),
    })
}

/// Density of the windows of `length` samples that begin at `starts`, `(frequency, window)`.
fn densities(
    signal: ArrayView1<f64>,
    starts: &[usize],
    length: usize,
    sample_time_s: f64,
) -> Array2<f64> {
    let window = hann(length);
    let scale = sample_time_s / window.iter().map(|w| w * w).sum::<f64>();
    let fft = TransformPlanner::default().forward(length);
    let (mut samples, mut bins) = (fft.make_input_vec(), fft.make_output_vec());
    let mut density = Array2::zeros((bins.len(), starts.len()));
    for (&start, mut column) in zip(starts, density.columns_mut()) {
        let piece = signal.slice(s![start..start + length]);
        for ((sample, w), x) in zip(zip(&mut samples, &window), piece) {
            *sample = w * x;
        }
        fft.process(&mut samples, &mut bins)
            .expect("the plan made the buffers, so their lengths fit");
        for (bin, (value, spectrum)) in zip(&mut column, &bins).enumerate() {
            *value = n_sides(bin, length) * scale * spectrum.norm_sqr();
        }
    }
    density
}

/// Length of a window in samples; refuses times that are not above 0 and windows that do not fit.
fn window_samples(
    n_samples: usize,
    sample_time_s: f64,
    options: &SpectrogramOptions,
) -> Result<usize, EstimateError> {
    positive("sample_time_s", sample_time_s)?;
    positive("window_s", options.window_s)?;
    positive("step_s", options.step_s)?;
    let length = (options.window_s / sample_time_s).round();
    let fits = (4.0..=n_samples as f64).contains(&length);
    let needed = "four samples or more, and no longer than the signal";
    require("window_s", options.window_s, fits, needed)?;
    Ok(length as usize)
}

/// Hann's window.
fn hann(length: usize) -> Vec<f64> {
    (0..length)
        .map(|k| 0.5 - 0.5 * (TAU * k as f64 / length as f64).cos())
        .collect()
}

/// Sides of the spectrum that a bin stands for.
fn n_sides(bin: usize, length: usize) -> f64 {
    if bin == 0 || 2 * bin == length {
        1.0
    } else {
        2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::random::{normal, stream};
    use ndarray::Array1;

    const SAMPLE_TIME_S: f64 = 1e-2;

    fn of(signal: &Array1<f64>, window_s: f64, step_s: f64) -> Result<Spectrogram, EstimateError> {
        spectrogram(
            signal.view(),
            SAMPLE_TIME_S,
            &SpectrogramOptions { window_s, step_s },
        )
    }

    #[test]
    fn the_density_integrates_to_the_power_of_the_windowed_signal() {
        let mut rng = stream(1, "spectrogram", &[]);
        let signal =
            Array1::from_shape_fn(1000, |k| normal(&mut rng) + (k as f64 * 0.3).sin() + 2.0);
        for length in [100, 101] {
            let spectrogram = of(&signal, f64::from(length) * SAMPLE_TIME_S, 0.5).expect("sound");
            let spacing_hz = spectrogram.frequency_hz[1];
            assert!((spacing_hz - 1.0 / (f64::from(length) * SAMPLE_TIME_S)).abs() < 1e-12);
            for (column, density) in spectrogram.density.columns().into_iter().enumerate() {
                let hann = |k: i32| 0.5 - 0.5 * (TAU * f64::from(k) / f64::from(length)).cos();
                let weighted: f64 = (0..length)
                    .map(|k| (hann(k) * signal[50 * column + k as usize]).powi(2))
                    .sum();
                let power = weighted / (0..length).map(|k| hann(k).powi(2)).sum::<f64>();
                assert!((density.sum() * spacing_hz / power - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_sine_has_its_power_at_its_frequency_and_time() {
        let sine = |k: usize| {
            if k < 1000 {
                0.0
            } else {
                3.0 * (TAU * 7.0 * k as f64 * SAMPLE_TIME_S).sin()
            }
        };
        let spectrogram = of(&Array1::from_shape_fn(3000, sine), 2.0, 0.25).expect("sound");
        let column = spectrogram
            .time_s
            .iter()
            .position(|&time_s| time_s > 20.0)
            .expect("30 s");
        let around: f64 =
            spectrogram.density.slice(s![12..=16, column]).sum() * spectrogram.frequency_hz[1];
        assert!((around / 4.5 - 1.0).abs() < 1e-6, "{around}");
        assert_eq!(spectrogram.density.column(0).sum(), 0.0);
        assert_eq!(
            (spectrogram.time_s[0], spectrogram.time_s.len()),
            (1.0, 113)
        );
    }

    #[test]
    fn windows_that_do_not_fit_are_refused() {
        let signal = Array1::zeros(100);
        for (window_s, step_s, said) in [
            (0.03, 0.1, "window_s is 0.03,"),
            (1.01, 0.1, "window_s is 1.01,"),
            (0.5, 0.0, "step_s is 0,"),
            (f64::NAN, 0.1, "window_s is NaN,"),
            (0.5, f64::INFINITY, "step_s is inf,"),
        ] {
            let found = refusal(of(&signal, window_s, step_s));
            assert!(found.starts_with(said), "{window_s} {step_s}: {found}");
        }
        let said = refusal(of(&Array1::from_elem(100, f64::NAN), 0.5, 0.1));
        assert!(said.starts_with("signal: 100 samples are NaN"), "{said}");
    }

    #[test]
    fn more_than_can_be_held_is_refused() {
        let signal = Array1::zeros(1 << 16);
        let said = refusal(of(&signal, 327.68, 1e-9)); // half of the signal, from every sample
        assert!(
            said.starts_with("number of values of the spectrogram is 536920065"),
            "{said}"
        );
    }
}
