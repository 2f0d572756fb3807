//! Repeats of one reference: their mean, and how they differ, which is noise and no distortion.

use std::ops::Range;

use ndarray::{Array2, Array3, s};
use num_complex::Complex64;

use crate::frf::matrices::Matrix;
use crate::spectra::run_spectra::RunSpectra;
use crate::spectra::spread::mean;

/// How repeats differ.
pub(super) struct Repeats {
    /// Covariance of the mean of outputs, then inputs, `(line, signal, signal)`.
    covariance: Array3<Complex64>,
    /// Repeats beyond the first: complex degrees of freedom of a line.
    n_free: usize,
}

/// Covariance of the mean of outputs, then inputs, over the lines of a window.
#[derive(Debug, Clone)]
pub(super) struct Scatter {
    pub(super) covariance: Matrix,
    pub(super) degrees_of_freedom: f64,
}

impl Repeats {
    /// How the repeats of a run differ, from all of which the mean of the same glides was subtracted: its noise is in
    /// every one of them, so that they do not differ by it. `None` of one repeat, or one glide.
    pub(super) fn of_runs(repeats: &[&RunSpectra], glides: &[RunSpectra]) -> Option<Self> {
        let mut own = Self::of(repeats)?;
        if !glides.is_empty() {
            own.covariance += &Self::of(&glides.iter().collect::<Vec<_>>())?.covariance;
        }
        Some(own)
    }

    /// How repeats differ from their mean; `None` of one.
    fn of(repeats: &[&RunSpectra]) -> Option<Self> {
        let (n, mean) = (repeats.len(), mean_of(repeats));
        let n_free = n.checked_sub(1).filter(|n_free| *n_free > 0)?;
        let (n_signals, n_lines) = (mean.y.nrows() + mean.u.nrows(), mean.y.ncols());
        let mut covariance = Array3::zeros((n_lines, n_signals, n_signals));
        for repeat in repeats {
            let off = stacked(&(&repeat.y - &mean.y), &(&repeat.u - &mean.u));
            for ((line, i, j), value) in covariance.indexed_iter_mut() {
                *value += off[[i, line]] * off[[j, line]].conj();
            }
        }
        let scale = Complex64::from((n * n_free) as f64);
        Some(Self {
            covariance: covariance / scale,
            n_free,
        })
    }

    /// The scatter over the lines of a window, of several pieces their mean; `None` if one has no repeats.
    pub(super) fn scatter<'r>(
        pieces: impl Iterator<Item = (Option<&'r Self>, Range<usize>)>,
    ) -> Option<Scatter> {
        let (mut sum, mut n_lines, mut n_free) = (Matrix::zeros(0, 0), 0, 0);
        for (repeats, lines) in pieces {
            let repeats = repeats?;
            let (_, n, _) = repeats.covariance.dim();
            let part = repeats.covariance.slice(s![lines.clone(), .., ..]);
            let part = part.sum_axis(ndarray::Axis(0));
            if sum.is_empty() {
                sum = Matrix::zeros(n, n);
            }
            sum += Matrix::from_fn(n, n, |i, j| part[[i, j]]);
            n_lines += lines.len();
            n_free += repeats.n_free * lines.len();
        }
        (n_lines > 0).then(|| Scatter {
            covariance: sum / Complex64::from(n_lines as f64),
            degrees_of_freedom: n_free as f64,
        })
    }
}

/// Mean of spectra of one shape, of at least one.
pub(super) fn mean_of(repeats: &[&RunSpectra]) -> RunSpectra {
    let r: Vec<&Array2<Complex64>> = repeats.iter().filter_map(|run| run.r.as_ref()).collect();
    RunSpectra {
        u: mean(&of_each(repeats, |run| &run.u)),
        y: mean(&of_each(repeats, |run| &run.y)),
        r: (!r.is_empty()).then(|| mean(&r)),
    }
}

fn of_each<'r>(
    repeats: &[&'r RunSpectra],
    signal: impl Fn(&'r RunSpectra) -> &'r Array2<Complex64>,
) -> Vec<&'r Array2<Complex64>> {
    repeats.iter().map(|run| signal(run)).collect()
}

/// The rows of both, one below the other.
fn stacked(upper: &Array2<Complex64>, lower: &Array2<Complex64>) -> Array2<Complex64> {
    let n_upper = upper.nrows();
    let at = |(row, line): (usize, usize)| match row.checked_sub(n_upper) {
        None => upper[[row, line]],
        Some(row) => lower[[row, line]],
    };
    Array2::from_shape_fn((n_upper + lower.nrows(), upper.ncols()), at)
}
