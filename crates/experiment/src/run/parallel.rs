//! Doing the runs of a plan on a testbed, several at once: the records do not depend on the number
//! of jobs.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use frfid_signals::{Record, Run, RunId, Testbed};
use rayon::prelude::*;

use crate::error::ExperimentError;

/// Told after each step how many of how many are done; returns whether to go on.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) -> bool + Sync);

/// A progress that nobody watches.
#[must_use]
pub fn silent(_done: usize, _total: usize) -> bool {
    true
}

/// Does the runs `ids` on `jobs` threads (0: one for each core) and hands each record to `keep`, in
/// no particular order.
///
/// `reference` gives the run to an id: [`frfid_signals::Plan::run`], or a reader of a plan file.
/// Memory is that of `jobs` records.
///
/// # Errors
/// The first error of reference, testbed or `keep`; [`ExperimentError::Interrupted`] when
/// `progress` said so. Runs that were already under way are finished and kept.
pub fn run_all(
    ids: &[RunId],
    reference: &(dyn Fn(RunId) -> Result<Run, ExperimentError> + Sync),
    testbed: &dyn Testbed,
    jobs: usize,
    progress: Progress,
    keep: &(dyn Fn(&Run, Record) -> Result<(), ExperimentError> + Sync),
) -> Result<(), ExperimentError> {
    let (done, stop) = (
        AtomicUsize::new(0),
        AtomicBool::new(!progress(0, ids.len())),
    );
    let one = |&id: &RunId| {
        if stop.load(Ordering::Relaxed) {
            return Err(ExperimentError::Interrupted {
                done: done.load(Ordering::Relaxed),
                total: ids.len(),
            });
        }
        let run = reference(id)?;
        let record = testbed.run(&run)?;
        keep(&run, record)?;
        if !progress(1 + done.fetch_add(1, Ordering::Relaxed), ids.len()) {
            stop.store(true, Ordering::Relaxed);
        }
        Ok(())
    };
    in_pool(jobs, || ids.par_iter().try_for_each(one))
}

/// Runs `work` in a pool of `jobs` threads (0: the common pool, one for each core).
///
/// # Errors
/// Those of `work`, or [`ExperimentError::Threads`] if the threads cannot be started.
pub fn in_pool<T: Send>(
    jobs: usize,
    work: impl FnOnce() -> Result<T, ExperimentError> + Send,
) -> Result<T, ExperimentError> {
    if jobs == 0 {
        return work();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    pool.map_err(|error| ExperimentError::Threads {
        jobs,
        reason: error.to_string(),
    })?
    .install(work)
}
