//! Signal of a plan without a model: what all its references reach.

use crate::error::ExperimentError;
use crate::run::parallel::{Progress, Steps, for_each};
use crate::run::planned_runs::{PlannedRuns, first_repetitions};
use crate::run::signal::SignalPeaks;

impl PlannedRuns {
    /// What the references reach.
    ///
    /// # Errors
    /// [`ExperimentError`]: a damaged plan file, or an interruption.
    pub fn signal_peaks(
        &self,
        jobs: usize,
        progress: Progress,
    ) -> Result<SignalPeaks, ExperimentError> {
        let ids = first_repetitions(&self.experiment.plan);
        let steps = Steps {
            progress,
            before: 0,
            total: ids.len(),
        };
        let peaks = for_each(&ids, jobs, steps, |id, go_on| {
            let run = self.run_while(*id, go_on)?;
            Ok(SignalPeaks::of(&run, self.experiment.plan.injection))
        })?;
        Ok(peaks
            .into_iter()
            .reduce(SignalPeaks::larger)
            .expect("a plan has runs"))
    }
}
