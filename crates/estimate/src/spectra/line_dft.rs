//! Spectra of real periods on given lines: (channel, sample) to (channel, line).
//!
//! `X[h] = sum_k (x[k] - mean) e^{-2 pi i h k / N}`, no factor forward; a period of any length N is
//! transformed as it is, never padded. Odd lines, which most multisines have alone, come from a transform of a quarter of
//! the samples ([`OddLines`]), even ones from `x[k] + x[k + N/2]`: a line is the same to the digit whatever others are
//! asked for.

use std::cmp::Ordering;
use std::iter::zip;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use frfid_signals::{SignalError, check_finite, checks::positive};
use frfid_transforms::{OddLines, RealToComplex, TransformPlanner};
use ndarray::{Array2, ArrayView1, ArrayView2, aview1};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::{Transform, check_length};

/// The DFT of periods of one length on one set of lines; planned once, used for every run, from any
/// thread.
#[derive(Clone)]
pub struct LineDft {
    lines: Vec<usize>,
    plan: LinePlan,
    free: Arc<Mutex<Vec<Buffers>>>,
}

/// How lines come from samples.
#[derive(Clone)]
enum LinePlan {
    All(Arc<dyn RealToComplex<f64>>),
    /// Odd lines, and even ones where they are asked for.
    Halves(OddLines, Option<Arc<dyn RealToComplex<f64>>>),
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
            plan: LinePlan::of(n_samples, lines),
            free: Arc::default(),
        })
    }

    /// Samples per period.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        match &self.plan {
            LinePlan::All(fft) => fft.len(),
            LinePlan::Halves(odd, _) => odd.n_samples(),
        }
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
            buffers.transform(&self.plan, channel);
            for (value, &line) in zip(spectrum, &self.lines) {
                *value = self.plan.line(&buffers, line);
            }
        }
        self.give_back(buffers);
        if !spectra.iter().all(|value| value.is_finite()) {
            check_finite(name, period)?; // one NaN is enough to spoil every line
        }
        Ok(spectra)
    }
}

impl LinePlan {
    fn of(n_samples: usize, lines: &[usize]) -> Self {
        let mut planner = TransformPlanner::default();
        if !n_samples.is_multiple_of(4) {
            return Self::All(planner.forward(n_samples));
        }
        let has_even = lines.iter().any(|line| line % 2 == 0);
        let even = has_even.then(|| planner.forward(n_samples / 2));
        Self::Halves(planner.odd_lines(n_samples), even)
    }

    fn buffers(&self) -> Buffers {
        let real = match self {
            Self::All(fft) => Some(fft),
            Self::Halves(_, even) => even.as_ref(),
        };
        let (odd_bins, scratch) = match self {
            Self::All(_) => Default::default(),
            Self::Halves(odd, _) => (odd.room(), odd.scratch()),
        };
        Buffers {
            samples: Vec::new(),
            real: real.map_or(Vec::new(), |fft| fft.make_input_vec()),
            bins: real.map_or(Vec::new(), |fft| fft.make_output_vec()),
            real_scratch: real.map_or(Vec::new(), |fft| fft.make_scratch_vec()),
            odd_bins,
            scratch,
        }
    }

    /// A line of what was transformed.
    fn line(&self, buffers: &Buffers, line: usize) -> Complex64 {
        match self {
            Self::All(_) => buffers.bins[line],
            Self::Halves(..) if line.is_multiple_of(2) => buffers.bins[line / 2],
            Self::Halves(odd, _) => odd.line(&buffers.odd_bins, line),
        }
    }
}

/// Buffers of one transform at a time; made once per thread that asks, since making them takes half
/// as long as the FFT.
struct Buffers {
    /// A channel whose samples do not lie side by side.
    samples: Vec<f64>,
    real: Vec<f64>,
    bins: Vec<Complex64>,
    real_scratch: Vec<Complex64>,
    odd_bins: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Buffers {
    /// From samples to bins, the mean taken off.
    fn transform(&mut self, plan: &LinePlan, channel: ArrayView1<f64>) {
        let samples = channel.to_slice().unwrap_or_else(|| {
            self.samples.clear();
            self.samples.extend(channel);
            &self.samples
        });
        match plan {
            LinePlan::All(fft) => {
                self.real.copy_from_slice(samples);
                self.transform_real(fft.as_ref());
            }
            LinePlan::Halves(odd, even) => {
                odd.process(samples, &mut self.odd_bins, &mut self.scratch);
                if let Some(fft) = even {
                    let (first, second) = samples.split_at(samples.len() / 2);
                    let sums = zip(first, second).map(|(a, b)| a + b);
                    zip(&mut self.real, sums).for_each(|(real, sum)| *real = sum);
                    self.transform_real(fft.as_ref());
                }
            }
        }
    }

    /// The mean is summed here, so that the layout of the array cannot change a digit.
    fn transform_real(&mut self, fft: &dyn RealToComplex<f64>) {
        let mean = aview1(&self.real).sum() / self.real.len() as f64;
        self.real.iter_mut().for_each(|sample| *sample -= mean);
        fft.process_with_scratch(&mut self.real, &mut self.bins, &mut self.real_scratch)
            .expect("the plan made the buffers, so their lengths fit");
    }
}

impl LineDft {
    fn borrow(&self) -> Buffers {
        let free = self.free_buffers().pop();
        free.unwrap_or_else(|| self.plan.buffers())
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
        for n in [12, 30, 31, 96, 97, 250, 1000] {
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
    fn a_line_is_the_same_to_the_digit_whatever_others_are_asked_for() {
        for n in [4, 12, 36, 1000, 4096] {
            let period =
                Array::from_shape_fn((2, n), |(c, k)| 5.0 + ((k * k + 7 * c) as f64).sin());
            let all: Vec<usize> = (1..n.div_ceil(2)).collect();
            let odd: Vec<usize> = (1..n.div_ceil(2)).step_by(2).collect();
            let spectra = |lines: &[usize]| {
                LineDft::new(n, lines)
                    .and_then(|dft| dft.transform("x", period.view()))
                    .expect("sound")
            };
            let (found, whole) = (spectra(&odd), spectra(&all));
            for ((c, i), value) in found.indexed_iter() {
                let expected = whole[[c, odd[i] - 1]];
                assert_eq!(*value, expected, "n = {n}, line {}", odd[i]);
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
