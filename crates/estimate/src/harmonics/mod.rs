//! Harmonics of a machine that a chirp sweeps: levels of orders 1 to 5 in its inputs and outputs, harmonic FRFs.
//!
//! A nonlinear machine answers a sweep `sin phi(t)` with `sum_n |X_n(f)| sin(n phi(t) + arg X_n(f))`. Every order is
//! a sweep of its own, and its spectrum S_n is known, ends and fades included. On a narrow band around F = n f, lines
//! of the whole record Z are hence a local model with an input for each order m that passes there,
//!
//! ```text
//! Z(F) = sum_m X_m(F/m) S_m(F) + T(F),   S_m the DFT of sin(m phi(t))
//! ```
//!
//! whose solution at F has X_n(f). The orders pass F at other instants, `L ln m` apart with `f = f_1 e^(t/L)`: over
//! a band of B Hz they are told apart where `B L ln((m + 1)/m)` exceeds what a model has of unknowns. That
//! is the condition of deconvolution (A. Farina, AES 108, 2000; A. Novak, P. Lotton, L. Simon, J. Audio Eng. Soc.
//! 63, 2015), but responses may be longer than the gaps between orders, ends of the sweep and transients cost
//! nothing, and any sweep will do.
//!
//! Of one input u and one output y, the harmonic FRFs have the phase of the input's fundamental, and what the loop
//! puts into the input as harmonics is taken off to first order:
//!
//! ```text
//! H_n(f) = (Y_n(f) - G(n f) U_n(f)) / U_1(f) e^(-i (n - 1) arg U_1(f)),   G = Y_1/U_1
//! ```

mod cycle_levels;
mod order_fit;
mod pooled;
mod response;
mod sweep_orders;
#[cfg(test)]
mod tests;

use std::iter::zip;

use frfid_signals::{Chirp, Harmonics, log_spaced};
use ndarray::{Array2, Array3, ArrayView2, Axis, concatenate};
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::EstimateError;
pub use crate::harmonics::cycle_levels::harmonic_levels;
use crate::harmonics::order_fit::OrderFit;
use crate::harmonics::pooled::pooled;
use crate::harmonics::sweep_orders::SweepOrders;
use crate::period_index::PeriodIndex;

/// Orders that are told.
const ORDERS: [usize; 5] = [1, 2, 3, 4, 5];
/// What cannot be told.
const UNKNOWN: Complex64 = Complex64::new(f64::NAN, f64::NAN);
/// Frequencies at which they are told.
const N_FREQUENCIES: usize = 80;

/// The harmonics of recordings of one chirp, planned once for all of them.
pub struct ChirpHarmonics {
    orders: SweepOrders,
    frequency_hz: Vec<f64>,
}

/// Spectra of a recording, `(channel, line)`: inputs, then outputs.
#[derive(Debug, Clone)]
pub struct SweepSpectra {
    signals: Array2<Complex64>,
    n_inputs: usize,
}

/// What the fits to one recording say, `(channel, order, frequency)`: inputs, then outputs.
struct Found {
    value: Array3<Complex64>,
    /// Of what no order explains.
    variance: Array3<f64>,
    /// Responses of the fundamental at the frequencies of the harmonics.
    fundamental: Array3<Complex64>,
}

impl ChirpHarmonics {
    /// Plans the harmonics of recordings of `n_samples` that begin with the sweep.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] for a chirp or a sample time out of range.
    pub fn new(chirp: &Chirp, sample_time_s: f64, n_samples: usize) -> Result<Self, EstimateError> {
        chirp.check()?;
        Ok(Self {
            orders: SweepOrders::new(chirp, sample_time_s, n_samples)?,
            frequency_hz: log_spaced(chirp.low_hz, chirp.high_hz, N_FREQUENCIES)?,
        })
    }

    /// The spectra of a recording, `(channel, sample)`.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] for another length, and samples that are not finite.
    pub fn spectra(
        &self,
        u: ArrayView2<f64>,
        y: ArrayView2<f64>,
    ) -> Result<SweepSpectra, EstimateError> {
        let inputs = self.orders.transform("u", u)?;
        let outputs = self.orders.transform("y", y)?;
        let parts = [inputs.view(), outputs.view()];
        Ok(SweepSpectra {
            n_inputs: inputs.nrows(),
            signals: concatenate(Axis(0), &parts).expect("the lines are the same"),
        })
    }

    /// The harmonics of a campaign: the mean of the repeats of every experiment, the rms of the experiments. `None`
    /// without recordings.
    #[must_use]
    pub fn harmonics(&self, runs: &[(PeriodIndex, SweepSpectra)]) -> Option<Harmonics> {
        let n_inputs = runs.first()?.1.n_inputs;
        let found = runs
            .iter()
            .map(|(place, run)| (*place, self.found(&run.signals)));
        let found = pooled(found.collect());
        Some(found.harmonics(&self.frequency_hz, &ORDERS, n_inputs))
    }

    /// The fits to one recording.
    fn found(&self, signals: &Array2<Complex64>) -> Found {
        let n_frequencies = self.frequency_hz.len();
        let mut found = Found::unknown((signals.nrows(), ORDERS.len(), n_frequencies));
        let place = |k: usize| (k / n_frequencies, k % n_frequencies);
        let fit = |k: usize| {
            let (order, frequency) = place(k);
            self.orders
                .fit(signals, ORDERS[order], self.frequency_hz[frequency])
        };
        let all = 0..ORDERS.len() * n_frequencies;
        let fits: Vec<_> = all.clone().into_par_iter().map(fit).collect();
        let fits = zip(all.map(place), fits);
        fits.filter_map(|(place, fits)| Some((place, fits?)))
            .for_each(|(place, fits)| found.put(place, &fits));
        found
    }
}

impl Found {
    fn unknown(size: (usize, usize, usize)) -> Self {
        Self {
            value: Array3::from_elem(size, UNKNOWN),
            variance: Array3::from_elem(size, f64::NAN),
            fundamental: Array3::from_elem(size, UNKNOWN),
        }
    }

    /// Puts what was fitted of an order at a frequency.
    fn put(&mut self, (order, frequency): (usize, usize), fits: &[OrderFit]) {
        for (channel, fit) in fits.iter().enumerate() {
            let place = [channel, order, frequency];
            self.value[place] = fit.value;
            self.variance[place] = fit.variance;
            self.fundamental[place] = fit.fundamental;
        }
    }
}
