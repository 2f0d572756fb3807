//! Even clocks whose stamps are rounded to whole units that are no small part of their step: 800 Hz
//! in whole ms.

use std::f64::consts::TAU;

use crate::log::clock::sample_time::{Guess, Place};

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
    let count = stamps_ns.len() as f64;
    let height = |step: f64| {
        let (low, high) = strip(stamps_ns, step);
        high - low
    };
    // least squares are less than 1.5 units off the best strip at the ends
    let reach = 4.0 * unit / count;
    if !is_likely(middle + reach) || height(middle) > 4.0 * unit {
        return None;
    }
    let (mut least, mut most) = (middle - reach, middle + reach);
    // the height is convex in the step: 40 thirds are 1e-7 of the reach
    for _ in 0..40 {
        let third = (most - least) / 3.0;
        if height(least + third) < height(most - third) {
            most -= third;
        } else {
            least += third;
        }
    }
    let step_ns = 0.5 * (least + most);
    let (low, high) = strip(stamps_ns, step_ns);
    // an even clock of k units has a strip without height, a rounded one of up to a unit
    let is_within = high - low <= unit * (1.0 + 1e-6);
    (is_within && is_likely(step_ns)).then_some(Guess {
        step_ns,
        stamps: Place::OnEvery,
    })
}

/// Step in ns of the straight line of least squares through the points (row, stamp).
fn straight_step_ns(stamps_ns: &[i64]) -> f64 {
    let count = stamps_ns.len() as f64;
    let middle = (count - 1.0) / 2.0;
    let lean =
        |(row, stamp): (usize, &i64)| stamp.abs_diff(stamps_ns[0]) as f64 * (row as f64 - middle);
    let lean: f64 = stamps_ns.iter().enumerate().map(lean).sum();
    12.0 * lean / (count * (count * count - 1.0))
}

/// Lowest and highest stamp against an even clock without losses, in ns.
fn strip(stamps_ns: &[i64], step_ns: f64) -> (f64, f64) {
    let above =
        |(row, stamp): (usize, &i64)| stamp.abs_diff(stamps_ns[0]) as f64 - row as f64 * step_ns;
    let above = stamps_ns.iter().enumerate().map(above);
    above.fold((f64::MAX, f64::MIN), |(low, high), above| {
        (low.min(above), high.max(above))
    })
}

/// The even clock of a step between one and two units, with lost samples, that the stamps are the
/// whole units of: a peak of `|sum exp(2 pi i t / step)|` over the first stamps, if all stamps lie
/// within a unit of it. Beyond two units the common steps have the right mean anyway; closer to one
/// unit than a twelfth it cannot be told from losses.
pub(crate) fn searched(stamps_ns: &[i64], unit: f64) -> Option<Guess> {
    let is_longer = |pair: &&[i64]| pair[1].abs_diff(pair[0]) as f64 > unit;
    if stamps_ns.windows(2).filter(is_longer).count() * 12 < stamps_ns.len() {
        return None;
    }
    let first = &stamps_ns[..stamps_ns.len().min(SEARCHED)];
    let peaks = peaks(first, unit).into_iter();
    let mut likely = peaks.filter(|grid| grid.holds(first, unit));
    let grid = likely.next()?.refined(stamps_ns);
    grid.holds(stamps_ns, unit).then_some(Guess {
        step_ns: grid.step_ns,
        stamps: Place::Around(grid.phase),
    })
}

/// The highest peaks of the resultant, highest first.
fn peaks(stamps_ns: &[i64], unit: f64) -> Vec<Grid> {
    let length = stamps_ns[stamps_ns.len() - 1].abs_diff(stamps_ns[0]) as f64;
    let n_trials = (2.0 * length / unit).min(8.0 * SEARCHED as f64) as usize;
    // frequencies from 1/2 to 12/13 per unit, four to a width of a peak
    let frequency = |trial: usize| (0.5 + 0.5 * trial as f64 / n_trials as f64) / unit;
    let trials = (1..n_trials)
        .map(frequency)
        .filter(|f| f * unit < 12.0 / 13.0);
    let trials: Vec<_> = trials.map(|f| resultant(stamps_ns, 1.0 / f)).collect();
    let inner = trials.windows(3);
    let peaks = inner.filter(|around| around[1].0 >= around[0].0 && around[1].0 >= around[2].0);
    let mut peaks: Vec<_> = peaks.map(|around| around[1]).collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    let grids = peaks.into_iter().take(PEAKS).map(|(_, grid)| grid);
    grids.map(|grid| grid.refined(stamps_ns)).collect()
}

/// `|sum exp(2 pi i t / step)|^2` over the stamps, and the grid with its phase.
fn resultant(stamps_ns: &[i64], step_ns: f64) -> (f64, Grid) {
    let place = |stamp: &i64| stamp.abs_diff(stamps_ns[0]) as f64 / step_ns;
    let parts = stamps_ns
        .iter()
        .map(|stamp| (TAU * place(stamp).fract()).sin_cos());
    let (sine, cosine) = parts.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    let phase = f64::atan2(sine, cosine) / TAU;
    (sine * sine + cosine * cosine, Grid { step_ns, phase })
}

/// Even grid with lost samples.
#[derive(Debug, Clone, Copy)]
struct Grid {
    step_ns: f64,
    /// Where between two samples the stamps lie, in steps.
    phase: f64,
}

impl Grid {
    /// The sample that a time after the first stamp belongs to, and how far off it is, in steps.
    fn nearest(&self, since_first_ns: f64) -> (f64, f64) {
        let place = since_first_ns / self.step_ns - self.phase;
        (place.round(), place - place.round())
    }

    /// The straight line through ever more stamps, in the end all: half as long, it is good enough
    /// to tell the samples by.
    fn refined(mut self, stamps_ns: &[i64]) -> Self {
        let mut count = stamps_ns.len().min(SEARCHED);
        loop {
            self = self.line(&stamps_ns[..count]);
            self = self.line(&stamps_ns[..count]);
            if count == stamps_ns.len() {
                return self;
            }
            count = stamps_ns.len().min(2 * count);
        }
    }

    /// The straight line of least squares through the stamps at their nearest samples.
    fn line(&self, stamps_ns: &[i64]) -> Self {
        let points = || {
            let since_first = stamps_ns
                .iter()
                .map(|stamp| stamp.abs_diff(stamps_ns[0]) as f64);
            since_first.map(|time| (self.nearest(time).0, time))
        };
        let count = stamps_ns.len() as f64;
        let (samples, times) = points().fold((0.0, 0.0), |sum, at| (sum.0 + at.0, sum.1 + at.1));
        let (sample, time) = (samples / count, times / count);
        let (mut lean, mut weight) = (0.0, 0.0);
        for at in points() {
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
        // the middle of rounded stamps is known to a few hundredths of a step
        let half_window = 0.5 * unit / self.step_ns + 0.03;
        let (mut within, mut last) = (0.0, f64::NEG_INFINITY);
        for stamp in stamps_ns {
            let (sample, off) = self.nearest(stamp.abs_diff(stamps_ns[0]) as f64);
            if sample > last && off.abs() <= half_window {
                within += 1.0;
            }
            last = sample;
        }
        let is_no_chance = -within * (2.0 * half_window).ln() >= EVIDENCE;
        within >= MOST_WITHIN * stamps_ns.len() as f64 && is_no_chance
    }
}
