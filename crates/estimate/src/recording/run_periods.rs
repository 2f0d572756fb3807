//! Periods of a run: their spectra on given lines, of a whole period by the DFT, of what is there of
//! another by harmonic least squares at the true times.

use std::ops::Range;

use frfid_signals::checks::positive;
use ndarray::{Array2, ArrayView2, Axis, s};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::Transform;
use crate::spectra::harmonic_fit::HarmonicFit;
use crate::spectra::line_dft::LineDft;

/// A last period that lacks less than this share counts: least squares do without, as without any
/// other lost samples.
const NEARLY_WHOLE: f64 = 0.01;

/// The periods of a run, a stretch of a recording in which the excitation repeats.
#[derive(Clone)]
pub struct RunPeriods {
    samples: Range<usize>,
    period: f64,
    lines: Vec<usize>,
    /// Lines that are fitted, the excited ones among them.
    fitted: Vec<usize>,
    dft: LineDft,
    /// Where the samples of the run are, in samples of an even clock; `None` where they are even.
    positions: Option<Vec<f64>>,
}

impl RunPeriods {
    /// The periods of `samples` of a recording: `period` in samples need not be whole, `positions`
    /// of all samples of the recording need not be even. `also` are lines that are in the signals
    /// without being excited, as distortion puts them there: they are fitted along.
    ///
    /// # Errors
    /// Those of [`LineDft::new`]; [`frfid_signals::SignalError::Parameter`] for a period that is not
    /// above zero.
    pub fn new(
        samples: Range<usize>,
        period: f64,
        positions: Option<&[f64]>,
        lines: &[usize],
        also: &[usize],
    ) -> Result<Self, EstimateError> {
        positive("period", period)?;
        let dft = LineDft::new(period.round() as usize, lines)?;
        let mut fitted = [lines, also].concat();
        fitted.sort_unstable();
        fitted.dedup();
        let of_run = |positions: &[f64]| {
            let run = positions.get(samples.clone()).unwrap_or_default();
            let first = run.first().copied().unwrap_or(0.0);
            run.iter().map(|position| position - first).collect()
        };
        Ok(Self {
            positions: positions.map(of_run),
            samples,
            period,
            lines: lines.to_vec(),
            fitted,
            dft,
        })
    }

    /// Number of periods.
    #[must_use]
    pub fn n_periods(&self) -> usize {
        let last = self.samples.len().saturating_sub(1);
        let length = 1.0 + self.position(last);
        (length / self.period + NEARLY_WHOLE) as usize
    }

    /// Spectra `(channel, line)` of a period of a recording's `(channel, sample)`, lost samples NaN;
    /// `None` where what is there of the period cannot tell the lines apart.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError::Shape`] for a recording that ends before the run.
    pub fn spectra(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
        period: usize,
    ) -> Result<Option<Array2<Complex64>>, EstimateError> {
        let window = self.window(period);
        let from_start = self.samples.start + window.start..self.samples.start + window.end;
        if from_start.end > signal.ncols() {
            let needed = format!("(channel, {} or more)", self.samples.end);
            return Err(EstimateError::shape(name, signal.shape(), needed));
        }
        let signal = signal.slice(s![.., from_start]);
        let is_whole = window.len() == self.dft.n_samples() && signal.iter().all(|x| x.is_finite());
        if is_whole && self.is_even() {
            return self.dft.transform(name, signal).map(Some);
        }
        let cycles = |sample| self.position(sample) / self.period - period as f64;
        let cycles: Vec<f64> = window.map(cycles).collect();
        let fit = HarmonicFit::new(&cycles, &self.fitted, self.period)?;
        let spectra = fit.spectra(name, signal)?;
        Ok(spectra.map(|spectra| self.excited(&spectra)))
    }

    /// Spectra of every period, in their order.
    ///
    /// # Errors
    /// As [`RunPeriods::spectra`].
    pub fn all_spectra(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Vec<Option<Array2<Complex64>>>, EstimateError> {
        let periods = 0..self.n_periods();
        periods
            .map(|period| self.spectra(name, signal, period))
            .collect()
    }

    /// The sample of the run with which a period begins.
    #[must_use]
    pub fn first_sample(&self, period: usize) -> usize {
        self.window(period).start
    }

    /// Whether every period is a whole number of evenly spaced samples.
    fn is_even(&self) -> bool {
        self.positions.is_none() && self.period.fract() == 0.0
    }

    /// Where a sample of the run is, in samples of an even clock from the first on.
    fn position(&self, sample: usize) -> f64 {
        let positions = self.positions.as_ref();
        positions.map_or(sample as f64, |positions| {
            positions.get(sample).copied().unwrap_or(sample as f64)
        })
    }

    /// Samples of the run that lie in a period.
    fn window(&self, period: usize) -> Range<usize> {
        let first_from = |position: f64| match &self.positions {
            None => position.ceil() as usize,
            Some(positions) => positions.partition_point(|&at| at < position),
        };
        let start = first_from(period as f64 * self.period).min(self.samples.len());
        let end = first_from((period + 1) as f64 * self.period).min(self.samples.len());
        start..end
    }

    /// The excited lines of spectra on all that are fitted.
    fn excited(&self, spectra: &Array2<Complex64>) -> Array2<Complex64> {
        let place = |line: &usize| self.fitted.partition_point(|fitted| fitted < line);
        let places: Vec<usize> = self.lines.iter().map(place).collect();
        spectra.select(Axis(1), &places)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{normal, phase, stream};
    use std::f64::consts::TAU;

    const LINES: [usize; 6] = [1, 3, 5, 9, 17, 21];
    const DISTORTED: [usize; 2] = [2, 6];

    /// A multisine and its distortion at the given positions; period 100.25.
    fn signal(positions: &[f64], period: f64) -> Array2<f64> {
        let mut rng = stream(4, "run", &[]);
        let lines = LINES.iter().chain(&DISTORTED);
        let parts: Vec<(f64, f64)> = lines.map(|&h| (h as f64, phase(&mut rng))).collect();
        Array2::from_shape_fn((1, positions.len()), |(_, k)| {
            let at = |&(h, phase): &(f64, f64)| (TAU * h * positions[k] / period + phase).cos();
            3.0 + parts.iter().map(at).sum::<f64>()
        })
    }

    fn spectra(run: &RunPeriods, signal: &Array2<f64>, period: usize) -> Array2<Complex64> {
        let spectra = run.spectra("u", signal.view(), period);
        spectra.expect("sound").expect("enough samples")
    }

    #[test]
    fn periods_are_the_same_whole_holed_uneven_and_of_any_length() {
        let even: Vec<f64> = (0..520).map(f64::from).collect();
        let of = |period, positions| {
            RunPeriods::new(10..511, period, positions, &LINES, &DISTORTED).expect("sound")
        };
        let x = signal(&even, 100.0);
        let whole = of(100.0, None);
        assert_eq!(whole.n_periods(), 5);
        let needed = spectra(&whole, &x, 0);
        let mut holed = x.clone();
        for k in (0..520).step_by(7) {
            holed[[0, k]] = f64::NAN;
        }
        let mut rng = stream(5, "jitter", &[]);
        let uneven: Vec<f64> = even.iter().map(|k| k + 0.1 * normal(&mut rng)).collect();
        let uneven_x = signal(&uneven, 100.0);
        for period in 0..5 {
            for (run, x) in [(&whole, &x), (&whole, &holed)] {
                let gap = (&spectra(run, x, period) - &needed).mapv(Complex64::norm);
                assert!(gap.iter().all(|&gap| gap < 1e-9), "period {period}: {gap}");
            }
            let run = of(100.0, Some(&uneven));
            let turned = spectra(&run, &uneven_x, period);
            for (size, found) in needed.iter().zip(&turned) {
                assert!((size.norm() - found.norm()).abs() < 1e-9, "period {period}");
            }
        }
        let long = of(100.25, None);
        let x = signal(&even, 100.25);
        let first = spectra(&long, &x, 0);
        for period in 1..4 {
            let gap = (&spectra(&long, &x, period) - &first).mapv(Complex64::norm);
            assert!(gap.iter().all(|&gap| gap < 1e-9), "period {period}: {gap}");
        }
    }

    #[test]
    fn too_few_samples_are_no_period() {
        let even: Vec<f64> = (0..200).map(f64::from).collect();
        let run = RunPeriods::new(0..200, 100.0, None, &LINES, &[]).expect("sound");
        let mut x = signal(&even, 100.0);
        x.slice_mut(s![0, 10..]).fill(f64::NAN);
        assert_eq!(run.spectra("u", x.view(), 0), Ok(None));
        assert!(run.spectra("u", x.slice(s![.., ..150]), 1).is_err());
    }
}
