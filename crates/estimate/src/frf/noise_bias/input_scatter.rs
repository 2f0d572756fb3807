//! Scatter of the input from period to period: how much of it can be noise, and how much the output follows.

use frfid_signals::Frf;
use ndarray::{Array2, Zip};

use crate::settling::input_changes::without_input_changes;
use crate::spectra::campaign::Block;
use crate::spectra::run_spectra::RunSpectra;
use crate::spectra::spread::{add_squares, mean};

/// Share of the scatter of U over the periods of a run that can be noise, line by line, 1 at most.
///
/// Noise on u alone is in `Y - G (U - mean U)` in full; a strength that changes from period to period, as of
/// hammer blows, is not, since y follows it. With sums over the periods of all runs, of the output `i` that
/// allows most,
///
/// ```text
/// share = max_i sum |Y - G (U - mean U) - mean Y|_i^2 / sum |G (U - mean U)|_i^2
/// ```
pub(crate) fn noise_share(realizations: &[Vec<Block>], frf: &Frf) -> Vec<f64> {
    let mut scatter = Scatter::new((frf.n_outputs(), frf.n_frequencies()));
    for periods in realizations {
        for experiment in 0..periods[0].len() {
            let runs: Vec<&RunSpectra> = periods.iter().map(|block| block[experiment]).collect();
            scatter.add(&runs, frf);
        }
    }
    scatter.shares()
}

/// Sums of squares over all runs, `(output, line)`.
struct Scatter {
    unexplained: Array2<f64>,
    explained: Array2<f64>,
}

impl Scatter {
    fn new(shape: (usize, usize)) -> Self {
        Self {
            unexplained: Array2::zeros(shape),
            explained: Array2::zeros(shape),
        }
    }

    fn add(&mut self, runs: &[&RunSpectra], frf: &Frf) {
        let rest = without_input_changes(runs, frf);
        let rest: Vec<&Array2<_>> = rest.iter().collect();
        add_squares(&mut self.unexplained, &rest, &mean(&rest));
        for (run, rest) in runs.iter().zip(rest) {
            add_squares(&mut self.explained, &[&run.y], rest);
        }
    }

    fn shares(&self) -> Vec<f64> {
        let mut ratios = self.explained.clone();
        Zip::from(&mut ratios)
            .and(&self.unexplained)
            .for_each(|ratio, unexplained| *ratio = unexplained / *ratio);
        let lines = ratios.columns().into_iter();
        lines
            .map(|outputs| outputs.iter().copied().fold(0.0, f64::max).min(1.0))
            .collect()
    }
}
