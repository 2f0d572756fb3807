//! Spectra of real periods on given lines: (channel, sample) to (channel, line).
//!
//! `X[h] = sum_k (x[k] - mean) e^{-2 pi i h k / N}`, no factor forward; a period of any length N is
//! transformed as it is, never padded.

use std::cmp::Ordering;
use std::iter::zip;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use frfid_signals::{SignalError, check_finite, checks::positive};
use frfid_transforms::{RealToComplex, TransformPlanner};
use ndarray::{Array2, ArrayView1, ArrayView2, aview_mut1, aview1};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::{Transform, check_length};

/// The DFT of periods of one length on one set of lines; planned once, used for every run, from any
/// thread.
#[derive(Clone)]
pub struct LineDft {
    lines: Vec<usize>,
    fft: Arc<dyn RealToComplex<f64>>,
    free: Arc<Mutex<Vec<Buffers>>>,
}

/// Refuses lines that do not rise, or lie on no line of a period between 0 and half the rate.
///
/// # Errors
/// Those of [`LineDft::new`].
pub(crate) fn check_lines(n_samples: usize, lines: &[usize]) -> Result<(), EstimateError> {
    check_on_grid(lines, n_samples.saturating_sub(1) / 2, n_samples)?;
    check_rising("lines", lines.iter().map(|&line| line as f64))
}

impl LineDft {
    /// Plans the transform of periods of `n_samples` on the DFT bins `lines`, which must rise.
    ///
    /// # Errors
    /// [`SignalError::LineOffGrid`] for a line that is 0 or not below Nyquist,
    /// [`EstimateError::NotRising`], [`EstimateError::EmptyList`] without lines.
    pub fn new(n_samples: usize, lines: &[usize]) -> Result<Self, EstimateError> {
        check_lines(n_samples, lines)?;
        Ok(Self {
            lines: lines.to_vec(),
            fft: TransformPlanner::default().forward(n_samples),
            free: Arc::default(),
        })
    }

    /// Samples per period.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        self.fft.len()
    }

    /// The lines, rising.
    pub(crate) fn lines(&self) -> &[usize] {
        &self.lines
    }

    /// Spectra of several periods, each `(channel, line)`.
    pub(crate) fn transform_each<'a>(
        &self,
        name: &'static str,
        periods: impl IntoIterator<Item = ArrayView2<'a, f64>>,
    ) -> Result<Vec<Array2<Complex64>>, EstimateError> {
        periods
            .into_iter()
            .map(|period| self.transform(name, period))
            .collect()
    }

    /// Frequencies of the lines in Hz: `line / (n_samples sample_time_s)`.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a sample time that is not finite and above zero.
    pub fn frequency_hz(&self, sample_time_s: f64) -> Result<Vec<f64>, EstimateError> {
        positive("sample_time_s", sample_time_s)?;
        let period_s = self.n_samples() as f64 * sample_time_s;
        Ok(self
            .lines
            .iter()
            .map(|&line| line as f64 / period_s)
            .collect())
    }
}

impl Transform for LineDft {
    fn transform(
        &self,
        name: &'static str,
        period: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError> {
        check_length(name, period, self.n_samples())?;
        let mut buffers = self.borrow();
        let mut spectra = Array2::zeros((period.nrows(), self.lines.len()));
        for (channel, spectrum) in zip(period.rows(), spectra.rows_mut()) {
            let mean = buffers.fill(channel);
            if !mean.is_finite() {
                check_finite(name, period)?; // one NaN is enough to spoil the sum
            }
            buffers.transform(mean, self.fft.as_ref());
            zip(spectrum, &self.lines).for_each(|(value, &line)| *value = buffers.bins[line]);
        }
        self.give_back(buffers);
        Ok(spectra)
    }
}

/// Buffers of one transform at a time; made once per thread that asks, since making them takes half
/// as long as the FFT.
struct Buffers {
    samples: Vec<f64>,
    bins: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Buffers {
    /// Takes the samples of a channel; returns their mean, summed here, so that the layout of the
    /// array cannot change a digit.
    fn fill(&mut self, channel: ArrayView1<f64>) -> f64 {
        aview_mut1(&mut self.samples).assign(&channel);
        aview1(&self.samples).sum() / self.samples.len() as f64
    }

    /// From samples to bins, the mean taken off.
    fn transform(&mut self, mean: f64, fft: &dyn RealToComplex<f64>) {
        self.samples.iter_mut().for_each(|sample| *sample -= mean);
        fft.process_with_scratch(&mut self.samples, &mut self.bins, &mut self.scratch)
            .expect("the plan made the buffers, so their lengths fit");
    }
}

impl LineDft {
    fn borrow(&self) -> Buffers {
        let free = self.free_buffers().pop();
        free.unwrap_or_else(|| Buffers {
            samples: self.fft.make_input_vec(),
            bins: self.fft.make_output_vec(),
            scratch: self.fft.make_scratch_vec(),
        })
    }

    fn give_back(&self, buffers: Buffers) {
        self.free_buffers().push(buffers);
    }

    fn free_buffers(&self) -> MutexGuard<'_, Vec<Buffers>> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Refuses a line that is 0 or above the highest one below Nyquist.
pub(super) fn check_on_grid(
    lines: &[usize],
    highest: usize,
    n_samples: usize,
) -> Result<(), SignalError> {
    let off_grid = lines.iter().find(|&&line| line == 0 || line > highest);
    let error = |&line: &usize| SignalError::LineOffGrid {
        line,
        highest,
        n_samples,
    };
    off_grid.map(error).map_or(Ok(()), Err)
}

/// Refuses a list without entries, one that does not rise, and one that holds NaN.
pub(crate) fn check_rising(
    name: &'static str,
    mut list: impl Iterator<Item = f64>,
) -> Result<(), EstimateError> {
    let mut before = list.next().ok_or(EstimateError::EmptyList(name))?;
    for (index, found) in list.enumerate() {
        if found.partial_cmp(&before) != Some(Ordering::Greater) {
            return Err(EstimateError::NotRising {
                name,
                index: index + 1,
                found,
                before,
            });
        }
        before = found;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use ndarray::{Array, Axis, s};
    use std::f64::consts::TAU;

    #[test]
    fn any_length_agrees_with_the_defining_sum() {
        for n in [30, 31, 97, 250] {
            let period =
                Array::from_shape_fn((2, n), |(c, k)| 5.0 + ((k * k + 7 * c) as f64).sin());
            let lines = [1, 4, (n - 1) / 2];
            let found = LineDft::new(n, &lines)
                .and_then(|dft| dft.transform("x", period.view()))
                .expect("sound");
            for ((c, i), value) in found.indexed_iter() {
                let turn = |k: usize| Complex64::cis(-TAU * (lines[i] * k % n) as f64 / n as f64);
                let sum: Complex64 = period
                    .row(c)
                    .iter()
                    .enumerate()
                    .map(|(k, x)| turn(k) * x)
                    .sum();
                assert!(
                    (value - sum).norm() < 1e-12 * n as f64,
                    "n = {n}, line {}",
                    lines[i]
                );
            }
        }
    }

    #[test]
    fn strides_do_not_matter() {
        let long = Array::from_shape_fn((128, 3), |(k, c)| ((3 * k * k + c) as f64).cos());
        let period = long.slice(s![..;2, ..]).reversed_axes();
        let dft = LineDft::new(64, &[1, 5, 31]).expect("sound");
        let contiguous = period.as_standard_layout().into_owned();
        assert_eq!(
            dft.transform("x", period),
            dft.transform("x", contiguous.view())
        );
        assert_eq!(period.len_of(Axis(1)), 64);
    }

    #[test]
    fn bad_lines_and_samples_are_refused() {
        for bad in [0, 32, 1000] {
            let expected = SignalError::LineOffGrid {
                line: bad,
                highest: 31,
                n_samples: 64,
            };
            assert_eq!(LineDft::new(64, &[bad]).err(), Some(expected.into()));
        }
        assert!(matches!(
            LineDft::new(64, &[3, 3]).err(),
            Some(EstimateError::NotRising { index: 1, .. })
        ));
        assert_eq!(
            LineDft::new(64, &[]).err(),
            Some(EstimateError::EmptyList("lines"))
        );
        let expected = SignalError::LineOffGrid {
            line: 1,
            highest: 0,
            n_samples: 0,
        };
        assert_eq!(LineDft::new(0, &[1]).err(), Some(expected.into()));
        let dft = LineDft::new(64, &[3]).expect("sound");
        let mut period = Array2::zeros((2, 64));
        period[[1, 7]] = f64::INFINITY;
        let expected = SignalError::NotFinite {
            name: "y",
            count: 1,
            channel: 1,
            sample: 7,
        };
        assert_eq!(dft.transform("y", period.view()), Err(expected.into()));
        assert_eq!(
            dft.transform("y", period.slice(s![.., 1..])),
            Err(EstimateError::shape("y", &[2, 63], "(channel, 64)".into()))
        );
        assert!(refusal(dft.frequency_hz(f64::NAN)).starts_with("sample_time_s is NaN"));
    }
}
