//! Figures 3, 6 and 7: signals of the experiments.

use frfid_estimate::{SpectrogramOptions, harmonic_levels, spectrogram as spectrogram_of};
use frfid_report::{Figure, Spectrogram, TimePanel, Trace, spectrogram, time_series};
use frfid_signals::{Chirp, Waveform as _};
use ndarray::{Array1, ArrayView1};

use crate::error::PaperError;
use crate::named_figure::Named;
use crate::section7::chirps::ShapedChirps;
use crate::section7::multisine::MultisineCampaign;

/// Windows of figure 3: 2 Hz apart, which parts the harmonics from 2 Hz on.
const WINDOWS: SpectrogramOptions = SpectrogramOptions {
    window_s: 0.5,
    step_s: 0.05,
};
/// Harmonics that figure 3 points out; up to the last of them it shows.
const HARMONICS: [u32; 4] = [1, 2, 3, 5];
/// Pieces of the lines that mark them.
const SWEEP: u32 = 200;
/// Densities this far below the highest are drawn alike, in dB.
const RANGE_DB: f64 = 80.0;

/// Where the level of the third harmonic is reported, in Hz.
const LEVELS_AT_HZ: [f64; 4] = [4.0, 8.0, 16.0, 32.0];

/// Figure 3: the power spectral density of the torque over time.
pub(super) fn figure_3(chirps: &ShapedChirps) -> Result<Named, PaperError> {
    let (torque, _) = without_mean(&chirps.torque_nm);
    let start_s = start_s(chirps)?;
    let (low, high) = third_harmonic_range(chirps, torque.view(), start_s)?;
    Ok(Named {
        name: "figure_3_spectrogram",
        caption: format!(
            "Figure 3: power spectral density over time of the motor torque of axis 3 during the chirp at iteration {}. Dotted: the \
             chirp's frequency f and its multiples, to which the nonlinearities carry power: the third harmonic has {:.1} to {:.1} % \
             of the fundamental's amplitude at 4, 8, 16 and 32 Hz.",
            chirps.best,
            100.0 * low,
            100.0 * high
        ),
        figure: torque_spectrogram(chirps, torque.view(), start_s)?,
    })
}

/// Instant at which the chirp begins: before it the record has a lead-in, after it the chirp's
/// tail.
fn start_s(chirps: &ShapedChirps) -> Result<f64, PaperError> {
    let n_chirp = chirps.chirp.period_samples(chirps.sample_time_s)?;
    let lead_in = chirps.torque_nm.len().saturating_sub(n_chirp);
    Ok(lead_in as f64 * chirps.sample_time_s)
}

/// Lowest and highest level of the third harmonic over the fundamental.
fn third_harmonic_range(
    chirps: &ShapedChirps,
    torque: ArrayView1<f64>,
    start_s: f64,
) -> Result<(f64, f64), PaperError> {
    let levels = harmonic_levels(
        torque,
        chirps.sample_time_s,
        &chirps.chirp,
        start_s,
        &LEVELS_AT_HZ,
        &[3],
    )?;
    Ok(levels
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), x| {
            (low.min(*x), high.max(*x))
        }))
}

/// The heat map of figure 3, up to the last harmonic at the end of the chirp.
fn torque_spectrogram(
    chirps: &ShapedChirps,
    torque: ArrayView1<f64>,
    start_s: f64,
) -> Result<Figure, PaperError> {
    let density = spectrogram_of(torque, chirps.sample_time_s, &WINDOWS)?;
    let chirp = &chirps.chirp;
    let last_harmonic = HARMONICS[HARMONICS.len() - 1];
    let highest_hz = (chirp.high_hz * f64::from(last_harmonic) / 10.0).ceil() * 10.0;
    let nyquist_hz = 0.5 / chirps.sample_time_s;
    Ok(spectrogram(&Spectrogram {
        frequency_hz: &density.frequency_hz,
        time_s: &density.time_s,
        density: density.density.view(),
        unit: "(N m)²/Hz".into(),
        band_hz: (0.0, highest_hz.min(nyquist_hz)),
        log_frequency: false,
        range_db: RANGE_DB,
        sweep: sweep(chirp, start_s),
        harmonics: HARMONICS.to_vec(),
    })?)
}

/// Pairs of time and frequency of a chirp that begins at `start_s`.
fn sweep(chirp: &Chirp, start_s: f64) -> Vec<(f64, f64)> {
    (0..=SWEEP)
        .map(|k| chirp.duration_s * f64::from(k) / f64::from(SWEEP))
        .map(|time_s| (start_s + time_s, chirp.frequency_at(time_s)))
        .collect()
}

/// Figure 6: the reference.
pub(super) fn figure_6(multisine: &MultisineCampaign) -> Result<Named, PaperError> {
    let reference = multisine.reference_rad_s.view();
    let velocity_rad_s = multisine.velocity_rad_s.first().copied();
    let velocity = Array1::from_elem(reference.len(), velocity_rad_s.unwrap_or_default());
    let panel = TimePanel {
        label: "Velocity in rad/s".into(),
        traces: vec![
            trace("reference of axis 1", reference),
            trace("constant velocity", velocity.view()),
        ],
        limit: None,
        envelope: None,
    };
    Ok(Named {
        name: "figure_6_reference",
        caption: "Figure 6: reference velocity of axis 1, an odd random multisine on a constant velocity. Its peak is three quarters of that velocity, so that the sum does not change its sign.".into(),
        figure: time_series(multisine.sample_time_s, &[panel])?,
    })
}

/// Figure 7: the torque and what was desired.
pub(super) fn figure_7(chirps: &ShapedChirps) -> Result<Named, PaperError> {
    let (torque, mean) = without_mean(&chirps.torque_nm);
    let achieved = format!("achieved, iteration {}", chirps.best);
    let desired = envelope(&chirps.desired_nm);
    let panel = TimePanel {
        label: "Torque of axis 3 in N m".into(),
        traces: vec![trace(&achieved, torque.view())],
        limit: None,
        envelope: Some(trace("desired amplitude", desired.view())),
    };
    Ok(Named {
        name: "figure_7_torque",
        caption: format!(
            "Figure 7: motor torque of axis 3 in the first of the chirp experiments at iteration {}, without the \
             {:.0} N m in the mean that hold the arm, and the amplitude that was desired.",
            chirps.best,
            mean.abs()
        ),
        figure: time_series(chirps.sample_time_s, &[panel])?,
    })
}

/// A signal with its name in the legend.
fn trace<'a>(label: &str, samples: ArrayView1<'a, f64>) -> Trace<'a> {
    Trace {
        label: label.into(),
        samples,
    }
}

/// A signal without its mean, and the mean.
fn without_mean(signal: &Array1<f64>) -> (Array1<f64>, f64) {
    let mean = signal.mean().unwrap_or_default();
    (signal - mean, mean)
}

/// Amplitude over time of a sine whose frequency and amplitude vary slowly: straight lines between
/// the tops of its half waves, zero where it has not begun or has ended.
fn envelope(signal: &Array1<f64>) -> Array1<f64> {
    let mut amplitude = Array1::zeros(signal.len());
    for pair in envelope_corners(signal).windows(2) {
        let ((left, a), (right, b)) = (pair[0], pair[1]);
        for k in left..right {
            amplitude[k] = a + (b - a) * (k - left) as f64 / (right - left) as f64;
        }
    }
    amplitude
}

/// Index and height of the tops of a sine's half waves, between zeros at its beginning and end.
fn envelope_corners(signal: &Array1<f64>) -> Vec<(usize, f64)> {
    let last = signal.len().saturating_sub(1);
    let size = |k: usize| signal[k].abs();
    let tops = (1..last)
        .filter(|&k| size(k - 1) < size(k) && size(k) >= size(k + 1))
        .map(|k| (k, size(k)));
    let first = (0..last).find(|&k| size(k) > 0.0).unwrap_or(0);
    let end = (0..last).rfind(|&k| size(k) > 0.0).unwrap_or(last);
    [(first, 0.0)]
        .into_iter()
        .chain(tops)
        .chain([(end, 0.0)])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_envelope_of_a_growing_sine_is_its_amplitude() {
        let amplitude = |k: usize| 1.0 + k as f64 * 1e-3;
        let signal = Array1::from_shape_fn(5000, |k| amplitude(k) * (k as f64 * 0.05).sin());
        let found = envelope(&signal);
        for k in 100..4900 {
            assert!(
                (found[k] - amplitude(k)).abs() < 5e-3,
                "{k}: {} {}",
                found[k],
                amplitude(k)
            );
        }
        assert_eq!(envelope(&Array1::zeros(0)).len(), 0);
    }
}
