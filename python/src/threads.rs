//! Threads that compute for Python: a pool for every process, since threads do not survive a fork.

use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The pool, and the process that has its threads.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Computes detached from the interpreter, on the threads of this process.
///
/// # Errors
/// `RuntimeError` where the system refuses threads.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool(py)?;
    Ok(py.detach(|| pool.install(work)))
}

/// The pool of this process. Who holds the interpreter forks, and nobody else is in here then.
pub(crate) fn pool(_py: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((process, pool)) = &*kept
        && *process == process::id()
    {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().build().map_err(|reason| {
        PyRuntimeError::new_err(format!(
            "no threads to compute on: {reason}; allow more processes, or set RAYON_NUM_THREADS=1"
        ))
    })?;
    pool.broadcast(|_| ()); // each of its threads has then looked up what it needs, before anybody may fork
    let pool = Arc::new(pool);
    let of_parent = kept.replace((process::id(), Arc::clone(&pool)));
    std::mem::forget(of_parent); // its threads are not here: nobody would answer that it ends
    Ok(pool)
}
