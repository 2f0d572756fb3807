//! Orders of a sweep: the spectra of sin(n phi(t)) on the lines of a recording, and which of them pass a frequency.

use std::iter::zip;
use std::ops::Range;

use frfid_signals::{Chirp, checks::positive};
use ndarray::{Array2, ArrayView2, Axis, aview1};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::harmonics::ORDERS;
use crate::spectra::Transform;
use crate::spectra::whole_record::WholeRecord;

/// Orders that are modelled: those that are told, and the next odd ones, which friction has.
const MODELLED: [usize; 7] = [1, 2, 3, 4, 5, 7, 9];
/// Lines begin below the band by this factor.
const BELOW: f64 = 0.5;
/// Width of a window times the time between the two orders that follow each other most closely.
const CELLS: f64 = 4.4;
/// Share of the Nyquist frequency that is looked at.
const USABLE: f64 = 0.98;

/// The orders of a chirp on the lines of recordings.
pub(super) struct SweepOrders {
    whole: WholeRecord,
    band_hz: [f64; 2],
    spectra: Vec<Vec<Complex64>>,
    half_width: usize,
}

impl SweepOrders {
    pub(super) fn new(
        chirp: &Chirp,
        sample_time_s: f64,
        n_samples: usize,
    ) -> Result<Self, EstimateError> {
        positive("sample_time_s", sample_time_s)?;
        let highest = ORDERS[ORDERS.len() - 1] as f64;
        let above = (highest * chirp.high_hz * 1.1).min(USABLE * 0.5 / sample_time_s);
        let whole = WholeRecord::new([BELOW * chirp.low_hz, above], sample_time_s, n_samples)?;
        let spectrum = |order: &usize| -> Result<Vec<Complex64>, EstimateError> {
            let sine = chirp.harmonic(*order, sample_time_s, n_samples);
            let sine = aview1(&sine).insert_axis(Axis(0));
            Ok(whole.transform("chirp", sine)?.into_raw_vec_and_offset().0)
        };
        let length_s = n_samples as f64 * sample_time_s;
        let gap_s = (highest / (highest - 1.0)).ln() / chirp.rate();
        Ok(Self {
            spectra: MODELLED.iter().map(spectrum).collect::<Result<_, _>>()?,
            band_hz: [chirp.low_hz, chirp.high_hz],
            half_width: (0.5 * CELLS * length_s / gap_s).ceil() as usize,
            whole,
        })
    }

    pub(super) fn transform(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError> {
        self.whole.transform(name, signal)
    }

    /// The lines of the window around a frequency; `None` where the recording has none.
    pub(super) fn lines_around(&self, hz: f64) -> Option<Range<usize>> {
        let line_hz = self.whole.frequency_hz();
        let above = line_hz.partition_point(|line| *line < hz);
        let first = above.saturating_sub(self.half_width);
        let last = (above + self.half_width).min(line_hz.len());
        (0 < above && above < line_hz.len()).then_some(first..last)
    }

    pub(super) fn line_hz(&self, lines: Range<usize>) -> &[f64] {
        &self.whole.frequency_hz()[lines]
    }

    /// The orders that pass these lines, with their spectra there.
    pub(super) fn passing(&self, lines: &Range<usize>) -> Vec<(usize, Vec<Complex64>)> {
        let line_hz = self.line_hz(lines.clone());
        let [first_hz, last_hz] = [line_hz[0], line_hz[line_hz.len() - 1]];
        let [low_hz, high_hz] = self.band_hz;
        let passes = |order: &usize| {
            let n = *order as f64;
            n * low_hz < last_hz && first_hz < n * high_hz
        };
        let orders = zip(MODELLED, &self.spectra).filter(|(order, _)| passes(order));
        orders
            .map(|(order, spectrum)| (order, spectrum[lines.clone()].to_vec()))
            .collect()
    }
}
