//! The whole workflow without files: runs on a testbed, estimate from its records.

use std::sync::Mutex;

use frfid_estimate::Place;
use frfid_signals::{Frf, Record, RunId, Testbed};

use crate::campaign::{Progress, run_all};
use crate::estimator::{Estimator, PeriodSpectra};
use crate::{Experiment, ExperimentError};

/// An FRF with what was left out of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// The FRF.
    pub frf: Frf,
    /// Runs that were missing: their periods are not in the estimate.
    pub missing: Vec<Place>,
}

impl Experiment {
    /// Does every run of the plan on `testbed` and estimates the FRF; only spectra are kept.
    ///
    /// # Errors
    /// [`ExperimentError`] of a run or of the estimate, or an interruption.
    pub fn measure(
        &self,
        testbed: &dyn Testbed,
        jobs: usize,
        progress: Progress,
    ) -> Result<Estimated, ExperimentError> {
        let ids: Vec<RunId> = self.plan.run_ids().collect();
        let (glides, excited) = ids.split_at(self.plan.n_glides);
        let mut estimator = Estimator::new(&self.plan, &self.config.estimate)?;
        let records: Mutex<Vec<(RunId, Record)>> = Mutex::default();
        let reference = |id| Ok(self.plan.run(id)?);
        let of_all = |done: usize, _: usize| progress(done, ids.len());
        run_all(glides, &reference, testbed, jobs, &of_all, &|run, record| {
            records.lock().expect("no holder of the lock panics").push((run.id, record));
            Ok(())
        })?;
        estimator.set_glides(&sorted(records))?;
        let spectra: Mutex<PeriodSpectra> = Mutex::default();
        let of_all = |done: usize, _: usize| progress(glides.len() + done, ids.len());
        run_all(excited, &reference, testbed, jobs, &of_all, &|run, record| {
            let periods = estimator.spectra(run.id, &record, &|_| false)?;
            spectra.lock().expect("no holder of the lock panics").extend(periods);
            Ok(())
        })?;
        let (frf, missing) = estimator.estimate(spectra.into_inner().expect("no holder of the lock panics"))?;
        Ok(Estimated { frf, missing })
    }
}

/// The records in the order of their runs, whatever the order in which they came: a mean over them is then always the same.
fn sorted(records: Mutex<Vec<(RunId, Record)>>) -> Vec<Record> {
    let mut records = records.into_inner().expect("no holder of the lock panics");
    records.sort_by_key(|(id, _)| *id);
    records.into_iter().map(|(_, record)| record).collect()
}
