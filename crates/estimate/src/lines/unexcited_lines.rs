//! Lines that are in a signal without being excited: distortion and mains, which least squares must
//! know of where samples are missing.

use std::iter::zip;

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
    let mut others: Vec<usize> = (1..n_samples.div_ceil(2)).collect();
    others.retain(|line| excited.binary_search(line).is_err());
    let Some(mean) = mean_period(run, period).filter(|_| !others.is_empty()) else {
        return Ok(Vec::new());
    };
    let spectra = LineDft::new(n_samples, &others)?.transform("signal", mean.view())?;
    let mut prominence = vec![0.0_f64; others.len()];
    for channel in spectra.rows() {
        let median = median_size(channel);
        for (most, value) in zip(&mut prominence, channel) {
            *most = most.max(value.norm() / median);
        }
    }
    let mut standing_out: Vec<(f64, usize)> = zip(prominence, others).collect();
    standing_out.retain(|(prominence, _)| *prominence > ABOVE_MEDIAN);
    standing_out.sort_by(|a, b| b.0.total_cmp(&a.0));
    standing_out.truncate(excited.len());
    let mut lines: Vec<usize> = standing_out.into_iter().map(|(_, line)| line).collect();
    lines.sort_unstable();
    Ok(lines)
}

fn median_size(spectrum: ArrayView1<Complex64>) -> f64 {
    let mut sizes: Vec<f64> = spectrum.iter().map(|value| value.norm()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes[sizes.len() / 2].max(f64::MIN_POSITIVE)
}

/// Mean over the periods of what is there, phase by phase; `None` where too much never is.
fn mean_period(run: ArrayView2<f64>, period: f64) -> Option<Array2<f64>> {
    let n_samples = period.round() as usize;
    let mut sum = Array2::<f64>::zeros((run.nrows(), n_samples));
    let mut count = Array2::<f64>::zeros((run.nrows(), n_samples));
    for ((channel, k), &value) in run.indexed_iter() {
        if value.is_finite() {
            let phase = (k as f64 % period) as usize % n_samples;
            sum[[channel, phase]] += value;
            count[[channel, phase]] += 1.0;
        }
    }
    let unknown = count.iter().filter(|&&count| count == 0.0).count();
    let is_known = unknown as f64 <= MOST_UNKNOWN * count.len() as f64;
    is_known.then(|| {
        let totals = zip(sum.rows(), count.rows());
        let means: Vec<f64> = totals.map(|(sum, count)| sum.sum() / count.sum()).collect();
        let value = |(channel, phase)| match count[[channel, phase]] {
            0.0 => means[channel],
            count => sum[[channel, phase]] / count,
        };
        Array2::from_shape_fn(sum.raw_dim(), value)
    })
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
