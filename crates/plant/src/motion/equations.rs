//! Equations of motion of motors, gears and links, one formula within a mode.
//!
//! Always inlined, and in loops instead of closures, which are not: a call would send the state through
//! memory, which costs a sixth of the time of a simulation with friction, and would cost machines side
//! by side their vector instructions.

use std::array::from_fn;

use crate::joint::flexible_joint::{FlexibleJoint, Regime};
use crate::joint::ripple::{Ripple, Wave};
use crate::lanes::Lanes;
use crate::motion::links::{Acceleration, Links, LinksSideBySide};
use crate::scalar::Scalar;

/// Joints and what they drive: a machine of `A` axes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Machine<K, const A: usize> {
    /// Motor and gear of every axis.
    pub joints: [FlexibleJoint; A],
    /// What they move.
    pub links: K,
}

/// What no mode changes about a motor and its gear, in numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive<L> {
    damping_nms_per_rad: L,
    viscous_nms_per_rad: L,
    ripple: Vec<Wave<L>>,
}

impl<L: Scalar> Drive<L> {
    /// Of joints with so many harmonics of ripple at most.
    fn of(n_waves: usize, number: impl Fn(&dyn Fn(&FlexibleJoint) -> f64) -> L) -> Self {
        let of_ripple = |index: usize, of: fn(&Ripple) -> f64| {
            number(&|joint| joint.ripple.get(index).map_or(0.0, of))
        };
        let wave = |index| Wave::of(|of| of_ripple(index, of));
        Self {
            damping_nms_per_rad: number(&|joint| joint.damping_nms_per_rad),
            viscous_nms_per_rad: number(&|joint| joint.friction.viscous_nms_per_rad),
            ripple: (0..n_waves).map(wave).collect(),
        }
    }
}

/// The right-hand side of the equations of motion: of one machine, or of several side by side, as
/// wide as its numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Equations<L, K, const A: usize> {
    drives: [Drive<L>; A],
    pub(crate) links: K,
}

impl<K: Links<A>, const A: usize> Equations<f64, K, A> {
    /// Those of one machine.
    pub(crate) fn of(joints: &[FlexibleJoint; A], links: K) -> Self {
        let drives = joints
            .each_ref()
            .map(|joint| Drive::of(joint.ripple.len(), |number| number(joint)));
        Self { drives, links }
    }
}

impl<K, const A: usize, const N: usize> Equations<Lanes<N>, K, A> {
    /// Those of machines with these joints and links.
    pub(crate) fn side_by_side<M: LinksSideBySide<A, N, InLanes = K>>(
        joints: [&[FlexibleJoint; A]; N],
        equations: [&Equations<f64, M, A>; N],
    ) -> Self {
        let drive = |axis: usize| {
            let n_waves = joints.map(|joints| joints[axis].ripple.len());
            Drive::of(n_waves.into_iter().fold(0, usize::max), |number| {
                Lanes::of(|lane| number(&joints[lane][axis]))
            })
        };
        Self {
            drives: from_fn(drive),
            links: M::in_lanes(equations.map(|equations| &equations.links)),
        }
    }
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
    /// All zero.
    pub(crate) fn zero() -> Self {
        let zero = [L::splat(0.0); A];
        Self {
            motor_position: zero,
            deflection: zero,
            motor_velocity: zero,
            link_velocity: zero,
        }
    }

    /// Rate dq' = qm' - qo' in rad/s of an axis' deflection.
    #[inline(always)]
    fn deflection_rate(&self, axis: usize) -> L {
        self.motor_velocity[axis] - self.link_velocity[axis]
    }

    /// The state `step` s further along a derivative.
    #[inline(always)]
    #[must_use]
    pub(crate) fn along(&self, derivative: &Self, step: L) -> Self {
        let (mut moved, rates) = (*self, derivative);
        for axis in 0..A {
            moved.motor_position[axis] =
                moved.motor_position[axis] + step * rates.motor_position[axis];
            moved.deflection[axis] = moved.deflection[axis] + step * rates.deflection[axis];
            moved.motor_velocity[axis] =
                moved.motor_velocity[axis] + step * rates.motor_velocity[axis];
            moved.link_velocity[axis] =
                moved.link_velocity[axis] + step * rates.link_velocity[axis];
        }
        moved
    }
}

impl<L: Scalar, K: Acceleration<L, A>, const A: usize> Equations<L, K, A> {
    /// Torque tau_s(dq) + d dq' in N m that an axis' gear transmits to its link.
    #[inline(always)]
    pub(crate) fn transmitted(&self, axis: usize, regime: &Regime<L>, x: &State<L, A>) -> L {
        let damping = self.drives[axis].damping_nms_per_rad;
        regime.slope_nm_per_rad * x.deflection[axis]
            + regime.offset_nm
            + damping * x.deflection_rate(axis)
    }

    /// Torque in N m on an axis' motor besides its friction: u - ripple(qm) - tau_s(dq) - d dq'.
    /// What changes last within a step is subtracted last: the steps wait for each other, and this
    /// shortens the wait.
    #[inline(always)]
    pub(crate) fn net_torque(
        &self,
        axis: usize,
        regime: &Regime<L>,
        torque: L,
        x: &State<L, A>,
    ) -> L {
        let drive = &self.drives[axis];
        let mut net = torque - regime.offset_nm;
        for wave in &drive.ripple {
            let angle = wave.angle(x.motor_position[axis]);
            net = net - wave.amplitude_nm * self.links.sin(angle);
        }
        net - regime.slope_nm_per_rad * x.deflection[axis]
            - drive.damping_nms_per_rad * x.deflection_rate(axis)
    }

    /// Rate in N m/s of the same on a motor at rest, whose torque changes at a rate in N m/s: the
    /// torques of motor and gear change, the ripple does not.
    #[inline(always)]
    pub(crate) fn net_torque_rate(
        &self,
        axis: usize,
        regime: &Regime<L>,
        torque_rate: L,
        derivative: &State<L, A>,
    ) -> L {
        torque_rate - regime.slope_nm_per_rad * derivative.deflection[axis]
            + self.drives[axis].damping_nms_per_rad * derivative.link_velocity[axis]
    }

    /// Time derivative of the state under motor torques in N m (SK15 eqs. (20)-(22)).
    #[inline(always)]
    pub(crate) fn derivative(
        &self,
        regimes: &[Regime<L>; A],
        torque: &[L; A],
        x: &State<L, A>,
    ) -> State<L, A> {
        let (mut transmitted, mut link_position, mut derivative) = (x.deflection, x.deflection, *x);
        for axis in 0..A {
            let regime = &regimes[axis];
            transmitted[axis] = self.transmitted(axis, regime, x);
            link_position[axis] = x.motor_position[axis] - x.deflection[axis];
            let viscous = self.drives[axis].viscous_nms_per_rad * x.motor_velocity[axis];
            let net = self.net_torque(axis, regime, torque[axis] - regime.coulomb_nm, x);
            derivative.motor_position[axis] = x.motor_velocity[axis];
            derivative.deflection[axis] = x.deflection_rate(axis);
            derivative.motor_velocity[axis] = regime.mobility * (net - viscous);
        }
        derivative.link_velocity =
            self.links
                .acceleration(&link_position, &x.link_velocity, &transmitted);
        derivative
    }

    /// One classical Runge-Kutta step of `step` s from `x`, whose derivative is `first`, under the
    /// torques in N m at the step's middle and end.
    #[inline(always)]
    pub(crate) fn rk4(
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
