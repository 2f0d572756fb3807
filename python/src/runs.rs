//! Doing runs on a testbed: simulated ones side by side while the interpreter goes on, those of
//! Python one by one.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use frfid_experiment::{ExperimentError, run_all};
use frfid_signals::{Record, Run, RunId, Testbed};
use pyo3::prelude::*;

use crate::error;
use crate::interrupt::interruptible;

/// The records of the runs `ids`, in this order, done on `jobs` threads (0: one for each core).
pub fn records_of(
    py: Python<'_>,
    ids: &[RunId],
    reference: &(dyn Fn(RunId) -> Result<Run, ExperimentError> + Sync),
    testbed: &dyn Testbed,
    jobs: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Record>> {
    let records: Mutex<BTreeMap<RunId, Record>> = Mutex::default();
    let keep = |run: &Run, record: Record| {
        records
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .insert(run.id, record);
        Ok(())
    };
    interruptible(py, progress, |progress| {
        run_all(
            ids,
            reference,
            testbed,
            jobs,
            &|done, total| progress.report(done, total),
            &keep,
        )
    })?
    .map_err(error::experiment)?;
    let mut records = records.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(ids.iter().filter_map(|id| records.remove(id)).collect())
}

/// The records of the runs `ids`, done one after the other on the calling thread: a testbed written
/// in Python hears Ctrl-C in the middle of its run, where it can stop its machine.
pub fn one_by_one(
    py: Python<'_>,
    ids: &[RunId],
    reference: &(dyn Fn(RunId) -> Result<Run, ExperimentError> + Sync),
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
        let record = py.detach(|| reference(id).and_then(|run| Ok(testbed.run(&run)?)));
        records.push(record.map_err(error::experiment)?);
        tell(records.len())?;
    }
    Ok(records)
}
