//! Wrench: force and moment on a link, and the sums and products of vectors that it needs.

use crate::scalar::Number;

/// Force and moment about the origin of a link.
#[derive(Clone, Copy)]
pub(crate) struct Wrench<L> {
    pub force: [L; 3],
    pub moment: [L; 3],
}

impl<L: Number> Wrench<L> {
    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            force: add(self.force, other.force),
            moment: add(self.moment, other.moment),
        }
    }
}

/// Sum of two vectors.
#[inline(always)]
pub(crate) fn add<L: Number>([ax, ay, az]: [L; 3], [bx, by, bz]: [L; 3]) -> [L; 3] {
    [ax + bx, ay + by, az + bz]
}

/// Cross product of two vectors.
#[inline(always)]
pub(crate) fn cross<L: Number>([ax, ay, az]: [L; 3], [bx, by, bz]: [L; 3]) -> [L; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}
