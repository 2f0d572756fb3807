//! Doing runs on a testbed: simulated ones side by side while the interpreter goes on, those of
//! Python one by one.

use frfid_experiment::ExperimentError;
use frfid_experiment::{Steps, for_each_group};
use frfid_signals::{GoOn, Record, Run, RunId, Testbed};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;
use crate::interrupt::interruptible;
use crate::signals::record::Record as PyRecord;

/// The records of the runs `ids`, in this order, done on `jobs` threads (0: one for each core).
pub(crate) fn records_of(
    py: Python<'_>,
    ids: &[RunId],
    reference: &(dyn Fn(RunId, GoOn) -> Result<Run, ExperimentError> + Sync),
    testbed: &dyn Testbed,
    jobs: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Record>> {
    interruptible(py, progress, |progress| {
        let steps = Steps {
            progress: &|done, total| progress.report(done, total),
            before: 0,
            total: ids.len(),
        };
        for_each_group(ids, testbed.n_at_once(), jobs, steps, |ids, go_on| {
            let runs = ids.iter().map(|id| reference(*id, go_on));
            let runs: Vec<Run> = runs.collect::<Result<_, _>>()?;
            let records = testbed.run_each(&runs, go_on).into_iter();
            records.map(|record| Ok(record?)).collect()
        })
    })?
    .map_err(error::experiment)
}

/// The records of the runs `ids`, done one after the other on the calling thread: a testbed written
/// in Python hears Ctrl-C in the middle of its run, where it can stop its machine.
pub(crate) fn one_by_one(
    py: Python<'_>,
    ids: &[RunId],
    reference: &(dyn Fn(RunId, GoOn) -> Result<Run, ExperimentError> + Sync),
    testbed: &dyn Testbed,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Record>> {
    let tell = |done: usize| {
        progress.map_or(Ok(()), |callable| {
            callable.call1((done, ids.len())).map(drop)
        })
    };
    tell(0)?;
    let mut records = Vec::new();
    for &id in ids {
        let run = interruptible(py, None, |progress| reference(id, &|| progress.goes_on()))?;
        let run = run.map_err(error::experiment)?;
        let record = py.detach(|| testbed.run(&run));
        records.push(record.map_err(error::testbed)?);
        tell(records.len())?;
    }
    Ok(records)
}

/// Records of Python by their runs; a run without one is missing.
///
/// # Errors
/// `ValueError` for another number of records than runs, or a batch.
pub(crate) fn measured(
    py: Python<'_>,
    ids: Vec<RunId>,
    records: &[Option<Bound<'_, PyRecord>>],
) -> PyResult<Vec<(RunId, Record)>> {
    if records.len() != ids.len() {
        let (found, needed) = (records.len(), ids.len());
        return Err(PyValueError::new_err(format!(
            "{found} records were given, needed one for each of {needed} runs"
        )));
    }
    let there = ids.into_iter().zip(records);
    let there = there.filter_map(|(id, record)| Some((id, record.as_ref()?)));
    let one_run = |(id, record): (RunId, &Bound<'_, PyRecord>)| {
        let Ok([run]) = <[Record; 1]>::try_from(record.get().runs(py)) else {
            return Err(PyValueError::new_err(format!(
                "the record of run {id} is a batch, needed one run"
            )));
        };
        Ok((id, run))
    };
    there.map(one_run).collect()
}
