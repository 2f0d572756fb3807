//! Phase of stamps against an even clock, followed through a recording.
//!
//! `exp(2 pi i t / step)` does not depend on which sample a stamp is of: its mean over a window tells
//! where the stamps lie within a step, as the carrier of a radio signal is recovered, whatever is
//! lost, doubled or late in between. What the phase runs by corrects the step.

use std::f64::consts::TAU;

use crate::log::clock::line::since_first_ns;
use crate::log::clock::sample_time::{Guess, Place};

/// Stamps in a window, from the coarsest to the finest correction of the step: the first follows a
/// step that is up to 3 % off (half a sample in 16), the last averages 25 % of jitter to 0.02.
pub(crate) const WIDTHS: [usize; 3] = [16, 64, 256];
/// Windows whose stamps agree less than this share of the usual are left out: they hold bursts.
const LEAST_AGREEMENT: f64 = 0.5;

/// Mean of the stamps of a window.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    /// Place of its middle, in steps after the first stamp.
    at: f64,
    /// Where the stamps lie between two samples, in steps.
    phase: f64,
    /// Length of the mean of `exp(2 pi i t / step)`: 1 if all stamps agree.
    pub(crate) agreement: f64,
}

/// The phase against the place in the recording.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Phase {
    /// Sample time in ns, corrected.
    pub(crate) step_ns: f64,
    /// Places in steps after the first stamp, and the phase there in steps.
    knots: Vec<(f64, f64)>,
}

impl Phase {
    /// Follows the phase of rising stamps from a guess, unless that knows it.
    pub(crate) fn of(stamps_ns: &[i64], guess: Guess) -> Self {
        if let Place::Around(phase) = guess.stamps {
            return Self {
                step_ns: guess.step_ns,
                knots: vec![(0.0, phase)],
            };
        }
        let step_ns = corrected(stamps_ns, guess.step_ns);
        let width = finest(stamps_ns.len());
        Self {
            step_ns,
            knots: unwrapped(&windows(stamps_ns, step_ns, width)),
        }
    }

    /// The phase at a place, in steps; `from` is the knot that the last search ended at.
    pub(crate) fn at(&self, place: f64, from: &mut usize) -> f64 {
        while self.has_come(*from + 1, place) {
            *from += 1;
        }
        let last = self.knots[*from];
        match self.knots.get(*from + 1) {
            Some(next) if place > last.0 => between(last, *next, place),
            _ => last.1,
        }
    }

    /// Whether there is such a knot, not behind the place.
    fn has_come(&self, knot: usize, place: f64) -> bool {
        self.knots.get(knot).is_some_and(|(at, _)| *at <= place)
    }
}

/// The phase at a place between two knots.
fn between((left, phase): (f64, f64), (right, next): (f64, f64), place: f64) -> f64 {
    phase + (next - phase) * (place - left) / (right - left)
}

/// The step in ns without what the phase runs by, in ever longer windows.
fn corrected(stamps_ns: &[i64], guess_ns: f64) -> f64 {
    let fit = |width: &usize| 2 * width <= stamps_ns.len();
    WIDTHS
        .into_iter()
        .filter(fit)
        .fold(guess_ns, |step_ns, width| {
            corrected_by(stamps_ns, step_ns, width)
        })
}

/// The step in ns without what the phase runs by from one window of this width to the next.
fn corrected_by(stamps_ns: &[i64], step_ns: f64, width: usize) -> f64 {
    let windows = windows(stamps_ns, step_ns, width);
    step_ns / (1.0 - slope(&windows, width))
}

/// The widest window that fits twice, but not the narrowest of all.
fn finest(n_stamps: usize) -> usize {
    let mut widths = WIDTHS[1..].iter().rev();
    let width = widths.find(|width| 2 * **width <= n_stamps);
    *width.unwrap_or(&n_stamps)
}

/// The means over windows of so many stamps; what is left over belongs to the last one.
pub(crate) fn windows(stamps_ns: &[i64], step_ns: f64, width: usize) -> Vec<Window> {
    let n_before = (stamps_ns.len() / width).max(1) - 1;
    let mut times = since_first_ns(stamps_ns).map(|time_ns| time_ns / step_ns);
    let before = (0..n_before).map(|_| Window::of(times.by_ref().take(width)));
    let mut windows: Vec<Window> = before.collect();
    windows.push(Window::of(times));
    windows
}

impl Window {
    fn of(places: impl Iterator<Item = f64>) -> Self {
        let mut sums = Sums::default();
        places.for_each(|place| sums.add(place));
        sums.mean()
    }
}

/// Sums over the stamps of a window.
#[derive(Default)]
struct Sums {
    place: f64,
    sine: f64,
    cosine: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, place: f64) {
        // the whole steps are taken off first: the sine of a large angle is not exact
        let (sine, cosine) = (TAU * (place - place.round())).sin_cos();
        self.place += place;
        self.sine += sine;
        self.cosine += cosine;
        self.count += 1.0;
    }

    fn mean(&self) -> Window {
        Window {
            at: self.place / self.count,
            phase: f64::atan2(self.sine, self.cosine) / TAU,
            agreement: f64::hypot(self.sine, self.cosine) / self.count,
        }
    }
}

/// Median change of the phase for a step, between windows without a large gap between them.
fn slope(windows: &[Window], width: usize) -> f64 {
    let near = |pair: &&[Window]| distance(pair) < 2.0 * width as f64;
    median(windows.windows(2).filter(near).map(change).collect())
}

/// Change of the phase for a step from one window to the next.
fn change(pair: &[Window]) -> f64 {
    turn(pair[1].phase - pair[0].phase) / distance(pair)
}

fn distance(pair: &[Window]) -> f64 {
    pair[1].at - pair[0].at
}

/// The difference of two phases, between -1/2 and 1/2.
fn turn(difference: f64) -> f64 {
    difference - difference.round()
}

/// Knots of a phase that goes on over whole steps.
fn unwrapped(windows: &[Window]) -> Vec<(f64, f64)> {
    let least = least_agreement(windows);
    let agreeing = windows.iter().filter(|window| window.agreement >= least);
    let mut last: Option<f64> = None;
    let follow = |window: &Window| {
        let phase = last.map_or(window.phase, |last| last + turn(window.phase - last));
        last = Some(phase);
        (window.at, phase)
    };
    agreeing.map(follow).collect()
}

fn least_agreement(windows: &[Window]) -> f64 {
    let agreements = windows.iter().map(|window| window.agreement);
    LEAST_AGREEMENT * median(agreements.collect())
}

/// The median, the lower one of an even number; 0 of nothing.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let Some(last) = values.len().checked_sub(1) else {
        return 0.0;
    };
    *values.select_nth_unstable_by(last / 2, f64::total_cmp).1
}
