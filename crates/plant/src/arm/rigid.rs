//! Moments of a mass distribution, which add up and move from frame to frame.

use std::ops::{AddAssign, SubAssign};

use nalgebra::{Matrix3, Vector3};

use crate::arm::inertia::Inertia;

/// The moments of order 0, 1 and 2 of a mass distribution, about the origin of the frame they are
/// given in. The inertia tensor about the origin is tr(second) 1 - second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rigid {
    /// Mass in kg: the integral of dm.
    pub mass: f64,
    /// Integral of x dm in kg m: mass times centre of mass.
    pub first: Vector3<f64>,
    /// Integral of x x^T dm in kg m^2.
    pub second: Matrix3<f64>,
}

impl Rigid {
    /// Nothing.
    pub(crate) fn zero() -> Self {
        Self {
            mass: 0.0,
            first: Vector3::zeros(),
            second: Matrix3::zeros(),
        }
    }

    /// A body of a mass in kg, a centre of mass in m and an inertia tensor in kg m^2 about it.
    pub(crate) fn new(mass: f64, center_of_mass: &[f64; 3], inertia: Inertia) -> Self {
        let inertia = inertia.matrix();
        let second = Matrix3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
        let about_itself = Self {
            mass,
            first: Vector3::zeros(),
            second,
        };
        about_itself.seen(&Matrix3::identity(), &Vector3::from(*center_of_mass))
    }

    /// The same seen from a frame in which this frame has an orientation R and an origin o: x
    /// becomes R x + o.
    pub(crate) fn seen(&self, rotation: &Matrix3<f64>, origin: &Vector3<f64>) -> Self {
        let turned = rotation * self.first;
        let mixed = turned * origin.transpose();
        let second = rotation * self.second * rotation.transpose() + mixed + mixed.transpose();
        Self {
            mass: self.mass,
            first: turned + self.mass * origin,
            second: second + self.mass * origin * origin.transpose(),
        }
    }

    /// The part that lies on the z axis as far as the motion of a body on that axis can tell: mass,
    /// first moment along it and second moment along it.
    pub(crate) fn on_axis(&self) -> Self {
        let mut second = Matrix3::zeros();
        second[(2, 2)] = self.second[(2, 2)];
        Self {
            mass: self.mass,
            first: Vector3::new(0.0, 0.0, self.first.z),
            second,
        }
    }
}

impl AddAssign for Rigid {
    fn add_assign(&mut self, other: Self) {
        self.mass += other.mass;
        self.first += other.first;
        self.second += other.second;
    }
}

impl SubAssign for Rigid {
    fn sub_assign(&mut self, other: Self) {
        self.mass -= other.mass;
        self.first -= other.first;
        self.second -= other.second;
    }
}

/// A matrix given row by row.
pub(crate) fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| rows[row][column])
}
