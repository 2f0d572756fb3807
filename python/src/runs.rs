//! Doing runs on a testbed while the interpreter goes on.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use frfid_experiment::ExperimentError;
use frfid_experiment::campaign::run_all;
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
        records.lock().unwrap_or_else(PoisonError::into_inner).insert(run.id, record);
        Ok(())
    };
    interruptible(py, progress, |progress| {
        run_all(ids, reference, testbed, jobs, &|done, total| progress.report(done, total), &keep)
    })?
    .map_err(error::experiment)?;
    let mut records = records.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(ids.iter().filter_map(|id| records.remove(id)).collect())
}
