//! Motor torque within one step of the integrator.

use crate::lanes::Lanes;
use crate::scalar::{Scalar, each};

/// Torques of `A` motors in N m over one step, each a parabola of the share theta in [0, 1] of the
/// step: exact for zoh and linear hold, and for any other function through its values at start,
/// middle and end, the only ones RK4 looks at. A step that an event cuts in two sees the same
/// parabola, so fourth order is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment<const A: usize, L = f64> {
    /// Torque at the start of the step.
    start: [L; A],
    /// Coefficient of theta.
    linear: [L; A],
    /// Coefficient of theta^2.
    square: [L; A],
}

impl<const A: usize, L: Scalar> Segment<A, L> {
    /// The same torque over the whole step.
    #[must_use]
    pub(crate) fn constant(torque: [L; A]) -> Self {
        Self {
            start: torque,
            linear: [L::splat(0.0); A],
            square: [L::splat(0.0); A],
        }
    }

    /// The parabola through the torques at start, middle and end of the step.
    #[must_use]
    pub(crate) fn through(start: [L; A], middle: [L; A], end: [L; A]) -> Self {
        let (two, four) = (L::splat(2.0), L::splat(4.0));
        Self {
            start,
            linear: each(|axis| four * middle[axis] - L::splat(3.0) * start[axis] - end[axis]),
            square: each(|axis| two * (start[axis] + end[axis]) - four * middle[axis]),
        }
    }

    /// The parabola through the torques that a function of the share gives at start, middle and end.
    pub(crate) fn of(torque: impl Fn(f64) -> [L; A]) -> Self {
        Self::through(torque(0.0), torque(0.5), torque(1.0))
    }

    /// The piece of a straight line between two torques that lies in one of so many steps.
    #[inline(always)]
    pub(crate) fn line(from: &[L; A], to: &[L; A], step: usize, n_steps: usize) -> Self {
        Self::of(|share| {
            let share = (step as f64 + share) / n_steps as f64;
            let (before, after) = (L::splat(1.0 - share), L::splat(share));
            each(|axis| before * from[axis] + after * to[axis])
        })
    }

    /// The torque at a share of the step.
    #[inline(always)]
    #[must_use]
    pub(crate) fn at(&self, theta: f64) -> [L; A] {
        let theta = L::splat(theta);
        let mut torque = self.start;
        for ((torque, linear), square) in torque.iter_mut().zip(&self.linear).zip(&self.square) {
            *torque = *torque + theta * (*linear + theta * *square);
        }
        torque
    }

    /// An axis' torque at the start of a step over which it is a straight line, and its change.
    #[inline(always)]
    pub(crate) fn line_of(&self, axis: usize) -> (L, L) {
        (self.start[axis], self.linear[axis])
    }

    /// Change of an axis' torque per share of the step.
    #[inline(always)]
    #[must_use]
    pub(crate) fn slope(&self, axis: usize, theta: f64) -> L {
        self.linear[axis] + L::splat(2.0 * theta) * self.square[axis]
    }
}

impl<const A: usize, const N: usize> Segment<A, Lanes<N>> {
    /// That of one machine.
    pub(crate) fn lane(&self, lane: usize) -> Segment<A> {
        let of = |x: &[Lanes<N>; A]| x.map(|x| x.0[lane]);
        Segment {
            start: of(&self.start),
            linear: of(&self.linear),
            square: of(&self.square),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Segment;

    #[test]
    fn the_parabola_passes_through_its_three_points() {
        let segment = Segment::through([1.0], [4.0], [-2.0]);
        assert_eq!(
            [0.0, 0.5, 1.0].map(|theta| segment.at(theta)[0]),
            [1.0, 4.0, -2.0]
        );
        let secant = (segment.at(0.3 + 1e-6)[0] - segment.at(0.3 - 1e-6)[0]) / 2e-6;
        assert!((segment.slope(0, 0.3) - secant).abs() < 1e-8);
    }
}
