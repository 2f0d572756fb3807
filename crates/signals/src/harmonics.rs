//! Harmonics along a sweep: what inputs and outputs have at the multiples of the frequency that it passes.

use ndarray::{Array2, Array3, ArrayView1, s};
use num_complex::Complex64;

use crate::number::median::median;

/// Harmonics of the signals of a machine that a sine sweeps, `x = sum_n |X_n(f)| sin(n phi + arg X_n(f))`, phi the
/// sweep's phase, f its frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonics {
    /// Frequencies f in Hz.
    pub frequency_hz: Vec<f64>,
    /// Orders n, the fundamental 1 first.
    pub orders: Vec<usize>,
    /// Of the inputs.
    pub input: Amplitudes,
    /// Of the outputs.
    pub output: Amplitudes,
    /// `H_n(f)`, `(order, frequency)`, of one input u and one output: y is `|U_1| sum_n |H_n| sin(n phi_u + arg H_n)`,
    /// phi_u the phase of the fundamental of u, had u nothing else. NaN where not known; `None` of more channels.
    pub response: Option<Array2<Complex64>>,
}

/// Amplitudes of harmonics, `(channel, order, frequency)`, in the unit of the signal; of several experiments the
/// rms.
#[derive(Debug, Clone, PartialEq)]
pub struct Amplitudes {
    /// `|X_n(f)|`; NaN where it is not known or does not stand out from the floor.
    pub amplitude: Array3<f64>,
    /// What an amplitude must exceed: two standard deviations by what no harmonic explains; NaN where nothing is
    /// known.
    pub floor: Array3<f64>,
    /// Standard deviation of the amplitude, from repeats; `None` without.
    pub deviation: Option<Array3<f64>>,
}

/// The typical level of a harmonic over its fundamental.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarmonicLevel {
    /// Order n.
    pub order: usize,
    /// Median over the frequencies, in dB.
    pub median_db: f64,
    /// Whether it stands out at less than half of them: then the level is at most that.
    pub is_bound: bool,
}

impl Amplitudes {
    /// Level of a harmonic over the fundamental in dB, frequency by frequency.
    #[must_use]
    pub fn level_db(&self, channel: usize, order: usize) -> Vec<f64> {
        over(
            self.of(&self.amplitude, channel, order),
            self.of(&self.amplitude, channel, 0),
        )
    }

    /// The typical levels of a channel; orders of which nothing is known are not there.
    #[must_use]
    pub fn levels(&self, channel: usize, orders: &[usize]) -> Vec<HarmonicLevel> {
        let harmonics = orders.iter().enumerate().skip(1);
        let level = |(place, order): (usize, &usize)| self.level(channel, place, *order);
        harmonics.filter_map(level).collect()
    }

    fn level(&self, channel: usize, place: usize, order: usize) -> Option<HarmonicLevel> {
        let fundamental = self.of(&self.amplitude, channel, 0);
        let floors = over(self.of(&self.floor, channel, place), fundamental);
        let levels = self.level_db(channel, place);
        let known = levels
            .iter()
            .zip(&floors)
            .filter(|(_, floor)| !floor.is_nan());
        let known: Vec<(f64, f64)> = known.map(|(level, floor)| (*level, *floor)).collect();
        let n_told = known.iter().filter(|(level, _)| !level.is_nan()).count();
        Some(HarmonicLevel {
            order,
            median_db: median(
                known
                    .iter()
                    .map(|(level, floor)| level.max(*floor))
                    .collect(),
            )?,
            is_bound: 2 * n_told < known.len(),
        })
    }

    fn of<'a>(&self, array: &'a Array3<f64>, channel: usize, order: usize) -> ArrayView1<'a, f64> {
        array.slice(s![channel, order, ..])
    }
}

/// Ratios in dB.
fn over(above: ArrayView1<f64>, below: ArrayView1<f64>) -> Vec<f64> {
    let ratios = above.iter().zip(below);
    ratios
        .map(|(above, below)| 20.0 * (above / below).log10())
        .collect()
}
