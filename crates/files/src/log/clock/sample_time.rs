//! Sample time of a recording from its stamps, before it is known which sample each of them is.

use crate::log::clock::evenness::{MOST_JITTER, half_spread};
use crate::log::clock::line::{Line, Points};
use crate::log::clock::phase::{WIDTHS, windows};
use crate::log::clock::rounded::{EVIDENCE, lossless, searched};
use crate::log::clock::slots::Slots;
use crate::log::clock::{OUT_OF_SLOT, STATED_TOLERANCE};

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
pub(crate) fn resolution_ns(stamps_ns: &[i64]) -> u64 {
    let steps = stamps_ns.windows(2).map(|pair| pair[1].abs_diff(pair[0]));
    steps.fold(0, greatest_common_divisor)
}

fn greatest_common_divisor(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
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
        let is_likely = |step_ns: f64| (step_ns / stated_ns - 1.0).abs() <= STATED_TOLERANCE;
        let is_coarse = unit_ns > COARSE * stated_ns;
        let rounded = is_coarse.then(|| lossless(stamps_ns, unit_ns, is_likely));
        rounded.flatten().unwrap_or(Self::anywhere(stated_ns))
    }

    /// The step without gaps or, for coarse stamps, the even clock whose stamps they are the whole
    /// units of, if there is one.
    fn found(stamps_ns: &[i64], unit_ns: f64) -> Self {
        let typical = Self::anywhere(typical_step_ns(stamps_ns));
        let is_likely =
            |step_ns: f64| stamps_ns.len() as f64 * (step_ns / unit_ns).ln() >= EVIDENCE;
        let rounded = (unit_ns > COARSE * typical.step_ns).then(|| {
            lossless(stamps_ns, unit_ns, is_likely).or_else(|| searched(stamps_ns, unit_ns))
        });
        let rounded = rounded.flatten();
        rounded.unwrap_or_else(|| typical.improved(stamps_ns))
    }

    /// This grid or, if the first stamps are far more even on it, the best of those near it: many
    /// losses, whose steps jitter makes shorter, lengthen the mean.
    fn improved(self, stamps_ns: &[i64]) -> Self {
        let first = &stamps_ns[..stamps_ns.len().min(FIRST)];
        if first.len() < 2 || self.step_ns <= 0.0 {
            return self;
        }
        let shares = (0..=N_NEAR).map(|k| NEAR.0 + (NEAR.1 - NEAR.0) * k as f64 / N_NEAR as f64);
        let steps = shares.map(|share| share * self.step_ns);
        let scored = steps.map(|step_ns| (agreement(first, step_ns), step_ns));
        let best = scored.max_by(|a, b| a.0.total_cmp(&b.0));
        let best = Self::anywhere(best.map_or(self.step_ns, |best| best.1));
        let most = (0.5 * self.spread(first)).min(0.5 * MOST_JITTER);
        if best.spread(first) < most {
            best
        } else {
            self
        }
    }

    /// How far stamps are spread about the line through them on this grid, in steps.
    fn spread(self, stamps_ns: &[i64]) -> f64 {
        let slots = Slots::of(stamps_ns, self);
        let points = Points {
            stamps_ns,
            slots: &slots.slots,
        };
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
    let mut steps: Vec<u64> = stamps_ns
        .windows(2)
        .map(|pair| pair[1].abs_diff(pair[0]))
        .filter(|step| *step > 0)
        .collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = (steps.len() - 1) / 2;
    let median = *steps.select_nth_unstable(middle).1 as f64;
    let near = steps.into_iter().map(|step| step as f64);
    let near = near.filter(|step| (0.5 * median..=1.5 * median).contains(step));
    let (sum, count) = near.fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
    sum / count
}
