//! The whole workflow without files: runs on a testbed, estimate from its records.

use std::sync::Mutex;

use frfid_signals::{Plan, Record, Run, RunId, RunKind, Testbed};

use crate::campaign::{Progress, run_all};
use crate::config::EstimateTable;
use crate::estimator::{Estimated, Estimator, Spectra};
use crate::{Experiment, ExperimentError};

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
        let [estimated] = self.measure_each([&self.config.estimate], testbed, jobs, progress, &|_, _| Ok(()))?;
        Ok(estimated)
    }

    /// Does every run once and estimates the FRF in several ways, one for each table; `look` sees every record before it goes.
    ///
    /// # Errors
    /// As [`Experiment::measure`], and those of `look`.
    pub fn measure_each<const N: usize>(
        &self,
        ways: [&EstimateTable; N],
        testbed: &dyn Testbed,
        jobs: usize,
        progress: Progress,
        look: &(dyn Fn(&Run, &Record) -> Result<(), ExperimentError> + Sync),
    ) -> Result<[Estimated; N], ExperimentError> {
        let ids: Vec<RunId> = self.plan.run_ids().collect();
        let (glides, excited) = ids.split_at(self.plan.n_glides);
        let mut estimators =
            ways.iter().map(|way| Estimator::new(&self.plan, way)).collect::<Result<Vec<_>, ExperimentError>>()?;
        let records: Mutex<Vec<(RunId, Record)>> = Mutex::default();
        let reference = |id| Ok(self.plan.run(id)?);
        let of_all = |done: usize, _: usize| progress(done, ids.len());
        run_all(glides, &reference, testbed, jobs, &of_all, &|run, record| {
            look(run, &record)?;
            records.lock().expect("no holder of the lock panics").push((run.id, record));
            Ok(())
        })?;
        let glide_records = sorted(records);
        estimators.iter_mut().try_for_each(|estimator| estimator.set_glides(&glide_records))?;
        if estimators.iter().any(Estimator::learns_ripple) {
            let learned = learning_runs(&ids).map(|id| Ok((id, testbed.run(&self.plan.run(id)?)?)));
            let learned = learned.collect::<Result<Vec<_>, ExperimentError>>()?;
            let learners = estimators.iter_mut().filter(|estimator| estimator.learns_ripple());
            learners.into_iter().try_for_each(|estimator| estimator.learn_ripple(&learned))?;
        }
        let spectra: [Mutex<Spectra>; N] = std::array::from_fn(|_| Mutex::default());
        let of_all = |done: usize, _: usize| progress(glides.len() + done, ids.len());
        run_all(excited, &reference, testbed, jobs, &of_all, &|run, record| {
            look(run, &record)?;
            for (estimator, spectra) in estimators.iter().zip(&spectra) {
                let periods = estimator.spectra(run.id, &record, &|_| false)?;
                spectra.lock().expect("no holder of the lock panics").extend(periods);
            }
            Ok(())
        })?;
        let estimated = estimators.iter().zip(spectra).map(|(estimator, spectra)| {
            estimator.estimate(spectra.into_inner().expect("no holder of the lock panics"))
        });
        let estimated = estimated.collect::<Result<Vec<_>, ExperimentError>>()?;
        Ok(estimated.try_into().expect("one estimate for each way"))
    }
}

/// Estimates the FRF of a plan from its records, glides and runs, in memory.
///
/// # Errors
/// [`ExperimentError`] for records that do not fit the plan or do not make an estimate.
pub fn estimate_records(
    plan: &Plan,
    options: &EstimateTable,
    records: &[(RunId, Record)],
) -> Result<Estimated, ExperimentError> {
    let mut estimator = Estimator::new(plan, options)?;
    let glides = records.iter().filter(|(id, _)| id.kind == RunKind::Glide);
    estimator.set_glides(&glides.map(|(_, record)| record.clone()).collect::<Vec<_>>())?;
    if estimator.learns_ripple() {
        let ids: Vec<RunId> = learning_runs(&records.iter().map(|(id, _)| *id).collect::<Vec<_>>()).collect();
        let learned = records.iter().filter(|(id, _)| ids.contains(id)).cloned();
        estimator.learn_ripple(&learned.collect::<Vec<_>>())?;
    }
    let mut spectra = Spectra::default();
    for (id, record) in records {
        spectra.extend(estimator.spectra(*id, record, &|_| false)?);
    }
    estimator.estimate(spectra)
}

/// One run of every experiment of the first realization.
fn learning_runs(ids: &[RunId]) -> impl Iterator<Item = RunId> {
    let is_first = |id: &&RunId| id.kind == RunKind::Excitation && id.realization == 0 && id.repetition == 0;
    ids.iter().filter(is_first).copied()
}

/// The records in the order of their runs, whatever the order in which they came: a mean over them is then always the same.
fn sorted(records: Mutex<Vec<(RunId, Record)>>) -> Vec<Record> {
    let mut records = records.into_inner().expect("no holder of the lock panics");
    records.sort_by_key(|(id, _)| *id);
    records.into_iter().map(|(_, record)| record).collect()
}
