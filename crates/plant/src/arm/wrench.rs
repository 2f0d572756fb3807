//! Wrench: force and moment on a link, and the sums and products of vectors that it needs.

use std::array::from_fn;

use crate::scalar::Scalar;

/// Force and moment about the origin of a link.
#[derive(Clone, Copy)]
pub(crate) struct Wrench<L> {
    pub force: [L; 3],
    pub moment: [L; 3],
}

impl<L: Scalar> Wrench<L> {
    /// No force and no moment.
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        let zero = [L::splat(0.0); 3];
        Self {
            force: zero,
            moment: zero,
        }
    }

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
pub(crate) fn add<L: Scalar>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    from_fn(|k| a[k] + b[k])
}

/// Cross product of two vectors.
#[inline(always)]
pub(crate) fn cross<L: Scalar>([ax, ay, az]: [L; 3], [bx, by, bz]: [L; 3]) -> [L; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}
