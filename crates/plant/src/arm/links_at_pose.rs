//! Links whose dynamics do not depend on position: challenge D switched off.

use std::array::from_fn;

use crate::motion::links::{Acceleration, Links};
use crate::scalar::Scalar;

/// Links with the mass matrix of a pose, no Coriolis torques and gravity that changes linearly
/// about the pose: M(q0) qo'' + g(q0) + dg/dq (qo - q0) = torque. Whatever they travel, they obey
/// the linear truth.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LinksAtPose<const A: usize> {
    /// The pose q0 in rad.
    pub pose: [f64; A],
    /// M(q0) in kg m^2.
    pub mass: [[f64; A]; A],
    /// M(q0)^-1 in 1/(kg m^2).
    pub mobility: [[f64; A]; A],
    /// g(q0) in N m.
    pub gravity: [f64; A],
    /// dg/dq at q0 in N m/rad.
    pub gradient: [[f64; A]; A],
}

impl<const A: usize> LinksAtPose<A> {
    /// Links as they are at a pose in rad.
    pub(crate) fn new(links: &impl Links<A>, pose: [f64; A]) -> Self {
        let zero = [0.0; A];
        let gravity = links.holding(pose, zero);
        let unit = |j: usize| from_fn(|i| gravity[i] + f64::from(u8::from(i == j)));
        let columns: [[f64; A]; A] = from_fn(|j| links.acceleration(&pose, &zero, &unit(j)));
        Self {
            pose,
            mass: links.mass(pose),
            mobility: from_fn(|i| from_fn(|j| 0.5 * (columns[j][i] + columns[i][j]))),
            gravity,
            gradient: links.gravity_gradient(pose),
        }
    }
}

#[inline(always)]
fn product<L: Scalar, const A: usize>(matrix: &[[f64; A]; A], x: &[L; A]) -> [L; A] {
    from_fn(|i| (0..A).fold(L::splat(0.0), |sum, j| sum + L::splat(matrix[i][j]) * x[j]))
}

impl<const A: usize> LinksAtPose<A> {
    #[inline(always)]
    fn gravity_nm<L: Scalar>(&self, position: &[L; A]) -> [L; A] {
        let change = product(
            &self.gradient,
            &from_fn(|i| position[i] - L::splat(self.pose[i])),
        );
        from_fn(|i| L::splat(self.gravity[i]) + change[i])
    }
}

impl<L: Scalar, const A: usize> Acceleration<L, A> for LinksAtPose<A> {
    #[inline(always)]
    fn acceleration(&self, position: &[L; A], _velocity: &[L; A], torque: &[L; A]) -> [L; A] {
        let gravity = self.gravity_nm(position);
        product(&self.mobility, &from_fn(|i| torque[i] - gravity[i]))
    }

    #[inline(always)]
    fn sin(&self, angle: L) -> L {
        angle.sin()
    }
}

impl<const A: usize> Links<A> for LinksAtPose<A> {
    fn holding(&self, position: [f64; A], _velocity: [f64; A]) -> [f64; A] {
        self.gravity_nm(&position)
    }

    fn mass(&self, _position: [f64; A]) -> [[f64; A]; A] {
        self.mass
    }

    fn gravity_gradient(&self, _position: [f64; A]) -> [[f64; A]; A] {
        self.gradient
    }

    fn potential_j(&self, position: [f64; A]) -> f64 {
        let travel = from_fn(|i| position[i] - self.pose[i]);
        let change = product(&self.gradient, &travel);
        (0..A)
            .map(|i| travel[i] * (self.gravity[i] + 0.5 * change[i]))
            .sum()
    }
}
