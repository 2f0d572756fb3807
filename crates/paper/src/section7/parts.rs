//! Progress of campaigns that are done side by side, as one.

use std::sync::atomic::{AtomicUsize, Ordering};

use frfid_experiment::Progress;

/// A campaign of the section.
#[derive(Clone, Copy)]
pub(super) enum Part {
    Multisine,
    /// Shaped chirps, SK15 (9).
    Orthogonal,
    /// Shaped chirps, SK15 (26).
    SignFlip,
    PaperStep,
    Table1,
}

/// How many there are.
const N_PARTS: usize = Part::Table1 as usize + 1;

impl Part {
    /// What it costs, in percent of the whole.
    const fn share(self) -> usize {
        match self {
            Self::Multisine => 36,
            Self::Orthogonal | Self::SignFlip => 17,
            Self::PaperStep => 19,
            Self::Table1 => 11,
        }
    }
}

/// The campaigns of the section.
pub(super) struct Parts<'a> {
    whole: Progress<'a>,
    /// Of each what is done, in percent of the whole.
    done: [AtomicUsize; N_PARTS],
}

impl<'a> Parts<'a> {
    /// None of them begun.
    pub(super) fn of(whole: Progress<'a>) -> Self {
        let done = Default::default();
        Self { whole, done }
    }

    /// The progress of one of the campaigns, reported as that of the whole.
    pub(super) fn of_part(&self, part: Part) -> impl Fn(usize, usize) -> bool + Sync {
        move |done, total| {
            let share = part.share() * done / total.max(1);
            self.done[part as usize].fetch_max(share, Ordering::Relaxed); // threads may report in another order
            let all = self.done.iter().map(|part| part.load(Ordering::Relaxed));
            (self.whole)(all.sum(), 100)
        }
    }
}
