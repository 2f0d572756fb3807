//! Even clock through stamps whose slots are known: the straight line of least squares, without the
//! stamps that are late.

use crate::log::clock::phase::median;

/// Stamps and their slots.
#[derive(Clone, Copy)]
pub(crate) struct Points<'p> {
    pub(crate) stamps_ns: &'p [i64],
    pub(crate) slots: &'p [u32],
}

/// The line: `stamp = first stamp + step (slot + origin)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// Sample time in ns.
    pub(crate) step_ns: f64,
    /// Place of slot 0 in steps after the first stamp: the median over all stamps.
    pub(crate) origin: f64,
}

impl Line {
    /// The line through the stamps, then once more through those that are within `reach` steps of
    /// it; stamps that repeat the one before say nothing.
    pub(crate) fn through(points: Points, reach: f64) -> Self {
        let Points { stamps_ns, .. } = points;
        let says = |k: usize| k == 0 || stamps_ns[k] != stamps_ns[k - 1];
        let all = Self::of_step(points, step_ns(points, says));
        let near = |k: usize| says(k) && all.deviation(points, k).abs() <= reach;
        Self::of_step(points, step_ns(points, near))
    }

    /// The line of a known step.
    pub(crate) fn of_step(points: Points, step_ns: f64) -> Self {
        let from_first = Self {
            step_ns,
            origin: 0.0,
        };
        let deviations = (0..points.slots.len()).map(|k| from_first.deviation(points, k));
        Self {
            step_ns,
            origin: median(deviations.collect()),
        }
    }

    /// How many steps a stamp lies behind the line.
    pub(crate) fn deviation(&self, points: Points, k: usize) -> f64 {
        let since_first = points.stamps_ns[k].abs_diff(points.stamps_ns[0]) as f64;
        since_first / self.step_ns - f64::from(points.slots[k]) - self.origin
    }
}

/// Step in ns of the straight line through the stamps by least squares. On an even grid the line
/// through both ends is exact already, and its correction is exactly zero.
fn step_ns(points: Points, counts: impl Fn(usize) -> bool) -> f64 {
    let Points { stamps_ns, slots } = points;
    let used = || (0..slots.len()).filter(|k| counts(*k));
    let (Some(first), Some(last)) = (used().next(), used().next_back()) else {
        return 0.0;
    };
    let length_ns = stamps_ns[last].abs_diff(stamps_ns[first]) as f64;
    let through_ends = length_ns / f64::from((slots[last] - slots[first]).max(1));
    let slot = |k: usize| f64::from(slots[k] - slots[first]);
    let middle = used().map(slot).sum::<f64>() / used().count() as f64;
    let (mut lean, mut weight) = (0.0, 0.0);
    for k in used() {
        let since_first = stamps_ns[k].abs_diff(stamps_ns[first]) as f64;
        lean += (since_first / through_ends - slot(k)) * (slot(k) - middle);
        weight += (slot(k) - middle).powi(2);
    }
    through_ends * (1.0 + lean / weight.max(1.0))
}
