//! Even clock through stamps whose slots are known: the straight line of least squares, without the
//! stamps that are late.

use crate::log::clock::phase::median;
use crate::log::recording::repeats_stamp;

/// Stamps and their slots.
#[derive(Clone, Copy)]
pub(crate) struct Points<'p> {
    pub(crate) stamps_ns: &'p [i64],
    pub(crate) slots: &'p [u32],
}

impl Points<'_> {
    /// Time from one stamp to another.
    fn time_ns(&self, from: usize, to: usize) -> f64 {
        self.stamps_ns[to].abs_diff(self.stamps_ns[from]) as f64
    }
}

/// Times of stamps in ns after the first.
pub(crate) fn since_first_ns(stamps_ns: &[i64]) -> impl ExactSizeIterator<Item = f64> + Clone {
    let since_first = |stamp: &i64| stamp.abs_diff(stamps_ns[0]) as f64;
    stamps_ns.iter().map(since_first)
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
        let says = |k: usize| !repeats_stamp(points.stamps_ns, k);
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
        Self {
            step_ns,
            origin: median(from_first.deviations(points).collect()),
        }
    }

    /// Time of slot 0 in ns after the first stamp.
    pub(crate) fn origin_ns(&self) -> f64 {
        self.origin * self.step_ns
    }

    /// The slot nearest to a time after the first stamp, if that is not before slot 0.
    pub(crate) fn slot(&self, since_first_ns: f64) -> Option<u32> {
        let slot = (since_first_ns / self.step_ns - self.origin).round();
        (slot >= 0.0).then_some(slot as u32)
    }

    /// How many steps each stamp lies behind the line.
    pub(crate) fn deviations(self, points: Points) -> impl Iterator<Item = f64> {
        (0..points.slots.len()).map(move |k| self.deviation(points, k))
    }

    pub(crate) fn largest_deviation(self, points: Points) -> f64 {
        self.deviations(points).map(f64::abs).fold(0.0, f64::max)
    }

    /// Rms of the deviations about their mean, without those beyond `reach` steps.
    pub(crate) fn jitter(self, points: Points, reach: f64) -> f64 {
        let inside = || self.deviations(points).filter(|off| off.abs() <= reach);
        let count = inside().count() as f64;
        let mean = inside().sum::<f64>() / count;
        let squares = inside().map(|deviation| (deviation - mean).powi(2));
        (squares.sum::<f64>() / count).sqrt()
    }

    /// How many stamps are within `reach` steps of the line.
    pub(crate) fn n_within(self, points: Points, reach: f64) -> usize {
        let is_within = |deviation: &f64| deviation.abs() <= reach;
        self.deviations(points).filter(is_within).count()
    }

    /// How many steps a stamp lies behind the line.
    pub(crate) fn deviation(&self, points: Points, k: usize) -> f64 {
        points.time_ns(0, k) / self.step_ns - f64::from(points.slots[k]) - self.origin
    }
}

/// Step in ns of the straight line through the stamps by least squares. On an even grid the line
/// through both ends is exact already, and its correction is exactly zero.
fn step_ns(points: Points, counts: impl Fn(usize) -> bool) -> f64 {
    let used = (0..points.slots.len()).filter(|k| counts(*k));
    let ends = used.clone().next().zip(used.clone().next_back());
    let Some((first, last)) = ends else {
        return 0.0;
    };
    let n_steps = (points.slots[last] - points.slots[first]).max(1);
    let through_ends = points.time_ns(first, last) / f64::from(n_steps);
    through_ends * (1.0 + lean(points, first, used, through_ends))
}

/// Slope of the stamps that are used against a line through the first of them, in parts of its step.
fn lean(
    points: Points,
    first: usize,
    used: impl Iterator<Item = usize> + Clone,
    step_ns: f64,
) -> f64 {
    let slot = |k: usize| f64::from(points.slots[k] - points.slots[first]);
    let middle = used.clone().map(slot).sum::<f64>() / used.clone().count() as f64;
    let (mut lean, mut weight) = (0.0, 0.0);
    for k in used {
        lean += (points.time_ns(first, k) / step_ns - slot(k)) * (slot(k) - middle);
        weight += (slot(k) - middle).powi(2);
    }
    lean / weight.max(1.0)
}
