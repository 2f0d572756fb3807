//! Periods of a record: which are whole, what its signals are in them, where they belong in the campaign.

use frfid_estimate::{PeriodIndex, RunSpectra};
use frfid_signals::{Record, RunId};
use ndarray::{Array2, ArrayView2, s};

use crate::error::ExperimentError;
use crate::estimate::estimator::Estimator;
use crate::estimate::glides::ripple_residual::OnFreeLines;

/// Signals of one period of a record, `(channel, sample)`.
pub(super) struct Signals<'r> {
    pub(super) u: ArrayView2<'r, f64>,
    pub(super) y: ArrayView2<'r, f64>,
    pub(super) r: Option<ArrayView2<'r, f64>>,
}

impl Estimator {
    /// The complete periods of a record that are not lost.
    pub(super) fn kept(&self, record: &Record, lost: &dyn Fn(usize) -> bool) -> Vec<usize> {
        let complete = 0..self.n_complete(record);
        complete.filter(|&period| !lost(period)).collect()
    }

    /// Number of planned periods that a record holds from their beginning to their end.
    pub(super) fn n_complete(&self, record: &Record) -> usize {
        let after_lead_in = record
            .n_steady_samples()
            .saturating_sub(self.plan.lead_in_samples);
        (after_lead_in / self.period_samples).min(self.plan.n_periods)
    }

    /// One period of a record.
    pub(super) fn window<'r>(&self, record: &'r Record, period: usize) -> Signals<'r> {
        let reference = self.options.reference_of(record);
        Signals {
            u: self.of_period(&record.u, period),
            y: self.of_period(&record.y, period),
            r: reference.map(|r| self.of_period(r, period)),
        }
    }

    /// Spectra of a period of a glide, on the lines and on the free ones around them.
    pub(super) fn period_of_glide(
        &self,
        glide: &Record,
        period: usize,
    ) -> Result<(RunSpectra, Option<OnFreeLines>), ExperimentError> {
        let signals = self.window(glide, period);
        let &Signals { u, y, r } = &signals;
        let on_lines = RunSpectra::of(&*self.evaluation.transform, u, y, r)?;
        Ok((on_lines, self.free(&signals)?))
    }

    /// Spectra of a period on the lines, and on the detection lines where it is looked at there.
    pub(super) fn on_lines(
        &self,
        place: PeriodIndex,
        &Signals { u, y, r }: &Signals,
    ) -> Result<(RunSpectra, Option<RunSpectra>), ExperimentError> {
        let distortion = self.distortion.as_ref();
        let Some(lines) = distortion.and_then(|distortion| distortion.lines_for(place)) else {
            return Ok((RunSpectra::of(&*self.evaluation.transform, u, y, r)?, None));
        };
        let [on_lines, detection] = lines.spectra(u, y, r)?;
        Ok((on_lines, Some(detection)))
    }

    /// Spectra of a period on the free lines around the lines, where ripple is looked for.
    pub(super) fn free(&self, signals: &Signals) -> Result<Option<OnFreeLines>, ExperimentError> {
        let residual = self.residual.as_ref();
        let spectra = residual.map(|residual| residual.spectra(signals.u, signals.y));
        spectra.transpose()
    }

    /// What a signal `(channel, sample)` is in a period.
    pub(super) fn of_period<'r>(
        &self,
        signal: &'r Array2<f64>,
        period: usize,
    ) -> ArrayView2<'r, f64> {
        let start = self.plan.lead_in_samples + period * self.period_samples;
        signal.slice(s![.., start..start + self.period_samples])
    }

    /// Index of a period in the campaign: repetitions and periods back to back together are the
    /// estimator's periods.
    pub(super) fn place(&self, id: RunId, period: usize) -> PeriodIndex {
        let period = id.repetition * self.plan.n_periods + period;
        PeriodIndex {
            realization: id.realization,
            period,
            experiment: id.experiment,
        }
    }
}
