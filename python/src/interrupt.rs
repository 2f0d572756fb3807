//! Long calls that answer Ctrl-C and report progress: a worker thread computes, the calling thread listens, and neither holds
//! the interpreter.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// How often the calling thread looks for Ctrl-C.
const WAKE: Duration = Duration::from_millis(50);

/// The worker's end: where it tells how far it is, and hears that it should stop. Threads may share it.
pub struct Progress<'a> {
    reports: Sender<(usize, usize)>,
    done: Mutex<usize>,
    stop: &'a AtomicBool,
}

impl Progress<'_> {
    /// Reports one more step of `total`.
    pub fn step(&self, total: usize) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner); // held while sending: reports keep their order
        *done += 1;
        let _ = self.reports.send((*done, total)); // nobody listens once the call was interrupted: `wanted` says so
    }

    /// Whether the result is still wanted.
    pub fn wanted(&self) -> bool {
        !self.stop.load(Ordering::Relaxed)
    }
}

/// Does `work` on another thread, detached from the interpreter. An exception out of `progress(done, total)`, or Ctrl-C,
/// stops it before its next step and is returned.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Progress<'_>) -> T + Send,
) -> PyResult<T> {
    let callback = progress.map(|callable| callable.clone().unbind());
    let stop = AtomicBool::new(false);
    py.detach(|| {
        thread::scope(|scope| {
            let (reports, inbox) = channel();
            let stop = &stop;
            let worker = scope.spawn(move || work(&Progress { reports, done: Mutex::new(0), stop }));
            let listened = listen(&inbox, callback.as_ref());
            stop.store(listened.is_err(), Ordering::Relaxed);
            let value = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            listened.map(|()| value)
        })
    })
}

/// Passes reports on until the worker has finished.
fn listen(inbox: &Receiver<(usize, usize)>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
    loop {
        let report = match inbox.recv_timeout(WAKE) {
            Ok(report) => Some(report),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        };
        Python::attach(|py| {
            if let (Some(callback), Some(report)) = (callback, report) {
                callback.call1(py, report)?;
            }
            py.check_signals()
        })?;
    }
}
