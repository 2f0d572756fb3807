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
        [end, end_derivative]: [&State<f64, A>; 2],
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

#[cfg(test)]
mod tests {
    use crate::motion::equations::State;
    use crate::motion::exact::{Exact, longest_step_s};
    use crate::motion::integrator::Integrator;
    use crate::motion::{Acting, Motion as _};
    use crate::robot::Robot as _;
    use crate::single_joint::SingleJoint;

    /// In so many steps, over a step of the largest length: the motor slows down, is at rest for a
    /// moment and goes on, by v = b + C (cos(0.04) x - sin x) with x the phase of its resonance,
    /// from -0.05 on. Its slope is above 0 at either end.
    fn through_a_dip(n_steps: usize) -> (State<f64, 1>, f64) {
        let mut joint = SingleJoint::default();
        joint.joint.damping_nms_per_rad = 0.0;
        joint.joint.friction.coulomb_nm = 50.0;
        let (motor, link) = (joint.joint.motor_inertia_kg_m2, joint.link_inertia_kg_m2);
        let (b, swing, share) = (1e-6, 0.1, link / (motor + link));
        let (rate, start) = (joint.fastest_rad_s(), -0.05_f64);
        let driven = swing * rate * 0.04_f64.cos() * (motor + link);
        let mean = b + swing * 0.04_f64.cos() * start;
        let spin = -swing * start.sin() / share;
        let step_s = longest_step_s(rate) / n_steps as f64;
        let machine = joint.machine();
        let exact = Exact::of(&machine, rate, step_s).expect("short enough");
        let velocity = mean + share * spin;
        let mut motion = Integrator::start_by(exact, machine, [0.0], [velocity]);
        motion.state = State {
            motor_position: [0.0],
            deflection: [driven / (motor * rate * rate) + swing * start.cos() / (share * rate)],
            motor_velocity: [velocity],
            link_velocity: [mean + (share - 1.0) * spin],
        };
        let moved = motion.advance(n_steps, step_s, Acting::Held(&[driven + 50.0]));
        assert_eq!(moved, Ok(()));
        (motion.state, motion.stuck_s[0])
    }

    #[test]
    fn a_dip_below_zero_within_a_step_is_found_though_both_slopes_are_upwards() {
        let ((found, stuck_s), (expected, stuck_in_short_s)) =
            (through_a_dip(1), through_a_dip(50));
        assert!(stuck_s > 1e-4 && (stuck_s - stuck_in_short_s).abs() < 1e-9);
        for (found, expected) in [
            (found.motor_velocity, expected.motor_velocity),
            (found.deflection, expected.deflection),
            (found.link_velocity, expected.link_velocity),
        ] {
            assert!((found[0] - expected[0]).abs() < 1e-12);
        }
    }
}
