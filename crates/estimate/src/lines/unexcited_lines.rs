//! Lines that are in a signal without being excited: distortion and mains, which least squares must
//! know of where samples are missing.

use std::iter::zip;

use frfid_signals::median;
use ndarray::{Array2, ArrayView1, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;

/// A line this far above the median of the lines that are not excited is no noise: chance makes one
/// of 1e10.
const ABOVE_MEDIAN: f64 = 6.0;
/// Where more phases of the period than this were never sampled, a mean period says nothing.
const MOST_UNKNOWN: f64 = 0.05;

/// Lines of a run `(channel, sample)`, lost samples NaN, that stand out in the mean over its periods
/// without being among `excited`: the strongest, at most as many as are excited.
///
/// # Errors
/// Those of [`LineDft::new`].
pub fn unexcited_lines(
    run: ArrayView2<f64>,
    period: f64,
    excited: &[usize],
) -> Result<Vec<usize>, EstimateError> {
    let n_samples = period.round() as usize;
    let others = other_lines(n_samples, excited);
    let Some(mean) = mean_period(run, period).filter(|_| !others.is_empty()) else {
        return Ok(Vec::new());
    };
    let spectra = LineDft::new(n_samples, &others)?.transform("signal", mean.view())?;
    let prominence = prominence(spectra.view(), others.len());
    Ok(most_prominent(prominence, others, excited.len()))
}

/// The lines of a period that are not `excited`.
fn other_lines(n_samples: usize, excited: &[usize]) -> Vec<usize> {
    let lines = 1..n_samples.div_ceil(2);
    let others = lines.filter(|line| excited.binary_search(line).is_err());
    others.collect()
}

/// How many times the median of its channel each line has, in the channel where that is most.
fn prominence(spectra: ArrayView2<Complex64>, n_lines: usize) -> Vec<f64> {
    let mut prominence = vec![0.0_f64; n_lines];
    for channel in spectra.rows() {
        let median = median_size(channel);
        for (most, value) in zip(&mut prominence, channel) {
            *most = most.max(value.norm() / median);
        }
    }
    prominence
}

/// At most so many of the lines that are no noise, rising.
fn most_prominent(prominence: Vec<f64>, lines: Vec<usize>, most: usize) -> Vec<usize> {
    let mut rated: Vec<(f64, usize)> = zip(prominence, lines).collect();
    rated.retain(|(prominence, _)| *prominence > ABOVE_MEDIAN);
    rated.sort_by(|a, b| b.0.total_cmp(&a.0));
    let lines = rated.into_iter().take(most).map(|(_, line)| line);
    sorted(lines.collect())
}

fn sorted(mut lines: Vec<usize>) -> Vec<usize> {
    lines.sort_unstable();
    lines
}

fn median_size(spectrum: ArrayView1<Complex64>) -> f64 {
    let sizes = spectrum.iter().map(|value| value.norm());
    median(sizes.collect()).map_or(f64::MIN_POSITIVE, |size| size.max(f64::MIN_POSITIVE))
}

/// Mean over the periods of what is there, phase by phase; `None` where too much never is.
fn mean_period(run: ArrayView2<f64>, period: f64) -> Option<Array2<f64>> {
    let phases = Phases::new(run, period);
    phases.is_known().then(|| phases.means())
}

/// Samples of each `(channel, phase of the period)` that are there: their sum, and how many.
struct Phases {
    sum: Array2<f64>,
    count: Array2<f64>,
}

impl Phases {
    fn new(run: ArrayView2<f64>, period: f64) -> Self {
        let mut phases = Self::empty(run.nrows(), period.round() as usize);
        for ((channel, k), &value) in run.indexed_iter() {
            if value.is_finite() {
                phases.add(channel, k as f64 % period, value);
            }
        }
        phases
    }

    fn empty(n_channels: usize, n_phases: usize) -> Self {
        let zeros = Array2::zeros((n_channels, n_phases));
        let (sum, count) = (zeros.clone(), zeros);
        Self { sum, count }
    }

    fn add(&mut self, channel: usize, phase: f64, value: f64) {
        let place = [channel, phase as usize % self.sum.ncols()];
        self.sum[place] += value;
        self.count[place] += 1.0;
    }

    /// Whether enough phases were sampled.
    fn is_known(&self) -> bool {
        let unknown = self.count.iter().filter(|&&count| count == 0.0).count();
        unknown as f64 <= MOST_UNKNOWN * self.count.len() as f64
    }

    /// The mean at each phase, that of the channel where it was never sampled.
    fn means(&self) -> Array2<f64> {
        let of_channels = self.channel_means();
        let value = |(channel, phase)| match self.count[[channel, phase]] {
            0.0 => of_channels[channel],
            count => self.sum[[channel, phase]] / count,
        };
        Array2::from_shape_fn(self.sum.raw_dim(), value)
    }

    fn channel_means(&self) -> Vec<f64> {
        let totals = zip(self.sum.rows(), self.count.rows());
        let means = totals.map(|(sum, count)| sum.sum() / count.sum());
        means.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{normal, stream};
    use std::f64::consts::TAU;

    #[test]
    fn distortion_is_found_in_noise_and_holes() {
        let excited = [3, 5, 7, 11];
        let mut rng = stream(1, "distortion", &[]);
        let run = Array2::from_shape_fn((1, 2000), |(_, k)| {
            let sine = |h: f64| (TAU * h * k as f64 / 200.0).sin();
            let clean = excited.iter().map(|&h| sine(h as f64)).sum::<f64>();
            let value = clean + 0.2 * sine(9.0) + 0.1 * sine(14.0) + 0.02 * normal(&mut rng);
            if k % 11 == 0 { f64::NAN } else { value }
        });
        let found = unexcited_lines(run.view(), 200.0, &excited).expect("sound");
        assert_eq!(found, [9, 14]);
        let silent = Array2::<f64>::zeros((1, 400));
        assert_eq!(unexcited_lines(silent.view(), 200.0, &excited), Ok(vec![]));
        let short = Array2::from_elem((1, 400), f64::NAN);
        assert_eq!(unexcited_lines(short.view(), 200.0, &excited), Ok(vec![]));
    }
}
