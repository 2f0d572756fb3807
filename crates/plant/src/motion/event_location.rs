//! Instant at which a mode ends: within a step, when a signal leaves the interval of its mode.
//!
//! A motor slips forward (backward) while its velocity is above (below) 0, is stuck while its net
//! torque is within +-F_c, and its gear is on a branch of the spring while the deflection is in
//! that branch's interval. A trial step whose end lies outside an interval, or that has left it and
//! come back (the signal's slopes at both ends tell), is taken again with a share theta of its
//! length, and theta is found to rounding level.
//!
//! Steps with an event are few: what is done in those alone is marked cold, so that the look at every
//! other step stays short.

use crate::joint::friction::Slip;
use crate::motion::equations::State;
use crate::motion::formula::Formula;
use crate::motion::integrator::Integrator;
use crate::motion::links::Links;
use crate::motion::root::root;
use crate::motion::segment::Segment;

/// Halvings in search of a point inside: beyond them the mode is shorter than any step can resolve.
const HALVINGS: usize = 50;

/// What ends a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Signal {
    /// The motor velocity, while it slips.
    Velocity,
    /// The torque on the motor besides friction, while it is stuck.
    NetTorque,
    /// The deflection of the gear.
    Deflection,
}

/// The end of a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModeChange {
    /// Where in the trial step, from 0 to 1.
    pub theta: f64,
    /// On which axis.
    pub axis: usize,
    /// What left its interval.
    pub signal: Signal,
    /// Through the upper end of the interval, or the lower.
    pub upwards: bool,
}

/// A step that is being tried: the rest of a segment, from its share `from`.
pub(crate) struct Trial<'a, K, const A: usize, F: Formula<K, A>> {
    /// The motion so far.
    pub motion: &'a Integrator<K, A, F>,
    /// The torque over the whole segment.
    pub torque: &'a Segment<A>,
    /// Share of the segment at which the trial starts.
    pub from: f64,
    /// Duration of the whole segment in s.
    pub step_s: f64,
    /// Derivative of the state at the start of the trial.
    pub derivative: &'a State<f64, A>,
    /// What the formula works out once.
    pub kept: F::Kept,
}

/// One end of a mode's interval.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bound {
    axis: usize,
    signal: Signal,
    value: f64,
    upwards: bool,
}

impl<K: Links<A>, F: Formula<K, A>, const A: usize> Trial<'_, K, A, F> {
    /// Duration of the trial in s.
    #[inline(always)]
    pub(crate) fn duration_s(&self) -> f64 {
        (1.0 - self.from) * self.step_s
    }

    /// Share of the whole segment at a share of the trial.
    #[inline(always)]
    pub(crate) fn share(&self, theta: f64) -> f64 {
        self.from + theta * (1.0 - self.from)
    }

    /// The state at a share of the trial: one step of that length.
    #[inline(always)]
    pub(crate) fn state(&self, theta: f64) -> State<f64, A> {
        F::state(self, theta)
    }

    /// Time derivative of a state at a share of the trial.
    #[inline(always)]
    pub(crate) fn derivative(&self, theta: f64, x: &State<f64, A>) -> State<f64, A> {
        self.motion.equations.derivative(
            &self.motion.regimes,
            &self.torque.at(self.share(theta)),
            x,
        )
    }

    /// The first end of a mode within the trial, whose end state and its derivative are given.
    pub(crate) fn first_exit(
        &self,
        end: &State<f64, A>,
        end_derivative: &State<f64, A>,
    ) -> Option<ModeChange> {
        let mut first: Option<ModeChange> = None;
        for axis in 0..A {
            for bound in self.bounds(axis) {
                if bound.value.is_finite()
                    && let Some(theta) = F::exit(self, bound, [end, end_derivative])
                    && first.is_none_or(|first| theta < first.theta)
                {
                    first = Some(ModeChange {
                        theta,
                        axis,
                        signal: bound.signal,
                        upwards: bound.upwards,
                    });
                }
            }
        }
        first
    }

    /// The ends of the intervals in which an axis' mode holds, the infinite ones included.
    fn bounds(&self, axis: usize) -> [Bound; 4] {
        let (joint, mode) = (&self.motion.joints[axis], self.motion.modes[axis]);
        let signal = if mode.slip == Slip::Stuck {
            Signal::NetTorque
        } else {
            Signal::Velocity
        };
        let (slip, branch) = (
            joint.friction.interval(mode.slip),
            joint.spring.interval(mode.branch),
        );
        let bound = |signal, value, upwards| Bound {
            axis,
            signal,
            value,
            upwards,
        };
        [
            bound(signal, slip.0, false),
            bound(signal, slip.1, true),
            bound(Signal::Deflection, branch.0, false),
            bound(Signal::Deflection, branch.1, true),
        ]
    }

    /// Where in the trial, of a step so short that a signal turns once at most, it first crosses a bound.
    #[inline]
    pub(crate) fn exit(
        &self,
        bound: Bound,
        [end, end_derivative]: [&State<f64, A>; 2],
    ) -> Option<f64> {
        let inside = (0.0, self.margin(bound, 0.0, &self.motion.state));
        let mut outside = (1.0, self.margin(bound, 1.0, end));
        if outside.1 >= 0.0 {
            // Inside again: it can only have been outside if it turned back within the step, and its
            // tangents lead outside: a cubic stays within its ends and a third of the way along them.
            // A mode that begins on its bound begins by moving inside; a slope that says otherwise
            // is rounding.
            if inside.1 <= 0.0 {
                return None;
            }
            let rates = [
                self.margin_rate(bound, 0.0, self.derivative),
                self.margin_rate(bound, 1.0, end_derivative),
            ];
            let duration_s = self.duration_s();
            let [ahead, behind] = [
                inside.1 + duration_s * rates[0],
                outside.1 - duration_s * rates[1],
            ];
            if !(rates[0] < 0.0 && rates[1] > 0.0 && (ahead <= 0.0 || behind <= 0.0)) {
                return None;
            }
            outside = self.turn_outside(bound, rates)?;
        }
        if inside.1 <= 0.0 {
            return Some(self.exit_from_bound(bound, outside));
        }
        Some(self.crossing(bound, inside, outside))
    }

    /// Where a signal outside a bound turned back, given the rates of its margin at both ends of the
    /// trial, and its margin there; `None` if it turned back inside.
    #[cold]
    fn turn_outside(&self, bound: Bound, rates: [f64; 2]) -> Option<(f64, f64)> {
        let rate =
            |theta| self.margin_rate(bound, theta, &self.derivative(theta, &self.state(theta)));
        let turn = root(rate, (0.0, rates[0]), (1.0, rates[1]));
        let margin = self.margin_at(bound, turn);
        if margin >= 0.0 {
            return None;
        }
        Some((turn, margin))
    }

    /// Where a mode that begins on its very bound ends: behind a point inside that is looked for
    /// between its beginning and one outside; if there is none, where it begins.
    #[cold]
    pub(crate) fn exit_from_bound(&self, bound: Bound, mut outside: (f64, f64)) -> f64 {
        for _ in 0..HALVINGS {
            let theta = 0.5 * outside.0;
            let probe = (theta, self.margin_at(bound, theta));
            if probe.1 > 0.0 {
                return self.crossing(bound, probe, outside);
            }
            outside = probe;
        }
        0.0
    }

    /// Where a signal crosses a bound between a point inside and one outside.
    #[cold]
    pub(crate) fn crossing(&self, bound: Bound, inside: (f64, f64), outside: (f64, f64)) -> f64 {
        root(|theta| self.margin_at(bound, theta), inside, outside)
    }

    /// How far a signal is inside a bound at a share of the trial.
    fn margin_at(&self, bound: Bound, theta: f64) -> f64 {
        self.margin(bound, theta, &self.state(theta))
    }

    /// How far a signal is inside a bound in a state at a share of the trial.
    #[inline(always)]
    pub(crate) fn margin(&self, bound: Bound, theta: f64, x: &State<f64, A>) -> f64 {
        let axis = bound.axis;
        let value = match bound.signal {
            Signal::Velocity => x.motor_velocity[axis],
            Signal::Deflection => x.deflection[axis],
            Signal::NetTorque => {
                let torque = self.torque.at(self.share(theta))[axis];
                self.motion
                    .equations
                    .net_torque(axis, &self.motion.regimes[axis], torque, x)
            }
        };
        if bound.upwards {
            bound.value - value
        } else {
            value - bound.value
        }
    }

    /// Time derivative of the margin.
    #[inline(always)]
    pub(crate) fn margin_rate(&self, bound: Bound, theta: f64, derivative: &State<f64, A>) -> f64 {
        let axis = bound.axis;
        let rate = match bound.signal {
            Signal::Velocity => derivative.motor_velocity[axis],
            Signal::Deflection => derivative.deflection[axis],
            Signal::NetTorque => {
                let torque_rate = self.torque.slope(axis, self.share(theta)) / self.step_s;
                let (equations, regime) = (&self.motion.equations, &self.motion.regimes[axis]);
                equations.net_torque_rate(axis, regime, torque_rate, derivative)
            }
        };
        if bound.upwards { -rate } else { rate }
    }
}
