//! Long calls that answer Ctrl-C and report progress: a worker thread computes, the calling thread
//! listens, and neither holds the interpreter.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

use crate::threads::pool;

/// How often the calling thread looks for Ctrl-C.
const WAKE: Duration = Duration::from_millis(50);

/// The worker's end: where it tells how far it is, and hears that it should stop. Threads may share
/// it.
pub(crate) struct Progress<'a> {
    reports: Sender<(usize, usize)>,
    stop: &'a AtomicBool,
}

impl Progress<'_> {
    /// Reports `done` of `total` and says whether to go on.
    pub(crate) fn report(&self, done: usize, total: usize) -> bool {
        let _ = self.reports.send((done, total)); // nobody listens any more once the call was interrupted: `stop` says so
        self.goes_on()
    }

    /// Whether to go on.
    pub(crate) fn goes_on(&self) -> bool {
        !self.stop.load(Ordering::Relaxed)
    }
}

/// Does `work` on another thread, detached from the interpreter. An exception out of
/// `progress(done, total)`, or Ctrl-C, stops it at its next [`Progress::report`] and is returned.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Progress<'_>) -> T + Send,
) -> PyResult<T> {
    let callback = progress.map(|callable| callable.clone().unbind());
    let (pool, stop) = (pool(py)?, AtomicBool::new(false));
    py.detach(|| {
        thread::scope(|scope| {
            let (reports, inbox) = channel();
            let (pool, stop) = (&pool, &stop);
            let work = move || pool.install(|| work(&Progress { reports, stop }));
            let worker = thread::Builder::new().spawn_scoped(scope, work)?;
            let listened = listen(&inbox, callback.as_ref());
            stop.store(listened.is_err(), Ordering::Relaxed);
            let value = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            listened.map(|()| value)
        })
    })
}

/// Passes reports on until the worker has finished. Threads may report out of order, and again while a
/// step lasts: what is overtaken, or told already, is left out.
fn listen(inbox: &Receiver<(usize, usize)>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
    let mut furthest = None;
    loop {
        let report = match inbox.recv_timeout(WAKE) {
            Ok(report) => Some(report),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        };
        Python::attach(|py| {
            if let (Some(callback), Some((done, total))) = (callback, report)
                && Some(done) > furthest
            {
                furthest = Some(done);
                callback.call1(py, (done, total))?;
            }
            py.check_signals()
        })?;
    }
}
