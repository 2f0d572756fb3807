//! Phase of stamps against an even clock, followed through a recording.
//!
//! `exp(2 pi i t / step)` does not depend on which sample a stamp is of: its mean over a window tells
//! where the stamps lie within a step, as the carrier of a radio signal is recovered, whatever is
//! lost, doubled or late in between. What the phase runs by corrects the step.

use std::f64::consts::TAU;

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
        let mut step_ns = guess.step_ns;
        if let Place::Around(phase) = guess.stamps {
            let knots = vec![(0.0, phase)];
            return Self { step_ns, knots };
        }
        let count = stamps_ns.len();
        for width in WIDTHS.into_iter().filter(|width| 2 * width <= count) {
            step_ns /= 1.0 - slope(&windows(stamps_ns, step_ns, width), width);
        }
        let width = WIDTHS[1..].iter().rev().find(|width| 2 * **width <= count);
        let windows = windows(stamps_ns, step_ns, *width.unwrap_or(&count));
        Self {
            step_ns,
            knots: unwrapped(&windows),
        }
    }

    /// The phase at a place, in steps; `from` is the knot that the last search ended at.
    pub(crate) fn at(&self, place: f64, from: &mut usize) -> f64 {
        while self
            .knots
            .get(*from + 1)
            .is_some_and(|next| next.0 <= place)
        {
            *from += 1;
        }
        let (left, phase) = self.knots[*from];
        match self.knots.get(*from + 1) {
            Some((right, next)) if place > left => {
                phase + (next - phase) * (place - left) / (right - left)
            }
            _ => phase,
        }
    }
}

/// The means over windows of so many stamps; what is left over belongs to the last one.
pub(crate) fn windows(stamps_ns: &[i64], step_ns: f64, width: usize) -> Vec<Window> {
    let count = (stamps_ns.len() / width).max(1);
    let bounds = |k: usize| {
        (
            k * width,
            if k + 1 == count {
                stamps_ns.len()
            } else {
                (k + 1) * width
            },
        )
    };
    let place = |stamp: &i64| stamp.abs_diff(stamps_ns[0]) as f64 / step_ns;
    let window = |k: usize| {
        let (from, to) = bounds(k);
        window(stamps_ns[from..to].iter().map(place))
    };
    (0..count).map(window).collect()
}

fn window(places: impl Iterator<Item = f64>) -> Window {
    let (mut sum, mut sine, mut cosine, mut count) = (0.0, 0.0, 0.0, 0.0);
    for place in places {
        // the whole steps are taken off first: the sine of a large angle is not exact
        let (s, c) = (TAU * (place - place.round())).sin_cos();
        sum += place;
        sine += s;
        cosine += c;
        count += 1.0;
    }
    Window {
        at: sum / count,
        phase: f64::atan2(sine, cosine) / TAU,
        agreement: f64::hypot(sine, cosine) / count,
    }
}

/// Median change of the phase for a step, between windows without a large gap between them.
fn slope(windows: &[Window], width: usize) -> f64 {
    let near = |pair: &&[Window]| pair[1].at - pair[0].at < 2.0 * width as f64;
    let change = |pair: &[Window]| turn(pair[1].phase - pair[0].phase) / (pair[1].at - pair[0].at);
    median(windows.windows(2).filter(near).map(change).collect())
}

/// The difference of two phases, between -1/2 and 1/2.
fn turn(difference: f64) -> f64 {
    difference - difference.round()
}

/// Knots of a phase that goes on over whole steps.
fn unwrapped(windows: &[Window]) -> Vec<(f64, f64)> {
    let usual = median(windows.iter().map(|window| window.agreement).collect());
    let agreeing = |window: &&Window| window.agreement >= LEAST_AGREEMENT * usual;
    let mut last: Option<f64> = None;
    let follow = |window: &Window| {
        let phase = last.map_or(window.phase, |last| last + turn(window.phase - last));
        last = Some(phase);
        (window.at, phase)
    };
    windows.iter().filter(agreeing).map(follow).collect()
}

/// The median, the lower one of an even number; 0 of nothing.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let Some(last) = values.len().checked_sub(1) else {
        return 0.0;
    };
    *values.select_nth_unstable_by(last / 2, f64::total_cmp).1
}
