//! Excerpt of a chirp recording, SK15 section 5.1: the piece in which the chirp passes a
//! frequency, as one spectral value.
//!
//! Of the four periods around the instant (clipped at the ends of the sweep) the mean is removed; a
//! low-pass, ten samples per period, a Hann window and the DFT at the frequency follow. All of that
//! is linear and the same for every channel, so it is done as one weighted sum
//! ([`crate::spectra::excerpt_weights`]).

use std::borrow::Cow;
use std::iter::zip;

use frfid_signals::checks::{finite, positive};
use frfid_signals::{Chirp, check_finite};
use ndarray::{Array2, ArrayView1, ArrayView2};
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::EstimateError;
use crate::spectra::excerpt_weights::Weights;
use crate::spectra::{Transform, check_length};

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
    excerpts: Vec<Weights>,
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
        let cut = |&hz: &f64| {
            let ends = excerpt_ends(hz, chirp, start_s, sample_time_s, n_samples, options)?;
            let step = options.step(hz, sample_time_s).clamp(1, ends[1] - ends[0]);
            Ok(Weights::of(ends, hz * sample_time_s, step, n_samples))
        };
        let excerpts: Vec<Result<_, EstimateError>> = frequencies_hz.par_iter().map(cut).collect();
        Ok(Self {
            n_samples,
            excerpts: excerpts.into_iter().collect::<Result<_, _>>()?,
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
        let channels: Vec<Cow<[f64]>> = signal.rows().into_iter().map(contiguous).collect();
        let mut spectra = Array2::zeros((signal.nrows(), self.excerpts.len()));
        for (spectrum, weights) in zip(spectra.columns_mut(), &self.excerpts) {
            weights.add_sums(&channels, spectrum);
        }
        Ok(spectra)
    }
}

/// The samples of a channel one after the other.
fn contiguous(channel: ArrayView1<'_, f64>) -> Cow<'_, [f64]> {
    let owned = || Cow::Owned(channel.to_vec());
    channel.to_slice().map_or_else(owned, Cow::Borrowed)
}

/// First and last sample of the excerpt around the instant at which the chirp passes `hz`.
fn excerpt_ends(
    hz: f64,
    chirp: &Chirp,
    start_s: f64,
    sample_time_s: f64,
    n_samples: usize,
    options: &ExcerptOptions,
) -> Result<[usize; 2], EstimateError> {
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
    ends(span_s, hz, sample_time_s, n_samples).ok_or_else(|| {
        refuse(
            "less than one period of it, or fewer than five samples, lie within the sweep and the recording",
        )
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::Profile;
    use std::f64::consts::TAU;

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

    fn excerpt(hz: f64) -> Excerpts {
        let cut = ExcerptOptions::default();
        Excerpts::new(&chirp(20.0), &[hz], SAMPLE_TIME_S, 0.0, 20_000, &cut)
            .expect("within the sweep")
    }

    fn first_and_last(hz: f64) -> [usize; 2] {
        let cut = ExcerptOptions::default();
        excerpt_ends(hz, &chirp(20.0), 0.0, SAMPLE_TIME_S, 20_000, &cut).expect("within the sweep")
    }

    fn response(excerpt: &Excerpts, hz: f64) -> f64 {
        let sine = |(_, k): (usize, usize)| (TAU * hz * k as f64 * SAMPLE_TIME_S).sin() + 7.0;
        let sine = Array2::from_shape_fn((1, 20_000), sine);
        excerpt.transform("x", sine.view()).expect("finite")[[0, 0]].norm()
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
        let instant = 20.0 * 10f64.ln() / 60f64.ln() / SAMPLE_TIME_S;
        assert_eq!(
            first_and_last(10.0),
            [
                (instant - 200.0).ceil() as usize,
                (instant + 200.0).floor() as usize
            ]
        );
        assert_eq!(
            (first_and_last(1.0)[0], first_and_last(60.0)[1]),
            (0, 19_999)
        );
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
