//! Links: what the gears drive, a single one here, those of an arm in their own files.

use std::fmt::Debug;

use crate::lanes::{LANES, Lanes};
use crate::motion::fleet::Fleet;
use crate::motion::integrator::Integrator;
use crate::motion::side_by_side::SideBySide;
use crate::scalar::Scalar;

/// What the gears drive: given link positions, velocities and the torques that the gears transmit,
/// the accelerations, of one machine or of several side by side.
pub(crate) trait Acceleration<L, const A: usize> {
    /// Accelerations in rad/s^2 of the links at positions in rad and velocities in rad/s under
    /// torques in N m.
    fn acceleration(&self, position: &[L; A], velocity: &[L; A], torque: &[L; A]) -> [L; A];

    /// Sine of an angle of the ripple: the library's, or a formula that lanes can follow.
    fn sin(&self, angle: L) -> L;
}

/// The links of one machine.
pub(crate) trait Links<const A: usize>:
    Acceleration<f64, A> + Clone + Debug + Send + Sync + 'static
{
    /// A fleet of a machine with these links, which others may join; `None` if it moves alone.
    fn fleet(_machine: &Integrator<Self, A>) -> Option<Box<dyn Fleet>> {
        None
    }

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

/// Links whose accelerations are computed `N` side by side.
pub(crate) trait LinksSideBySide<const A: usize, const N: usize>: Links<A> {
    /// Those of several machines.
    type InLanes: Acceleration<Lanes<N>, A> + Debug;

    /// Whether these links and others can be in lanes side by side.
    fn alike(&self, _other: &Self) -> bool {
        true
    }

    /// The links of a machine for each lane.
    fn in_lanes(each: [&Self; N]) -> Self::InLanes;
}

/// A single link on a fixed axis: J_o qo'' = torque (SK15 eq. (22)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SingleLink<L = f64> {
    /// 1/J_o in 1/(kg m^2).
    pub mobility: L,
}

impl<L: Scalar> Acceleration<L, 1> for SingleLink<L> {
    #[inline(always)]
    fn acceleration(&self, _position: &[L; 1], _velocity: &[L; 1], torque: &[L; 1]) -> [L; 1] {
        [torque[0] * self.mobility]
    }

    #[inline(always)]
    fn sin(&self, angle: L) -> L {
        angle.sin()
    }
}

impl<const N: usize> LinksSideBySide<1, N> for SingleLink {
    type InLanes = SingleLink<Lanes<N>>;

    fn in_lanes(each: [&Self; N]) -> SingleLink<Lanes<N>> {
        SingleLink {
            mobility: Lanes::of(|lane| each[lane].mobility),
        }
    }
}

impl Links<1> for SingleLink {
    fn fleet(machine: &Integrator<Self, 1>) -> Option<Box<dyn Fleet>> {
        Some(Box::new(SideBySide::<_, _, 1, LANES>::of(machine.clone())))
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
