//! Periods of a record: which are whole, what its signals are in them, where they belong in the campaign.

use frfid_estimate::{PeriodIndex, RunSpectra};
use frfid_signals::{Record, RunId};
use ndarray::{Array2, ArrayView2, s};

use crate::error::ExperimentError;
use crate::estimate::estimator::Estimator;
use crate::estimate::glides::ripple_residual::OnFreeLines;

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

    /// Spectra of one period of a record, on the lines and on the free ones around them.
    pub(super) fn period(
        &self,
        record: &Record,
        period: usize,
    ) -> Result<(RunSpectra, Option<OnFreeLines>), ExperimentError> {
        let [u, y] = self.inputs_and_outputs(record, period);
        let r = self.options.reference_of(record);
        let r = r.map(|r| self.of_period(r, period));
        let on_lines = RunSpectra::of(&*self.evaluation.transform, u, y, r)?;
        let free = self.residual.as_ref();
        let free = free.map(|residual| residual.spectra(u, y)).transpose()?;
        Ok((on_lines, free))
    }

    /// Inputs and outputs of a period.
    pub(super) fn inputs_and_outputs<'r>(
        &self,
        record: &'r Record,
        period: usize,
    ) -> [ArrayView2<'r, f64>; 2] {
        [&record.u, &record.y].map(|signal| self.of_period(signal, period))
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
