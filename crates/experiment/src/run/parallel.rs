//! Parallel work on many runs: the results come in the order of the runs, whatever the number of
//! jobs.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use frfid_signals::{GoOn, Record, Run, SignalError, Testbed, TestbedError};
use rayon::prelude::*;

use crate::error::ExperimentError;
use crate::experiment::Experiment;

/// Called after each step, and while long ones last, with how many of how many are done; returns whether to go on.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) -> bool + Sync);

/// A progress that nobody watches.
#[must_use]
pub fn silent(_done: usize, _total: usize) -> bool {
    true
}

/// Which steps of a longer work come next, and where they are reported.
#[derive(Clone, Copy)]
pub struct Steps<'a> {
    /// Called after every step.
    pub progress: Progress<'a>,
    /// Steps done before.
    pub before: usize,
    /// Steps in all.
    pub total: usize,
}

/// Does `work` for each of `items` on `jobs` threads (0: one for each core; never more than items),
/// a step each; the results are in the order of the items. Long steps ask whether to go on.
///
/// # Errors
/// The first error of `work`, or [`ExperimentError::Interrupted`] when the progress said so. Work
/// that was already under way, and does not ask, is finished.
pub fn for_each<I: Sync, T: Send>(
    items: &[I],
    jobs: usize,
    steps: Steps,
    work: impl Fn(&I, GoOn) -> Result<T, ExperimentError> + Sync,
) -> Result<Vec<T>, ExperimentError> {
    for_each_group(items, 1, jobs, steps, |group, go_on| {
        group.iter().map(|item| work(item, go_on)).collect()
    })
}

/// The same with work on up to `n_at_once` neighbouring items at a time, as many as keep all threads
/// busy; a step each is an item still. One job is done on this very thread.
///
/// # Errors
/// As [`for_each`].
pub fn for_each_group<I: Sync, T: Send>(
    items: &[I],
    n_at_once: usize,
    jobs: usize,
    steps: Steps,
    work: impl Fn(&[I], GoOn) -> Result<Vec<T>, ExperimentError> + Sync,
) -> Result<Vec<T>, ExperimentError> {
    let Steps {
        progress,
        before,
        total,
    } = steps;
    let (done, stop) = (
        AtomicUsize::new(before),
        AtomicBool::new(!progress(before, total)),
    );
    let interrupted = || ExperimentError::Interrupted {
        done: done.load(Ordering::Relaxed),
        total,
    };
    let go_on = || !stop.load(Ordering::Relaxed) && progress(done.load(Ordering::Relaxed), total);
    let of_group = |group: &[I]| {
        if stop.load(Ordering::Relaxed) {
            return Err(interrupted());
        }
        let results = work(group, &go_on).map_err(|error| told(error, interrupted()))?;
        for _ in group {
            if !progress(1 + done.fetch_add(1, Ordering::Relaxed), total) {
                stop.store(true, Ordering::Relaxed);
            }
        }
        Ok(results)
    };
    of_each_group(items, n_at_once, jobs.min(items.len()), of_group)
}

/// What comes of every group, in order.
fn of_each_group<I: Sync, T: Send>(
    items: &[I],
    n_at_once: usize,
    jobs: usize,
    of_group: impl Fn(&[I]) -> Result<Vec<T>, ExperimentError> + Sync,
) -> Result<Vec<T>, ExperimentError> {
    let in_order = |results: Vec<Vec<T>>| results.into_iter().flatten().collect();
    if jobs == 1 {
        let groups = items.chunks(n_at_once.max(1)).map(of_group);
        return groups.collect::<Result<_, _>>().map(in_order);
    }
    in_pool(jobs, || {
        let for_threads = items.len().div_ceil(rayon::current_num_threads());
        let groups = items.par_chunks(n_at_once.min(for_threads).max(1));
        let results: Result<_, _> = groups.map(&of_group).collect();
        results.map(in_order)
    })
}

/// Most samples of all axes together in the runs that a thread does at once: their records are in
/// memory until they are written.
const SAMPLES_AT_ONCE: usize = 1_000_000;

/// How many runs of an experiment a thread does at once on a testbed.
pub(crate) fn n_at_once(
    experiment: &Experiment,
    testbed: &dyn Testbed,
) -> Result<usize, ExperimentError> {
    let of_a_run = experiment
        .plan
        .run_samples()?
        .saturating_mul(testbed.n_inputs());
    Ok(testbed
        .n_at_once()
        .min(SAMPLES_AT_ONCE / of_a_run.max(1))
        .max(1))
}

/// Does runs at once on a testbed, each to its end, and keeps every record that came of one, whatever
/// comes of the others.
///
/// # Errors
/// The first error of a run, or of `keep`.
pub(crate) fn kept_each<T>(
    runs: &[Run],
    testbed: &dyn Testbed,
    keep: impl Fn(&Run, Record) -> Result<T, ExperimentError>,
) -> Result<Vec<T>, ExperimentError> {
    let records = testbed.run_each(runs, &|| true);
    let of_runs = runs.iter().zip(records);
    let kept: Vec<_> = of_runs.map(|(run, record)| keep(run, record?)).collect();
    kept.into_iter().collect()
}

/// The error of a step; `interrupted` if it ended in the middle because it was told to.
pub(crate) fn told(error: ExperimentError, interrupted: ExperimentError) -> ExperimentError {
    match error {
        ExperimentError::Signal(SignalError::Interrupted)
        | ExperimentError::Testbed(TestbedError::Run(SignalError::Interrupted)) => interrupted,
        error => error,
    }
}

/// Runs `work` with a pool of its own, a thread for each core; where the system refuses threads, on this thread alone.
pub fn on_threads<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let this_thread = || {
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1);
        alone.use_current_thread().build()
    };
    let pool = rayon::ThreadPoolBuilder::new().build();
    match pool.or_else(|_| this_thread()) {
        Ok(pool) => pool.install(work),
        Err(_) => work(), // this thread is in a pool already, which is then used
    }
}

/// Runs `work` in a pool of `jobs` threads (0: the pool of this thread, or the common one).
///
/// # Errors
/// Those of `work`, and [`ExperimentError::Threads`].
pub fn in_pool<T: Send>(
    jobs: usize,
    work: impl FnOnce() -> Result<T, ExperimentError> + Send,
) -> Result<T, ExperimentError> {
    if jobs == 0 {
        return work();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| ExperimentError::Threads {
        jobs,
        reason: error.to_string(),
    })?;
    pool.install(work)
}
