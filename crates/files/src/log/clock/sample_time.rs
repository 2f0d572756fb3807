//! Sample time of a recording from its stamps, before it is known which sample each of them is.

use frfid_signals::greatest_common_divisor;

use crate::log::clock::evenness::{MOST_JITTER, half_spread};
use crate::log::clock::line::Line;
use crate::log::clock::phase::{WIDTHS, windows};
use crate::log::clock::rounded::{EVIDENCE, lossless, searched};
use crate::log::clock::slots::Slots;
use crate::log::clock::{OUT_OF_SLOT, agrees};

/// Stamps are coarse where they are whole multiples of more than this share of their typical step:
/// then the mean of the common steps need not be the sample time (800 Hz in whole ms has steps of 1
/// and 2 ms).
const COARSE: f64 = 0.3;
/// Stamps that a first guess is tried on.
const FIRST: usize = 4096;
/// Sample times in parts of the mean of the common steps that are tried if that fails: with 45 % of
/// the samples lost it is half as long again. A half or less would make an even clock of any.
const NEAR: (f64, f64) = (0.6, 1.1);
/// Number of them: 0.5 % apart, where windows of 16 stamps follow 3 %.
const N_NEAR: usize = 100;

/// The unit that all differences of the stamps are multiples of, in ns; 0 if they are all equal.
pub(crate) fn resolution_ns(stamps_ns: &[i64]) -> f64 {
    steps_ns(stamps_ns).fold(0, greatest_common_divisor) as f64
}

pub(crate) fn steps_ns(stamps_ns: &[i64]) -> impl Iterator<Item = u64> {
    let pairs = stamps_ns.windows(2);
    pairs.map(|pair| pair[1].abs_diff(pair[0]))
}

/// Grid that stamps are believed to lie on, before their slots are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Guess {
    /// Sample time in ns, a few percent off at most.
    pub(crate) step_ns: f64,
    /// Where the stamps lie on the grid.
    pub(crate) stamps: Place,
}

/// Where stamps lie on a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    /// Not known.
    Anywhere,
    /// Around this place between two samples, in steps: they are rounded.
    Around(f64),
    /// One on every sample, none lost: they are rounded.
    OnEvery,
}

impl Guess {
    /// The grid of rising stamps that are multiples of a unit.
    pub(crate) fn of(stamps_ns: &[i64], unit_ns: f64, stated_ns: Option<f64>) -> Self {
        match stated_ns {
            Some(stated_ns) => Self::stated(stamps_ns, unit_ns, stated_ns),
            None => Self::found(stamps_ns, unit_ns),
        }
    }

    fn anywhere(step_ns: f64) -> Self {
        Self {
            step_ns,
            stamps: Place::Anywhere,
        }
    }

    /// The grid of a sample time that the user knows.
    fn stated(stamps_ns: &[i64], unit_ns: f64, stated_ns: f64) -> Self {
        let anywhere = Self::anywhere(stated_ns);
        if !anywhere.is_coarse(unit_ns) {
            return anywhere;
        }
        lossless(stamps_ns, unit_ns, |step_ns| agrees(step_ns, stated_ns)).unwrap_or(anywhere)
    }

    /// Whether stamps that are multiples of a unit are coarse.
    fn is_coarse(&self, unit_ns: f64) -> bool {
        unit_ns > COARSE * self.step_ns
    }

    /// The step without gaps or, for coarse stamps, the even clock whose stamps they are the whole
    /// units of, if there is one.
    fn found(stamps_ns: &[i64], unit_ns: f64) -> Self {
        let typical = Self::anywhere(typical_step_ns(stamps_ns));
        let rounded = match typical.is_coarse(unit_ns) {
            true => Self::rounded(stamps_ns, unit_ns),
            false => None,
        };
        rounded.unwrap_or_else(|| typical.improved(stamps_ns))
    }

    /// The even clock whose stamps are the whole units of it.
    fn rounded(stamps_ns: &[i64], unit_ns: f64) -> Option<Self> {
        let is_likely =
            |step_ns: f64| stamps_ns.len() as f64 * (step_ns / unit_ns).ln() >= EVIDENCE;
        lossless(stamps_ns, unit_ns, is_likely).or_else(|| searched(stamps_ns, unit_ns))
    }

    /// This grid or, if the first stamps are far more even on it, the best of those near it: many
    /// losses, whose steps jitter makes shorter, lengthen the mean.
    fn improved(self, stamps_ns: &[i64]) -> Self {
        let first = &stamps_ns[..stamps_ns.len().min(FIRST)];
        if first.len() < 2 || self.step_ns <= 0.0 {
            return self;
        }
        let best = self.best_near(first);
        let most = (0.5 * self.spread(first)).min(0.5 * MOST_JITTER);
        match best.spread(first) < most {
            true => best,
            false => self,
        }
    }

    /// The grid near this one that stamps agree on best.
    fn best_near(self, stamps_ns: &[i64]) -> Self {
        let shares = (0..=N_NEAR).map(|k| NEAR.0 + (NEAR.1 - NEAR.0) * k as f64 / N_NEAR as f64);
        let steps = shares.map(|share| share * self.step_ns);
        let scored = steps.map(|step_ns| (agreement(stamps_ns, step_ns), step_ns));
        let best = scored.max_by(|a, b| a.0.total_cmp(&b.0));
        Self::anywhere(best.map_or(self.step_ns, |best| best.1))
    }

    /// How far stamps are spread about the line through them on this grid, in steps.
    fn spread(self, stamps_ns: &[i64]) -> f64 {
        let slots = Slots::of(stamps_ns, self);
        let points = slots.points(stamps_ns);
        half_spread(points, Line::through(points, OUT_OF_SLOT))
    }
}

/// How well stamps agree about their place between two samples, window by window.
fn agreement(stamps_ns: &[i64], step_ns: f64) -> f64 {
    let windows = windows(stamps_ns, step_ns, WIDTHS[0]);
    windows.iter().map(|window| window.agreement.powi(2)).sum()
}

/// The step without gaps: the mean of those between half and one and a half times the median of
/// those that are not 0. Steps that alternate, as when every second message comes late, average
/// out; the median alone would not.
fn typical_step_ns(stamps_ns: &[i64]) -> f64 {
    let steps = steps_ns(stamps_ns).filter(|step| *step > 0);
    let mut steps: Vec<u64> = steps.collect();
    if steps.is_empty() {
        return 0.0;
    }
    mean_near_median(&mut steps)
}

/// The median, the lower one of an even number; sorts the steps in part.
fn lower_median(steps_ns: &mut [u64]) -> u64 {
    let middle = (steps_ns.len() - 1) / 2;
    *steps_ns.select_nth_unstable(middle).1
}

/// The mean of the steps between half and one and a half times their median.
fn mean_near_median(steps_ns: &mut [u64]) -> f64 {
    let median_ns = lower_median(steps_ns) as f64;
    let near = 0.5 * median_ns..=1.5 * median_ns;
    let steps = steps_ns.iter().map(|step| *step as f64);
    let steps = steps.filter(|step| near.contains(step));
    let (sum, count) = steps.fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
    sum / count
}
