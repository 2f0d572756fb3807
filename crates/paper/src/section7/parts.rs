//! Progress of campaigns that are done side by side, as one.

use std::sync::atomic::{AtomicUsize, Ordering};

use frfid_experiment::Progress;

/// What the campaigns cost, in percent of the whole: multisine, chirps (9), chirps (26), the paper's step, table 1.
const SHARES: [usize; 5] = [36, 17, 17, 19, 11];

/// The campaigns of the section.
pub(super) struct Parts<'a> {
    whole: Progress<'a>,
    /// Of each what is done, in percent of the whole.
    done: [AtomicUsize; SHARES.len()],
}

impl<'a> Parts<'a> {
    /// None of them begun.
    pub(super) fn of(whole: Progress<'a>) -> Self {
        let done = Default::default();
        Self { whole, done }
    }

    /// The progress of one of the campaigns, reported as that of the whole.
    pub(super) fn of_part(&self, number: usize) -> impl Fn(usize, usize) -> bool + Sync {
        move |done, total| {
            let share = SHARES[number] * done / total.max(1);
            self.done[number].fetch_max(share, Ordering::Relaxed); // threads may report in another order
            let all = self.done.iter().map(|part| part.load(Ordering::Relaxed));
            (self.whole)(all.sum(), 100)
        }
    }
}
