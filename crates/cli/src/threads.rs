//! Threads for parallel work: one for each core, or none beside the first where the system gives no more.

use std::sync::OnceLock;

use rayon::ThreadPoolBuilder;

/// Whether the system refuses threads. Parallel work is done on the thread that asked first, which is
/// the one of the command; a bound on processes (`ulimit -u`, the pids of a container) makes a command
/// slow, not impossible.
pub(crate) fn are_refused() -> bool {
    static REFUSED: OnceLock<bool> = OnceLock::new();
    *REFUSED.get_or_init(|| {
        // the common pool is made once: whether it can be is tried with another
        let is_refused = ThreadPoolBuilder::new().build().is_err();
        if is_refused {
            let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
            alone.build_global().ok();
        }
        is_refused
    })
}
