//! Means over periods of a signal's spectra, and the spread around them: its noise.

use ndarray::{Array2, Zip};
use num_complex::Complex64;

use crate::spectra::campaign::Block;
use crate::spectra::run_spectra::RunSpectra;

/// A signal of a campaign, means and noise apart.
pub(crate) struct Spread {
    /// Mean over periods, `(channel, line)`, and number of periods, of every realization and
    /// experiment.
    pub(crate) means: Vec<(Array2<Complex64>, usize)>,
    /// Sum of the squared distances from the means, `(channel, line)`.
    pub(crate) squares: Array2<f64>,
    /// Complex degrees of freedom of that sum; 0 with one period.
    pub(crate) freedom: usize,
    /// Number of periods, over all realizations and experiments.
    pub(crate) n_runs: usize,
}

impl Spread {
    /// Of a signal that every run of complete blocks, by realization and period, holds.
    pub(crate) fn of<'a>(
        realizations: &[Vec<Block<'a>>],
        signal: impl Fn(&'a RunSpectra) -> Option<&'a Array2<Complex64>>,
    ) -> Self {
        let first = signal(realizations[0][0][0]);
        let mut spread = Self::empty(first.map_or((0, 0), Array2::dim));
        for periods in realizations {
            for experiment in 0..periods[0].len() {
                let spectra = periods.iter().filter_map(|block| signal(block[experiment]));
                spread.add(&spectra.collect::<Vec<_>>());
            }
        }
        spread
    }

    fn empty(shape: (usize, usize)) -> Self {
        Self {
            means: Vec::new(),
            squares: Array2::zeros(shape),
            freedom: 0,
            n_runs: 0,
        }
    }

    /// Adds the periods of one experiment.
    fn add(&mut self, periods: &[&Array2<Complex64>]) {
        let mean = mean(periods);
        add_squares(&mut self.squares, periods, &mean);
        self.freedom += periods.len().saturating_sub(1);
        self.n_runs += periods.len();
        self.means.push((mean, periods.len()));
    }
}

/// Mean of at least one spectrum.
pub(crate) fn mean(spectra: &[&Array2<Complex64>]) -> Array2<Complex64> {
    let mut mean = spectra[0].clone();
    for spectrum in &spectra[1..] {
        mean += *spectrum;
    }
    mean / Complex64::from(spectra.len() as f64)
}

/// Adds the squared distances of spectra from their mean.
pub(crate) fn add_squares(
    squares: &mut Array2<f64>,
    spectra: &[&Array2<Complex64>],
    mean: &Array2<Complex64>,
) {
    for spectrum in spectra {
        Zip::from(&mut *squares)
            .and(*spectrum)
            .and(mean)
            .for_each(|sum, value, mean| *sum += (value - mean).norm_sqr());
    }
}
