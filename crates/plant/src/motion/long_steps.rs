//! End of a mode within a long step, in which a signal can turn more than once: sign changes of the
//! Bernstein coefficients of the cubic through values and slopes at both ends (Descartes' rule of signs).
//!
//! Without a sign change the cubic stays inside, with one it leaves once; more are told apart by halving,
//! which takes the coefficients to the signal itself.

use crate::motion::equations::State;
use crate::motion::event_location::{Bound, Trial};
use crate::motion::formula::Formula;
use crate::motion::links::Links;

/// Halvings in search of a turn: a shorter one is within rounding of its bound.
const HALVINGS: usize = 26;

/// A signal's margin inside a bound and its rate per trial, at a share of the trial.
#[derive(Debug, Clone, Copy)]
struct Point {
    theta: f64,
    margin: f64,
    rate: f64,
}

/// Whether the margin may leave the inside between two points more than once, once, or not at all.
enum Leaves {
    Never,
    Once,
    Perhaps,
}

impl Leaves {
    fn between(from: Point, to: Point) -> Self {
        let third = (to.theta - from.theta) / 3.0;
        let coefficients = [
            from.margin,
            from.margin + third * from.rate,
            to.margin - third * to.rate,
            to.margin,
        ];
        let is_inside = coefficients.map(|value| value >= 0.0);
        match is_inside
            .windows(2)
            .filter(|pair| pair[0] != pair[1])
            .count()
        {
            0 => Self::Never,
            1 => Self::Once,
            _ => Self::Perhaps,
        }
    }
}

impl<K: Links<A>, F: Formula<K, A>, const A: usize> Trial<'_, K, A, F> {
    /// Where in the trial, whose end state and its derivative are given, a signal first crosses a bound.
    pub(crate) fn exit_of_long(
        &self,
        bound: Bound,
        end: &State<f64, A>,
        end_derivative: &State<f64, A>,
    ) -> Option<f64> {
        let mut start = self.point(bound, 0.0, &self.motion.state, self.derivative);
        if start.margin <= 0.0 {
            // a mode that begins on its bound begins by moving inside; a slope that says otherwise is
            // rounding
            (start.margin, start.rate) = (0.0, start.rate.max(0.0));
        }
        let end = self.point(bound, 1.0, end, end_derivative);
        match Leaves::between(start, end) {
            Leaves::Never => None,
            _ => self.first_crossing(bound, start, end, HALVINGS),
        }
    }

    /// The first crossing between a point that is not outside and another.
    #[cold]
    fn first_crossing(&self, bound: Bound, from: Point, to: Point, halvings: usize) -> Option<f64> {
        match Leaves::between(from, to) {
            Leaves::Never => None,
            Leaves::Perhaps if halvings > 0 => {
                let theta = 0.5 * (from.theta + to.theta);
                let x = self.state(theta);
                let middle = self.point(bound, theta, &x, &self.derivative(theta, &x));
                self.first_crossing(bound, from, middle, halvings - 1)
                    .or_else(|| self.first_crossing(bound, middle, to, halvings - 1))
            }
            _ if to.margin >= 0.0 => None,
            _ if from.margin > 0.0 => {
                let [inside, outside] = [from, to].map(|point| (point.theta, point.margin));
                Some(self.crossing(bound, inside, outside))
            }
            _ => Some(self.exit_from_bound(bound, (to.theta, to.margin))),
        }
    }

    #[inline(always)]
    fn point(
        &self,
        bound: Bound,
        theta: f64,
        x: &State<f64, A>,
        derivative: &State<f64, A>,
    ) -> Point {
        Point {
            theta,
            margin: self.margin(bound, theta, x),
            rate: self.margin_rate(bound, theta, derivative) * self.duration_s(),
        }
    }
}
