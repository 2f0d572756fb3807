//! Equations of motion of motors, gears and links, one formula within a mode.
//!
//! Always inlined: a call would send the state through memory, which costs a sixth of the time of a
//! simulation with friction.

use std::array::from_fn;

use crate::joint::flexible_joint::{FlexibleJoint, Regime};
use crate::scalar::Scalar;

/// What the gears drive: given link positions, velocities and the torques that the gears transmit,
/// the accelerations.
pub(crate) trait Links<const A: usize> {
    /// Accelerations in rad/s^2 of the links at positions in rad and velocities in rad/s under
    /// torques in N m.
    fn acceleration<L: Scalar>(&self, position: [L; A], velocity: [L; A], torque: [L; A])
    -> [L; A];

    /// Torques in N m that keep the links at constant velocities in rad/s when they pass positions
    /// in rad.
    fn holding(&self, position: [f64; A], velocity: [f64; A]) -> [f64; A];

    /// Mass matrix in kg m^2 at positions in rad.
    fn mass(&self, position: [f64; A]) -> [[f64; A]; A];

    /// Derivative in N m/rad of the torques against gravity with respect to the positions, (torque,
    /// position).
    fn gravity_gradient(&self, position: [f64; A]) -> [[f64; A]; A];

    /// Potential energy in J in the field of gravity, but for a constant.
    fn potential_j(&self, position: [f64; A]) -> f64;
}

/// A single link on a fixed axis: J_o qo'' = torque (SK15 eq. (22)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SingleLink {
    /// 1/J_o in 1/(kg m^2).
    pub mobility: f64,
}

impl Links<1> for SingleLink {
    #[inline(always)]
    fn acceleration<L: Scalar>(
        &self,
        _position: [L; 1],
        _velocity: [L; 1],
        [torque]: [L; 1],
    ) -> [L; 1] {
        [torque * L::splat(self.mobility)]
    }

    fn holding(&self, _position: [f64; 1], _velocity: [f64; 1]) -> [f64; 1] {
        [0.0]
    }

    fn mass(&self, _position: [f64; 1]) -> [[f64; 1]; 1] {
        [[1.0 / self.mobility]]
    }

    fn gravity_gradient(&self, _position: [f64; 1]) -> [[f64; 1]; 1] {
        [[0.0]]
    }

    fn potential_j(&self, _position: [f64; 1]) -> f64 {
        0.0
    }
}

/// Joints and what they drive: a machine of `A` axes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Machine<K, const A: usize> {
    /// Motor and gear of every axis.
    pub joints: [FlexibleJoint; A],
    /// What they move.
    pub links: K,
}

/// The state of a machine of `A` axes, or its derivative. The deflection is a state of its own,
/// instead of the link position, so that it keeps its digits however far the machine has travelled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State<L, const A: usize> {
    /// Motor position qm in rad.
    pub motor_position: [L; A],
    /// Deflection dq = qm - qo of the gear in rad.
    pub deflection: [L; A],
    /// Motor velocity in rad/s.
    pub motor_velocity: [L; A],
    /// Link velocity in rad/s.
    pub link_velocity: [L; A],
}

impl<L: Scalar, const A: usize> State<L, A> {
    /// Rate dq' = qm' - qo' in rad/s of an axis' deflection.
    #[inline(always)]
    fn deflection_rate(&self, axis: usize) -> L {
        self.motor_velocity[axis] - self.link_velocity[axis]
    }

    /// The state `step` s further along a derivative.
    #[inline(always)]
    #[must_use]
    pub(crate) fn along(&self, derivative: &Self, step: L) -> Self {
        let add = |x: &[L; A], dx: &[L; A]| from_fn(|axis| x[axis] + step * dx[axis]);
        Self {
            motor_position: add(&self.motor_position, &derivative.motor_position),
            deflection: add(&self.deflection, &derivative.deflection),
            motor_velocity: add(&self.motor_velocity, &derivative.motor_velocity),
            link_velocity: add(&self.link_velocity, &derivative.link_velocity),
        }
    }
}

impl<K: Links<A>, const A: usize> Machine<K, A> {
    /// Torque tau_s(dq) + d dq' in N m that an axis' gear transmits to its link.
    #[inline(always)]
    pub(crate) fn transmitted<L: Scalar>(
        &self,
        axis: usize,
        regime: &Regime<L>,
        x: &State<L, A>,
    ) -> L {
        let damping = L::splat(self.joints[axis].damping_nms_per_rad);
        regime.slope_nm_per_rad * x.deflection[axis]
            + regime.offset_nm
            + damping * x.deflection_rate(axis)
    }

    /// Torque in N m on an axis' motor besides its friction: u - ripple(qm) - tau_s(dq) - d dq'.
    /// What changes last within a step is subtracted last: the steps wait for each other, and this
    /// shortens the wait.
    #[inline(always)]
    pub(crate) fn net_torque<L: Scalar>(
        &self,
        axis: usize,
        regime: &Regime<L>,
        torque: L,
        x: &State<L, A>,
    ) -> L {
        let joint = &self.joints[axis];
        let position = x.motor_position[axis];
        let net = joint
            .ripple
            .iter()
            .fold(torque - regime.offset_nm, |net, ripple| {
                net - ripple.torque(position)
            });
        net - regime.slope_nm_per_rad * x.deflection[axis]
            - L::splat(joint.damping_nms_per_rad) * x.deflection_rate(axis)
    }

    /// Time derivative of the state under motor torques in N m (SK15 eqs. (20)-(22)).
    #[inline(always)]
    pub(crate) fn derivative<L: Scalar>(
        &self,
        regimes: &[Regime<L>; A],
        torque: &[L; A],
        x: &State<L, A>,
    ) -> State<L, A> {
        let transmitted = from_fn(|axis| self.transmitted(axis, &regimes[axis], x));
        let link_position = from_fn(|axis| x.motor_position[axis] - x.deflection[axis]);
        State {
            motor_position: x.motor_velocity,
            deflection: from_fn(|axis| x.deflection_rate(axis)),
            motor_velocity: from_fn(|axis| {
                let viscous = L::splat(self.joints[axis].friction.viscous_nms_per_rad)
                    * x.motor_velocity[axis];
                let net = self.net_torque(
                    axis,
                    &regimes[axis],
                    torque[axis] - regimes[axis].coulomb_nm,
                    x,
                );
                regimes[axis].mobility * (net - viscous)
            }),
            link_velocity: self
                .links
                .acceleration(link_position, x.link_velocity, transmitted),
        }
    }

    /// One classical Runge-Kutta step of `step` s from `x`, whose derivative is `first`, under the
    /// torques in N m at the step's middle and end.
    #[inline(always)]
    pub(crate) fn rk4<L: Scalar>(
        &self,
        regimes: &[Regime<L>; A],
        [middle, end]: [&[L; A]; 2],
        x: &State<L, A>,
        first: &State<L, A>,
        step: L,
    ) -> State<L, A> {
        let half = L::splat(0.5) * step;
        let second = self.derivative(regimes, middle, &x.along(first, half));
        let third = self.derivative(regimes, middle, &x.along(&second, half));
        let fourth = self.derivative(regimes, end, &x.along(&third, step));
        let (sixth, third_part) = (L::splat(1.0 / 6.0) * step, L::splat(1.0 / 3.0) * step);
        x.along(first, sixth)
            .along(&second, third_part)
            .along(&third, third_part)
            .along(&fourth, sixth)
    }
}
