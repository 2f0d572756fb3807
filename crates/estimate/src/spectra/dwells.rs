//! Dwells of a stepped sine as spectra: of each frequency the DFT over its whole measured periods,
//! `X(f) = sum_k (x_k - mean) e^{-2 pi i p k / M}`, p periods in M samples.

use std::f64::consts::TAU;

use frfid_signals::{Dwell, SteppedSine, check_finite, checks::require_shape};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::{Transform, check_length, mean, spectra_of_pieces};

/// The dwells of a stepped sine, planned once and used for every run, from any thread.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dwells {
    n_samples: usize,
    dwells: Vec<Dwell>,
}

impl Dwells {
    /// Plans the transform of recordings of `n_samples` that begin with the stepped sine.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] for a stepped sine that is out of range or longer than the
    /// recordings.
    pub(super) fn new(
        stepped: &SteppedSine,
        sample_time_s: f64,
        n_samples: usize,
    ) -> Result<Self, EstimateError> {
        let dwells = stepped.dwells(sample_time_s)?;
        let needed = dwells.last().map_or(0, |dwell| dwell.measured.end);
        let fits = n_samples >= needed;
        let needed = format_args!("({needed} or more samples), all dwells");
        require_shape("recording", &[n_samples], fits, needed)?;
        Ok(Self { n_samples, dwells })
    }

    /// Frequencies in Hz, rising.
    #[must_use]
    pub(super) fn frequency_hz(&self) -> Vec<f64> {
        self.dwells.iter().map(|dwell| dwell.hz).collect()
    }
}

impl Transform for Dwells {
    fn transform(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError> {
        check_length(name, signal, self.n_samples)?;
        check_finite(name, signal)?;
        Ok(spectra_of_pieces(signal, &self.dwells, line))
    }
}

/// DFT of the samples of a dwell, at its frequency.
fn line(dwell: &Dwell, samples: &[f64]) -> Complex64 {
    let samples = &samples[dwell.measured.clone()];
    let mean = mean(samples);
    let terms = samples.iter().enumerate();
    let terms = terms.map(|(k, sample)| turn(dwell.periods * k, samples.len()) * (sample - mean));
    terms.sum()
}

/// `e^{-2 pi i p k / M}` from the product p k, which is reduced before it becomes an angle, so that
/// long dwells keep their digits.
fn turn(product: usize, n_samples: usize) -> Complex64 {
    Complex64::cis(-TAU * (product % n_samples) as f64 / n_samples as f64)
}
