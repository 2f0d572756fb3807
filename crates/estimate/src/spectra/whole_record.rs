//! Spectra of whole recordings on all lines of a band: not periodic, so that leakage and transients are in them.

use frfid_signals::{Chirp, checks::positive};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::Transform;
use crate::spectra::campaign::Campaign;
use crate::spectra::line_dft::LineDft;

/// The lines of whole recordings within a band.
#[derive(Clone)]
pub struct WholeRecord {
    dft: LineDft,
    line_hz: Vec<f64>,
}

impl WholeRecord {
    /// Plans the lines for recordings of `n_samples`: those from `low_hz` to `high_hz`, at least one.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] for a sample time that is not above zero or recordings of
    /// fewer than three samples.
    pub fn new(
        [low_hz, high_hz]: [f64; 2],
        sample_time_s: f64,
        n_samples: usize,
    ) -> Result<Self, EstimateError> {
        positive("sample_time_s", sample_time_s)?;
        let length_s = n_samples as f64 * sample_time_s;
        let highest = n_samples.saturating_sub(1) / 2;
        let last = ((high_hz * length_s) as usize).clamp(1, highest.max(1));
        let first = ((low_hz * length_s).ceil() as usize).clamp(1, last);
        let dft = LineDft::new(n_samples, &(first..=last).collect::<Vec<_>>())?;
        Ok(Self {
            line_hz: dft.frequency_hz(sample_time_s)?,
            dft,
        })
    }

    /// The lines that a chirp excites.
    ///
    /// # Errors
    /// As [`WholeRecord::new`].
    pub fn of_band(
        chirp: &Chirp,
        sample_time_s: f64,
        n_samples: usize,
    ) -> Result<Self, EstimateError> {
        Self::new([chirp.low_hz, chirp.high_hz], sample_time_s, n_samples)
    }

    /// Frequencies of the lines in Hz.
    #[must_use]
    pub fn frequency_hz(&self) -> &[f64] {
        &self.line_hz
    }

    /// An empty campaign for the spectra.
    ///
    /// # Errors
    /// None of a record that was planned.
    pub fn campaign(&self) -> Result<Campaign, EstimateError> {
        Campaign::new(self.line_hz.clone())
    }
}

impl Transform for WholeRecord {
    fn transform(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError> {
        self.dft.transform(name, signal)
    }
}
