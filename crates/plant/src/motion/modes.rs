//! Modes of machines side by side, in numbers: their regimes, and the intervals in which they hold.

use crate::joint::flexible_joint::{FlexibleJoint, Mode, Regime};
use crate::joint::friction::Slip;
use crate::lanes::Lanes;
use crate::scalar::Scalar;

/// A signal that decides on a mode, over a step: its values at both ends, and its rates there per
/// step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Course<const N: usize> {
    pub(crate) start: Lanes<N>,
    pub(crate) before: Lanes<N>,
    pub(crate) after: Lanes<N>,
    pub(crate) end: Lanes<N>,
}

/// An interval of each machine.
#[derive(Debug, Clone, Copy)]
struct Interval<const N: usize> {
    lower: Lanes<N>,
    upper: Lanes<N>,
}

/// The modes of every axis of machines side by side.
#[derive(Debug, Clone)]
pub(crate) struct Modes<const A: usize, const N: usize> {
    pub(crate) regimes: [Regime<Lanes<N>>; A],
    /// 1 while a motor is stuck, else 0.
    pub(crate) stuck: [Lanes<N>; A],
    /// Of the velocities while slipping, of the net torques when stuck.
    slip: [Interval<N>; A],
    /// Of the deflections.
    branch: [Interval<N>; A],
}

impl<const A: usize, const N: usize> Modes<A, N> {
    /// Of machines whose modes never end, until they are [set](Self::set).
    pub(crate) fn endless() -> Self {
        let zero = Lanes::splat(0.0);
        let regime = Regime {
            mobility: zero,
            coulomb_nm: zero,
            slope_nm_per_rad: zero,
            offset_nm: zero,
        };
        Self {
            regimes: [regime; A],
            stuck: [zero; A],
            slip: [Interval::everything(); A],
            branch: [Interval::everything(); A],
        }
    }

    /// Sets the modes of one machine.
    pub(crate) fn set(&mut self, lane: usize, joints: &[FlexibleJoint; A], modes: &[Mode; A]) {
        for axis in 0..A {
            let (joint, mode) = (&joints[axis], modes[axis]);
            self.regimes[axis].set(lane, &joint.regime(mode));
            self.stuck[axis].0[lane] = f64::from(u8::from(mode.slip == Slip::Stuck));
            self.slip[axis].set(lane, joint.friction.interval(mode.slip));
            self.branch[axis].set(lane, joint.spring.interval(mode.branch));
        }
    }

    /// Leaves a machine in the modes that it has for good.
    pub(crate) fn keep(&mut self, lane: usize) {
        for interval in self.slip.iter_mut().chain(&mut self.branch) {
            interval.set(lane, (f64::NEG_INFINITY, f64::INFINITY));
        }
    }

    /// Whether the motor of an axis is stuck in any machine.
    #[inline(always)]
    pub(crate) fn any_stuck(&self, axis: usize) -> bool {
        let mut any = false;
        for stuck in self.stuck[axis].0 {
            any |= stuck != 0.0;
        }
        any
    }

    /// Whether the mode of an axis may end within a step, given what decides on its slip and on its
    /// branch of the spring.
    #[inline(always)]
    pub(crate) fn may_end(&self, axis: usize, lane: usize, courses: &[Course<N>; 2]) -> bool {
        self.slip[axis].may_leave(lane, &courses[0])
            | self.branch[axis].may_leave(lane, &courses[1])
    }
}

impl<const N: usize> Regime<Lanes<N>> {
    fn set(&mut self, lane: usize, regime: &Regime<f64>) {
        self.mobility.0[lane] = regime.mobility;
        self.coulomb_nm.0[lane] = regime.coulomb_nm;
        self.slope_nm_per_rad.0[lane] = regime.slope_nm_per_rad;
        self.offset_nm.0[lane] = regime.offset_nm;
    }
}

impl<const N: usize> Interval<N> {
    fn everything() -> Self {
        Self {
            lower: Lanes([f64::NEG_INFINITY; N]),
            upper: Lanes([f64::INFINITY; N]),
        }
    }

    fn set(&mut self, lane: usize, (lower, upper): (f64, f64)) {
        (self.lower.0[lane], self.upper.0[lane]) = (lower, upper);
    }

    /// Whether a signal is outside at the end of a step, or may have been within: its tangent at either
    /// end leads outside over the step. (A cubic stays where its Bernstein coefficients are, its ends
    /// and a third of the way along the tangents.)
    #[inline(always)]
    fn may_leave(&self, lane: usize, course: &Course<N>) -> bool {
        let (lower, upper, end) = (self.lower.0[lane], self.upper.0[lane], course.end.0[lane]);
        let ahead = course.start.0[lane] + course.before.0[lane];
        let behind = end - course.after.0[lane];
        // a signal that is not a number is inside nothing
        let below = !((end >= lower) & (ahead >= lower) & (behind >= lower));
        let above = !((end <= upper) & (ahead <= upper) & (behind <= upper));
        ((lower > f64::NEG_INFINITY) & below) | ((upper < f64::INFINITY) & above)
    }
}
