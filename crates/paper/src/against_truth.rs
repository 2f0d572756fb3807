//! Estimate beside the linear truth, and the numbers by which the two are compared.

use std::ops::RangeInclusive;

use frfid_signals::Frf;

/// An FRF and the exact FRF of the same joint without its nonlinearities, at the same frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The estimate.
    pub frf: Frf,
    /// The linear truth, through the hold of the controller.
    pub truth: Frf,
}

impl Measured {
    /// Largest |G - P| / |P| over all frequencies and entries.
    #[must_use]
    pub fn worst_relative_error(&self) -> f64 {
        largest_relative_difference(&self.frf, &self.truth)
    }

    /// Magnitude errors |20 lg |G/P|| in dB of the first entry in a band, smallest first.
    #[must_use]
    pub fn errors_db(&self, band_hz: RangeInclusive<f64>) -> Vec<f64> {
        let [ours, truth] = [&self.frf, &self.truth].map(|frf| frf.magnitude_db(0, 0));
        let lines = self.in_band(band_hz);
        let mut errors: Vec<f64> = lines.map(|k| (ours[k] - truth[k]).abs()).collect();
        errors.sort_by(f64::total_cmp);
        errors
    }

    /// Largest magnitude of the estimate in a band: frequency in Hz and dB; `None` for a band
    /// without lines.
    #[must_use]
    pub fn peak(&self, band_hz: RangeInclusive<f64>) -> Option<(f64, f64)> {
        let in_band = levels_db(&self.frf, 0).filter(|(hz, _)| band_hz.contains(hz));
        in_band.max_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// By how many dB the peak of the estimate lies below that of the truth in a band.
    #[must_use]
    pub fn peak_deficit_db(&self, band_hz: RangeInclusive<f64>) -> f64 {
        let [(_, ours), (_, truth)] = self.extremes(band_hz, Frf::magnitude_db);
        truth - ours
    }

    /// How far the peak stands above the notch in a band: dB of the estimate and of the truth.
    #[must_use]
    pub fn contrasts_db(&self, band_hz: RangeInclusive<f64>) -> (f64, f64) {
        self.spans(band_hz, Frf::magnitude_db)
    }

    /// Span of the phase, largest minus smallest, in a band: degrees of the estimate and of the
    /// truth.
    #[must_use]
    pub fn phase_spans_deg(&self, band_hz: RangeInclusive<f64>) -> (f64, f64) {
        self.spans(band_hz, Frf::phase_deg)
    }

    /// Largest minus smallest value of a quantity in a band, of the estimate and of the truth.
    fn spans(&self, band_hz: RangeInclusive<f64>, quantity: Quantity) -> (f64, f64) {
        let extremes = self.extremes(band_hz, quantity);
        extremes.map(|(low, high)| high - low).into()
    }

    /// Smallest and largest value of a quantity in a band, of the estimate and of the truth.
    fn extremes(&self, band_hz: RangeInclusive<f64>, quantity: Quantity) -> [(f64, f64); 2] {
        [&self.frf, &self.truth].map(|frf| {
            let values = quantity(frf, 0, 0);
            self.in_band(band_hz.clone())
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), k| {
                    (low.min(values[k]), high.max(values[k]))
                })
        })
    }

    /// Numbers of the lines in a band.
    fn in_band(&self, band_hz: RangeInclusive<f64>) -> impl Iterator<Item = usize> {
        (0..self.frf.n_frequencies()).filter(move |&k| band_hz.contains(&self.frf.frequency_hz[k]))
    }
}

/// Magnitude or phase of one entry of an FRF.
type Quantity = fn(&Frf, usize, usize) -> Vec<f64>;

/// Largest |A - B| / |B| over all frequencies and entries of two FRFs on the same frequencies.
#[must_use]
pub fn largest_relative_difference(a: &Frf, b: &Frf) -> f64 {
    relative_differences(a, b).fold(0.0, f64::max)
}

/// |A - B| / |B| of every frequency and entry.
pub(crate) fn relative_differences(a: &Frf, b: &Frf) -> impl Iterator<Item = f64> {
    let entries = a.response.iter().zip(&b.response);
    entries.map(|(a, b)| (a - b).norm() / b.norm())
}

/// Frequencies in Hz and magnitudes in dB of a diagonal entry.
pub(crate) fn levels_db(frf: &Frf, axis: usize) -> impl Iterator<Item = (f64, f64)> {
    let frequency_hz = frf.frequency_hz.iter().copied();
    frequency_hz.zip(frf.magnitude_db(axis, axis))
}
