//! Excerpt of a chirp recording, SK15 section 5.1: the piece in which the chirp passes a
//! frequency, as one spectral value.
//!
//! Of the four periods around the instant (clipped at the ends of the sweep) the mean is removed; a
//! low-pass, ten samples per period, a Hann window and the DFT at the frequency follow. All of that
//! is linear and the same for every channel, so it is done as one weighted sum,
//! `X(f) = sum_k w_k (x_k - mean)`.

use std::f64::consts::{PI, TAU};
use std::iter::zip;

use frfid_signals::checks::{finite, positive};
use frfid_signals::{Chirp, check_finite};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::{Transform, check_length, mean, spectra_of_pieces};

/// How excerpts are cut and weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExcerptOptions {
    /// Length of an excerpt in periods of its frequency.
    pub n_periods: f64,
    /// Samples per period after the low-pass; fewer where the recording itself has fewer.
    pub samples_per_period: f64,
}

impl Default for ExcerptOptions {
    fn default() -> Self {
        Self {
            n_periods: 4.0,
            samples_per_period: 10.0,
        }
    }
}

/// The excerpts of a chirp at a list of frequencies, cut once and used for every run, from any
/// thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Excerpts {
    n_samples: usize,
    excerpts: Vec<Excerpt>,
}

impl ExcerptOptions {
    /// Half width of the band over which the excerpt in the middle of a sweep, at
    /// `f = sqrt(low_hz high_hz)`, blurs the response, over f. It is the largest of
    ///
    /// - `1/(2 n)`, half of the DFT's line spacing over n periods;
    /// - `e^(n a/(2 f)) - 1`, how far the frequency runs from the middle of the excerpt to its end,
    ///   where the sweep grows by `e^(a t)`;
    /// - `sqrt(a/f)`: a sweep of a f Hz per s crosses a band of B Hz in B/(a f) s and resolves it
    ///   if that is 1/B at least. A mode that is hardly damped peaks late by 0.86 of it
    ///   (F. M. Lewis, Vibration during acceleration through a critical speed, Trans. ASME 54, 1932).
    ///
    /// At other frequencies the last one goes with `1/sqrt(f)`.
    #[must_use]
    pub fn relative_resolution(&self, chirp: &Chirp) -> f64 {
        let growth = chirp.rate() / (chirp.low_hz * chirp.high_hz).sqrt();
        let run = (0.5 * self.n_periods * growth).exp_m1();
        (0.5 / self.n_periods).max(run).max(growth.sqrt())
    }

    /// Every how many-th sample is left after the low-pass; 0 where there are too few to leave any
    /// out.
    fn step(&self, hz: f64, sample_time_s: f64) -> usize {
        (1.0 / (self.samples_per_period * hz * sample_time_s)).floor() as usize
    }
}

impl Excerpts {
    /// Cuts recordings of `n_samples`, in which the chirp starts `start_s` after the first sample,
    /// at `frequencies_hz`.
    ///
    /// # Errors
    /// [`EstimateError::OutsideChirp`] for a frequency that the chirp does not pass within the
    /// recording, [`frfid_signals::SignalError`] for a chirp or a sample time out of range.
    pub fn new(
        chirp: &Chirp,
        frequencies_hz: &[f64],
        sample_time_s: f64,
        start_s: f64,
        n_samples: usize,
        options: &ExcerptOptions,
    ) -> Result<Self, EstimateError> {
        positive("sample_time_s", sample_time_s)?;
        positive("n_periods", options.n_periods)?;
        positive("samples_per_period", options.samples_per_period)?;
        finite("start_s", start_s)?;
        chirp.check()?;
        let cut = |&hz: &f64| Excerpt::cut(hz, chirp, start_s, sample_time_s, n_samples, options);
        Ok(Self {
            n_samples,
            excerpts: frequencies_hz.iter().map(cut).collect::<Result<_, _>>()?,
        })
    }
}

impl Transform for Excerpts {
    fn transform(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError> {
        check_length(name, signal, self.n_samples)?;
        check_finite(name, signal)?;
        Ok(spectra_of_pieces(signal, &self.excerpts, Excerpt::of))
    }
}

/// One excerpt as weights on the samples of the recording.
#[derive(Debug, Clone, PartialEq)]
struct Excerpt {
    /// Samples of the excerpt itself, over which the mean is taken.
    first: usize,
    last: usize,
    /// Sample of the first weight; the low-pass reaches a little beyond the excerpt.
    weights_from: usize,
    weights: Vec<Complex64>,
}

impl Excerpt {
    /// The excerpt around the instant at which the chirp passes `hz`.
    fn cut(
        hz: f64,
        chirp: &Chirp,
        start_s: f64,
        sample_time_s: f64,
        n_samples: usize,
        options: &ExcerptOptions,
    ) -> Result<Self, EstimateError> {
        let refuse = |reason| EstimateError::OutsideChirp {
            frequency_hz: hz,
            reason,
            low_s: 0.0,
            high_s: n_samples as f64 * sample_time_s,
        };
        if !(chirp.low_hz * (1.0 - 1e-9)..=chirp.high_hz * (1.0 + 1e-9)).contains(&hz) {
            return Err(refuse("the chirp never has this frequency"));
        }
        let span_s = span_s(hz, chirp, start_s, options.n_periods);
        match ends(span_s, hz, sample_time_s, n_samples) {
            Some(ends) => Ok(Self::weighted(hz, ends, sample_time_s, n_samples, options)),
            None => Err(refuse(
                "less than one period of it, or fewer than five samples, lie within the sweep and the recording",
            )),
        }
    }

    /// Window, Fourier kernel and low-pass in one:
    /// `w_k = sum_j hann(t_j) e^{-2 pi i f t_j} h(k - j)`, j every `step` samples.
    fn weighted(
        hz: f64,
        [first, last]: [usize; 2],
        sample_time_s: f64,
        n_samples: usize,
        options: &ExcerptOptions,
    ) -> Self {
        let step = options.step(hz, sample_time_s).clamp(1, last - first);
        let low_pass = low_pass(step);
        let reach = low_pass.len() / 2;
        let weights_from = first.saturating_sub(reach);
        let n_weights = (last + reach + 1).min(n_samples) - weights_from;
        let mut weights = vec![Complex64::from(0.0); n_weights];
        for centre in (first..=last).step_by(step) {
            let place = (centre - first) as f64;
            let window = (PI * (place / (last - first) as f64)).sin().powi(2);
            let kernel = Complex64::cis(-TAU * hz * place * sample_time_s) * window;
            for (tap, gain) in low_pass.iter().enumerate() {
                let place = (centre + tap).checked_sub(reach + weights_from);
                // beyond the recording's ends: nothing
                if let Some(weight) = place.and_then(|k| weights.get_mut(k)) {
                    *weight += kernel * gain;
                }
            }
        }
        Self {
            first,
            last,
            weights_from,
            weights,
        }
    }

    /// The spectrum of one channel at the frequency of the excerpt.
    fn of(&self, channel: &[f64]) -> Complex64 {
        let mean = mean(&channel[self.first..=self.last]);
        let samples = channel[self.weights_from..].iter();
        let terms = zip(&self.weights, samples).map(|(weight, sample)| weight * (sample - mean));
        terms.sum()
    }
}

/// Start and end in s of the excerpt around the instant at which the chirp passes `hz`, within the
/// sweep.
fn span_s(hz: f64, chirp: &Chirp, start_s: f64, n_periods: f64) -> [f64; 2] {
    let centre_s = start_s + chirp.instant_of(hz);
    let half_s = 0.5 * n_periods / hz;
    [
        (centre_s - half_s).max(start_s),
        (centre_s + half_s).min(start_s + chirp.duration_s),
    ]
}

/// First and last sample of an excerpt within the recording; `None` if they are too close.
fn ends(
    [low_s, high_s]: [f64; 2],
    hz: f64,
    sample_time_s: f64,
    n_samples: usize,
) -> Option<[usize; 2]> {
    let first = (low_s / sample_time_s).ceil().max(0.0);
    let last = (high_s / sample_time_s).floor().min(n_samples as f64 - 1.0);
    // negative, NaN and too short alike: nothing is cut from less than one period or fewer than five
    // samples
    let is_enough = (last - first) * sample_time_s * hz >= 1.0 && last - first >= 4.0;
    is_enough.then_some([first as usize, last as usize])
}

/// Anti-alias low-pass for taking every `step`-th sample: a Hann-shaped average over four new
/// samples, whose first zero lies at the new Nyquist frequency; a single 1 where nothing is left
/// out.
fn low_pass(step: usize) -> Vec<f64> {
    if step == 1 {
        return vec![1.0];
    }
    let shape = hann(4 * step);
    let sum: f64 = shape.iter().sum();
    shape.iter().map(|value| value / sum).collect()
}

/// Hann window over so many steps, without its zeros at either end.
fn hann(n_steps: usize) -> Vec<f64> {
    let places = (1..n_steps).map(|k| PI * k as f64 / n_steps as f64);
    places.map(|place| place.sin().powi(2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::Profile;

    const SAMPLE_TIME_S: f64 = 1e-3;

    fn chirp(duration_s: f64) -> Chirp {
        Chirp {
            low_hz: 1.0,
            high_hz: 60.0,
            duration_s,
            amplitude: vec![Profile::constant(1.0)],
            fade_s: 0.0,
            tail_s: 0.0,
        }
    }

    fn excerpt(hz: f64) -> Excerpt {
        Excerpt::cut(
            hz,
            &chirp(20.0),
            0.0,
            SAMPLE_TIME_S,
            20_000,
            &ExcerptOptions::default(),
        )
        .expect("within the sweep")
    }

    fn response(excerpt: &Excerpt, hz: f64) -> f64 {
        let sine: Vec<f64> = (0..20_000)
            .map(|k| (TAU * hz * f64::from(k) * SAMPLE_TIME_S).sin() + 7.0)
            .collect();
        excerpt.of(&sine).norm()
    }

    /// Harmonics have zeros or low side lobes of the Hann window, what lies above the new Nyquist
    /// frequency is filtered.
    #[test]
    fn other_frequencies_are_rejected() {
        for hz in [2.0, 9.0, 25.0] {
            let cut = excerpt(hz);
            let passed = response(&cut, hz);
            for factor in [2.0, 3.0, 5.0, 9.0, 11.0, 19.3] {
                let ratio = response(&cut, factor * hz) / passed;
                assert!(ratio < 0.02, "{factor} x {hz} Hz: {ratio}");
            }
        }
    }

    #[test]
    fn four_periods_lie_around_the_instant_and_are_clipped_at_the_ends() {
        let middle = excerpt(10.0);
        let instant = 20.0 * 10f64.ln() / 60f64.ln() / SAMPLE_TIME_S;
        assert_eq!(
            (middle.first, middle.last),
            (
                (instant - 200.0).ceil() as usize,
                (instant + 200.0).floor() as usize
            )
        );
        assert_eq!((excerpt(1.0).first, excerpt(60.0).last), (0, 19_999));
    }

    /// By the DFT for slow sweeps, by their rate for fast ones, by how far they run within an excerpt
    /// for very fast ones.
    #[test]
    fn the_resolution_is_that_of_the_sweep() {
        let cut = ExcerptOptions::default();
        let growth = |duration_s: f64| 60f64.ln() / duration_s / 60f64.sqrt();
        for (duration_s, expected) in [
            (200.0, 0.125),
            (20.0, growth(20.0).sqrt()),
            (5.0, growth(5.0).sqrt()),
            (0.5, (2.0 * growth(0.5)).exp() - 1.0),
        ] {
            let found = cut.relative_resolution(&chirp(duration_s));
            assert!(
                (found / expected - 1.0).abs() < 1e-9,
                "{duration_s} s: {found}"
            );
        }
    }
}
