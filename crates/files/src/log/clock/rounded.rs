//! Even clocks whose stamps are rounded to whole units that are no small part of their step: 800 Hz
//! in whole ms.

use std::f64::consts::TAU;

use crate::log::clock::line::since_first_ns;
use crate::log::clock::sample_time::{Guess, Place, steps_ns};

/// Log-likelihood by which a grid that is no multiple of the stamps' resolution must beat the one
/// that is: each stamp hits the narrow window by chance with the share it has of a step; exp(-20)
/// leaves room for a few thousand trials.
pub(crate) const EVIDENCE: f64 = 20.0;
/// Share of stamps that must lie within one unit of resolution; the others may be late.
const MOST_WITHIN: f64 = 0.99;
/// Peaks of the resultant that are tried: a clock of 5/4 units has one of the same height at 5/3.
const PEAKS: usize = 8;
/// Stamps that a coarse clock is searched in: enough for a peak of 0.2 to stand out of 1/sqrt(n).
const SEARCHED: usize = 1024;

/// The even clock without a lost sample that the stamps are the whole units of: the strip of the
/// least height that holds all points (row, stamp), if that is no higher than a unit.
pub(crate) fn lossless(
    stamps_ns: &[i64],
    unit: f64,
    is_likely: impl Fn(f64) -> bool,
) -> Option<Guess> {
    let middle = straight_step_ns(stamps_ns);
    // least squares are less than 1.5 units off the best strip at the ends
    let reach = 4.0 * unit / stamps_ns.len() as f64;
    if !is_likely(middle + reach) || height_ns(stamps_ns, middle) > 4.0 * unit {
        return None;
    }
    let step_ns = flattest(stamps_ns, middle - reach, middle + reach);
    // an even clock of k units has a strip without height, a rounded one of up to a unit
    let is_within = height_ns(stamps_ns, step_ns) <= unit * (1.0 + 1e-6);
    (is_within && is_likely(step_ns)).then_some(Guess {
        step_ns,
        stamps: Place::OnEvery,
    })
}

/// Step in ns of the straight line of least squares through the points (row, stamp).
fn straight_step_ns(stamps_ns: &[i64]) -> f64 {
    let count = stamps_ns.len() as f64;
    let middle = (count - 1.0) / 2.0;
    let times = since_first_ns(stamps_ns).enumerate();
    let lean: f64 = times.map(|(row, time)| time * (row as f64 - middle)).sum();
    12.0 * lean / (count * (count * count - 1.0))
}

/// The step between two whose strip is the lowest.
fn flattest(stamps_ns: &[i64], mut least: f64, mut most: f64) -> f64 {
    // the height is convex in the step: 40 thirds are 1e-7 of the reach
    for _ in 0..40 {
        let third = (most - least) / 3.0;
        if height_ns(stamps_ns, least + third) < height_ns(stamps_ns, most - third) {
            most -= third;
        } else {
            least += third;
        }
    }
    0.5 * (least + most)
}

/// Height of the strip that holds all stamps, along an even clock without losses.
fn height_ns(stamps_ns: &[i64], step_ns: f64) -> f64 {
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    for (row, time_ns) in since_first_ns(stamps_ns).enumerate() {
        let above = time_ns - row as f64 * step_ns;
        (low, high) = (low.min(above), high.max(above));
    }
    high - low
}

/// The even clock of a step between one and two units, with lost samples, that the stamps are the
/// whole units of: a peak of `|sum exp(2 pi i t / step)|` over the first stamps, if all stamps lie
/// within a unit of it. Beyond two units the common steps have the right mean anyway; closer to one
/// unit than a twelfth it cannot be told from losses.
pub(crate) fn searched(stamps_ns: &[i64], unit: f64) -> Option<Guess> {
    if !has_longer_steps(stamps_ns, unit) {
        return None;
    }
    let first = &stamps_ns[..stamps_ns.len().min(SEARCHED)];
    let mut peaks = peaks(first, unit).into_iter();
    let likely = peaks.find(|grid| grid.holds(first, unit));
    let grid = likely?.refined(stamps_ns);
    grid.holds(stamps_ns, unit).then(|| grid.guess())
}

/// Whether a twelfth of the steps is longer than a unit.
fn has_longer_steps(stamps_ns: &[i64], unit: f64) -> bool {
    let is_longer = |step: &u64| *step as f64 > unit;
    steps_ns(stamps_ns).filter(is_longer).count() * 12 >= stamps_ns.len()
}

/// The highest peaks of the resultant, highest first.
fn peaks(stamps_ns: &[i64], unit: f64) -> Vec<Grid> {
    let trials = trials(stamps_ns, unit);
    let peaks = trials.windows(3).filter(|around| is_peak(around));
    let mut peaks: Vec<_> = peaks.map(|around| around[1]).collect();
    peaks.sort_by(|a, b| b.power.total_cmp(&a.power));
    let highest = peaks.into_iter().take(PEAKS);
    highest.map(|peak| peak.grid.refined(stamps_ns)).collect()
}

fn is_peak(around: &[Resultant]) -> bool {
    around[1].power >= around[0].power && around[1].power >= around[2].power
}

/// The resultants of steps from two units to 13/12 of one, four to a width of a peak.
fn trials(stamps_ns: &[i64], unit: f64) -> Vec<Resultant> {
    let n_trials = n_trials(stamps_ns, unit);
    let frequency = |trial: usize| (0.5 + 0.5 * trial as f64 / n_trials as f64) / unit;
    let frequencies = (1..n_trials).map(frequency);
    let inside = frequencies.filter(|f| f * unit < 12.0 / 13.0);
    inside.map(|f| Resultant::of(stamps_ns, 1.0 / f)).collect()
}

fn n_trials(stamps_ns: &[i64], unit: f64) -> usize {
    let length = stamps_ns[stamps_ns.len() - 1].abs_diff(stamps_ns[0]) as f64;
    (2.0 * length / unit).min(8.0 * SEARCHED as f64) as usize
}

/// Resultant of the stamps, as points on a circle whose length is a step.
#[derive(Debug, Clone, Copy)]
struct Resultant {
    /// `|sum exp(2 pi i t / step)|^2`.
    power: f64,
    grid: Grid,
}

impl Resultant {
    fn of(stamps_ns: &[i64], step_ns: f64) -> Self {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for time_ns in since_first_ns(stamps_ns) {
            let part = (TAU * (time_ns / step_ns).fract()).sin_cos();
            (sine, cosine) = (sine + part.0, cosine + part.1);
        }
        let phase = f64::atan2(sine, cosine) / TAU;
        Self {
            power: sine * sine + cosine * cosine,
            grid: Grid { step_ns, phase },
        }
    }
}

/// Even grid with lost samples.
#[derive(Debug, Clone, Copy)]
struct Grid {
    step_ns: f64,
    /// Where between two samples the stamps lie, in steps.
    phase: f64,
}

impl Grid {
    fn guess(&self) -> Guess {
        Guess {
            step_ns: self.step_ns,
            stamps: Place::Around(self.phase),
        }
    }

    /// The sample that a time after the first stamp belongs to, and how far off it is, in steps.
    fn nearest(&self, since_first_ns: f64) -> (f64, f64) {
        let place = since_first_ns / self.step_ns - self.phase;
        (place.round(), place - place.round())
    }

    /// The straight line through ever more stamps, in the end all: half as long, it is good enough
    /// to tell the samples by.
    fn refined(mut self, stamps_ns: &[i64]) -> Self {
        let mut count = SEARCHED;
        while count < stamps_ns.len() {
            self = self.twice_refined(&stamps_ns[..count]);
            count *= 2;
        }
        self.twice_refined(stamps_ns)
    }

    fn twice_refined(self, stamps_ns: &[i64]) -> Self {
        self.line(stamps_ns).line(stamps_ns)
    }

    /// The straight line of least squares through the stamps at their nearest samples.
    fn line(&self, stamps_ns: &[i64]) -> Self {
        let times = since_first_ns(stamps_ns);
        let points = times.map(|time| (self.nearest(time).0, time));
        let (sample, time) = mean(points.clone());
        let (mut lean, mut weight) = (0.0, 0.0);
        for at in points {
            lean += (at.0 - sample) * (at.1 - time);
            weight += (at.0 - sample) * (at.0 - sample);
        }
        if weight == 0.0 || lean <= 0.0 {
            return *self;
        }
        let step_ns = lean / weight;
        Self {
            step_ns,
            phase: time / step_ns - sample,
        }
    }

    /// Whether the stamps lie within one unit of the grid, would not do so by chance, and have a
    /// sample each.
    fn holds(&self, stamps_ns: &[i64], unit: f64) -> bool {
        let half_window = self.half_window(unit);
        let within = self.n_within(stamps_ns, half_window) as f64;
        within >= MOST_WITHIN * stamps_ns.len() as f64
            && -within * (2.0 * half_window).ln() >= EVIDENCE
    }

    /// How far off stamps may be that are rounded to a unit, in steps.
    fn half_window(&self, unit: f64) -> f64 {
        // the middle of rounded stamps is known to a few hundredths of a step
        0.5 * unit / self.step_ns + 0.03
    }

    /// How many stamps have a sample of their own, no farther off than this.
    fn n_within(&self, stamps_ns: &[i64], most_off: f64) -> usize {
        let mut last = f64::NEG_INFINITY;
        let is_within = |time_ns: &f64| {
            let (sample, off) = self.nearest(*time_ns);
            let before = std::mem::replace(&mut last, sample);
            sample > before && off.abs() <= most_off
        };
        since_first_ns(stamps_ns).filter(is_within).count()
    }
}

/// The mean of points.
fn mean(points: impl ExactSizeIterator<Item = (f64, f64)>) -> (f64, f64) {
    let count = points.len() as f64;
    let sum = points.fold((0.0, 0.0), |sum, at| (sum.0 + at.0, sum.1 + at.1));
    (sum.0 / count, sum.1 / count)
}
