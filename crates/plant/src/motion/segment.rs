//! Motor torque within one step of the integrator.

use std::array::from_fn;

/// Torques of `A` motors in N m over one step, each a parabola of the share theta in [0, 1] of the
/// step: exact for zoh and linear hold, and for any other function through its values at start,
/// middle and end, the only ones RK4 looks at. A step that an event cuts in two sees the same
/// parabola, so fourth order is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment<const A: usize> {
    /// Torque at the start of the step.
    start: [f64; A],
    /// Coefficient of theta.
    linear: [f64; A],
    /// Coefficient of theta^2.
    square: [f64; A],
}

impl<const A: usize> Segment<A> {
    /// The same torque over the whole step.
    #[must_use]
    pub(crate) fn constant(torque: [f64; A]) -> Self {
        Self {
            start: torque,
            linear: [0.0; A],
            square: [0.0; A],
        }
    }

    /// The parabola through the torques at start, middle and end of the step.
    #[must_use]
    pub(crate) fn through(start: [f64; A], middle: [f64; A], end: [f64; A]) -> Self {
        Self {
            start,
            linear: from_fn(|axis| 4.0 * middle[axis] - 3.0 * start[axis] - end[axis]),
            square: from_fn(|axis| 2.0 * (start[axis] + end[axis]) - 4.0 * middle[axis]),
        }
    }

    /// The parabola through the torques that a function of the share gives at start, middle and end.
    pub(crate) fn of(torque: impl Fn(f64) -> [f64; A]) -> Self {
        Self::through(torque(0.0), torque(0.5), torque(1.0))
    }

    /// The torque at a share of the step.
    #[inline]
    #[must_use]
    pub(crate) fn at(&self, theta: f64) -> [f64; A] {
        from_fn(|axis| self.start[axis] + theta * (self.linear[axis] + theta * self.square[axis]))
    }

    /// Change of an axis' torque per share of the step.
    #[must_use]
    pub(crate) fn slope(&self, axis: usize, theta: f64) -> f64 {
        self.linear[axis] + 2.0 * theta * self.square[axis]
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
