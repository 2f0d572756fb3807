//! Odd lines of a real period: one complex transform, a quarter as long as the period.
//!
//! Odd lines see only the odd half-wave `z[n] = x[n] - x[n + N/2]`. With it
//!
//! ```text
//! v[n] = (z[n] - i z[n + N/4]) e^{-2 pi i n / N},   n < N/4,   V its DFT
//! X[h] = V[(h - 1)/4] for h = 1, 5, 9, ...,   X[h] = conj V[(N - h - 1)/4] for h = 3, 7, 11, ...
//! ```
//!
//! A constant drops out, so that no mean need be taken off.

use std::f64::consts::TAU;
use std::iter::zip;
use std::sync::Arc;

use realfft::num_complex::Complex64;
use rustfft::Fft;

/// The transform of periods of one length to their odd lines.
#[derive(Clone)]
pub struct OddLines {
    /// `e^{-2 pi i n / N}`.
    turns: Arc<[Complex64]>,
    fft: Arc<dyn Fft<f64>>,
}

impl OddLines {
    /// By a transform of a quarter of the samples.
    pub(crate) fn by(fft: Arc<dyn Fft<f64>>) -> Self {
        let angle = -TAU / (4 * fft.len()) as f64;
        let turns = (0..fft.len()).map(|n| Complex64::cis(n as f64 * angle));
        Self {
            turns: turns.collect(),
            fft,
        }
    }

    /// Samples per period, N.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        4 * self.fft.len()
    }

    /// Room for the N/4 values of one transform.
    #[must_use]
    pub fn room(&self) -> Vec<Complex64> {
        vec![Complex64::default(); self.fft.len()]
    }

    /// Scratch that the transform works in.
    #[must_use]
    pub fn scratch(&self) -> Vec<Complex64> {
        vec![Complex64::default(); self.fft.get_inplace_scratch_len()]
    }

    /// V of the N samples x.
    ///
    /// # Panics
    /// For samples, room or scratch of other lengths than planned.
    pub fn process(&self, x: &[f64], v: &mut [Complex64], scratch: &mut [Complex64]) {
        let quarter = self.fft.len();
        let (first, second) = x.split_at(2 * quarter);
        let half_wave = |n: usize| zip(&first[n..], &second[n..]).map(|(a, b)| a - b);
        let pairs = zip(half_wave(0), half_wave(quarter));
        for ((v, turn), (re, im)) in zip(zip(&mut *v, &*self.turns), pairs) {
            *v = Complex64::new(re * turn.re + im * turn.im, re * turn.im - im * turn.re);
        }
        self.fft.process_with_scratch(v, scratch);
    }

    /// `X[h]` of an odd line h below N.
    #[must_use]
    pub fn line(&self, v: &[Complex64], h: usize) -> Complex64 {
        match h % 4 {
            1 => v[h / 4],
            _ => v[(self.n_samples() - h) / 4].conj(),
        }
    }
}
