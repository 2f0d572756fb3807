//! Windows of a period each over a run with holes, and their spectra: good enough to weigh noise
//! and trends by, never to estimate from.

use std::iter::zip;

use frfid_signals::checks::require_shape;
use ndarray::{Array2, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;
use crate::trend::trend_model::Model;

/// Lines whose noise stands for that of slow trends: noise of real machines rises to low
/// frequencies.
const LOW_LINES: usize = 3;

/// Windows of a run, back to back.
pub(super) struct PeriodWindows {
    pub(super) period: f64,
    pub(super) n_periods: usize,
    excited: LineDft,
    lowest: LineDft,
}

impl PeriodWindows {
    /// Windows of a run of `n_samples`; the period is so many samples, not necessarily whole.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError::Shape`] for a period longer than the run or shorter than three
    /// samples, those of [`LineDft::new`].
    pub(super) fn new(
        n_samples: usize,
        period: f64,
        lines: &[usize],
    ) -> Result<Self, EstimateError> {
        let fits = period >= 3.0 && period.round() <= n_samples as f64; // NaN does not fit
        let needed = format_args!("({period} or more), a period of 3 or more samples");
        require_shape("run", &[n_samples], fits, needed)?;
        let length = period.round() as usize;
        let lowest: Vec<usize> = (1..=LOW_LINES.min((length - 1) / 2)).collect();
        Ok(Self {
            period,
            // the last window may miss half a sample
            n_periods: ((n_samples as f64 + 0.5) / period) as usize,
            excited: LineDft::new(length, lines)?,
            lowest: LineDft::new(length, &lowest)?,
        })
    }

    /// Spectra on the excited lines, `(period, line)`, of the samples at `times`.
    pub(super) fn spectra(
        &self,
        times: &[f64],
        values: &[f64],
    ) -> Result<Array2<Complex64>, EstimateError> {
        self.excited
            .transform("run", self.cut(times, values).view())
    }

    /// Noise variance of a sample as slow trends meet it: the largest of those from the spread over
    /// periods on the lowest lines, and of the periods' means where there are enough of them.
    pub(super) fn slow_variance(&self, times: &[f64], model: &Model) -> Result<f64, EstimateError> {
        let windows = self.cut(times, &model.residual);
        let length = self.excited.n_samples() as f64;
        let spectra = self.lowest.transform("run", windows.view())?;
        let power: f64 = spectra.iter().map(Complex64::norm_sqr).sum();
        let n_values = (self.n_periods - 1) * spectra.ncols();
        let of_lines = power / length / n_values as f64;
        let n_free = self.n_periods.saturating_sub(1 + model.n_parameters);
        if n_free == 0 {
            return Ok(of_lines);
        }
        let means = windows.sum_axis(Axis(1)) / length;
        let of_means = length * means.dot(&means) / n_free as f64;
        Ok(of_means.max(of_lines))
    }

    /// Window after window, lost samples at zero and the others weighted for them.
    fn cut(&self, times: &[f64], values: &[f64]) -> Array2<f64> {
        let length = self.excited.n_samples();
        let mut windows = Array2::zeros((self.n_periods, length));
        let mut counts = vec![0_usize; self.n_periods];
        for (time, value) in zip(times, values) {
            let window = ((time + 0.5) / self.period) as usize;
            let start = (window as f64 * self.period).round();
            if let Some(place) = windows.get_mut((window, (time - start) as usize)) {
                *place = *value;
                counts[window] += 1;
            }
        }
        for (mut window, count) in zip(windows.rows_mut(), counts) {
            window *= (length as f64 / count.max(1) as f64).sqrt();
        }
        windows
    }
}
