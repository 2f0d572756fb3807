//! The whole workflow without files: runs on a testbed, estimate from its records.

use std::sync::Mutex;

use frfid_signals::{Plan, Record, Run, RunId, Testbed};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::estimator::{Estimated, Estimator, Spectra};
use crate::experiment::Experiment;
use crate::run::parallel::{Progress, run_all};

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
        let [estimated] =
            self.measure_each([&self.config.estimate], testbed, jobs, progress, &|_, _| {
                Ok(())
            })?;
        Ok(estimated)
    }

    /// Does every run once and estimates the FRF in several ways, one for each table; `look` sees
    /// every record before it goes.
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
        let mut estimators = ways
            .iter()
            .map(|way| Estimator::new(&self.plan, way))
            .collect::<Result<Vec<_>, ExperimentError>>()?;
        let comes_first = |id: &RunId| {
            estimators
                .iter()
                .any(|estimator| estimator.comes_first(*id))
        };
        let (first, rest): (Vec<RunId>, Vec<RunId>) = self.plan.run_ids().partition(comes_first);
        let total = first.len() + rest.len();
        let records: Mutex<Vec<(RunId, Record)>> = Mutex::default();
        let reference = |id| Ok(self.plan.run(id)?);
        let of_all = |done: usize, _: usize| progress(done, total);
        run_all(
            &first,
            &reference,
            testbed,
            jobs,
            &of_all,
            &|run, record| {
                look(run, &record)?;
                records
                    .lock()
                    .expect("no holder of the lock panics")
                    .push((run.id, record));
                Ok(())
            },
        )?;
        let mut records = records.into_inner().expect("no holder of the lock panics");
        // a mean over them is then the same whatever the order in which they came
        records.sort_by_key(|(id, _)| *id);
        estimators
            .iter_mut()
            .try_for_each(|estimator| estimator.prepare(&records))?;
        let spectra: [Mutex<Spectra>; N] = std::array::from_fn(|_| Mutex::default());
        let estimate = |id: RunId, record: &Record| {
            for (estimator, spectra) in estimators.iter().zip(&spectra) {
                let periods = estimator.spectra(id, record, &|_| false)?;
                spectra
                    .lock()
                    .expect("no holder of the lock panics")
                    .extend(periods);
            }
            Ok(())
        };
        records
            .iter()
            .try_for_each(|(id, record)| estimate(*id, record))?;
        drop(records);
        let of_all = |done: usize, _: usize| progress(first.len() + done, total);
        run_all(&rest, &reference, testbed, jobs, &of_all, &|run, record| {
            look(run, &record)?;
            estimate(run.id, &record)
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
    let mut first: Vec<_> = records
        .iter()
        .filter(|(id, _)| estimator.comes_first(*id))
        .cloned()
        .collect();
    first.sort_by_key(|(id, _)| *id);
    estimator.prepare(&first)?;
    let mut spectra = Spectra::default();
    for (id, record) in records {
        spectra.extend(estimator.spectra(*id, record, &|_| false)?);
    }
    estimator.estimate(spectra)
}
