//! Threads for parallel work outside of what is watched: the common pool, or this thread alone where
//! the system gives no others.

use rayon::ThreadPoolBuilder;

/// Makes this thread the common pool where the system refuses threads: a bound on processes
/// (`ulimit -u`, the pids of a container) makes a command slow, not impossible.
pub(crate) fn settle() {
    // the common pool is made once: whether it can be is tried with another
    if ThreadPoolBuilder::new().build().is_err() {
        let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
        alone.build_global().ok(); // an error says that there is one
    }
}
