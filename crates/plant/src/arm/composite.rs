//! Composite rigid body: a link with all that it carries, as moments of its mass.

use crate::arm::chain::Link;
use crate::arm::wrench::{Wrench, add};
use crate::scalar::Number;

/// First moments h and second moments S of a link with all that it carries. (Its mass is put to the
/// base's.)
#[derive(Clone, Copy)]
pub(crate) struct Composite<L> {
    pub first: [L; 3],
    pub xx: L,
    pub yy: L,
    pub zz: L,
    pub xy: L,
    pub xz: L,
    pub yz: L,
}

impl<L: Number> Composite<L> {
    /// A link alone.
    #[inline(always)]
    pub(crate) fn own(link: &Link<L>) -> Self {
        let ([hx, hy], [xx, yy, xy, xz, yz]) = (link.first, link.second);
        let zero = hx.like(0.0);
        Self {
            first: [hx, hy, zero],
            xx,
            yy,
            zz: zero,
            xy,
            xz,
            yz,
        }
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            first: add(self.first, other.first),
            xx: self.xx + other.xx,
            yy: self.yy + other.yy,
            zz: self.zz + other.zz,
            xy: self.xy + other.xy,
            xz: self.xz + other.xz,
            yz: self.yz + other.yz,
        }
    }

    /// What a unit of angular acceleration about z takes.
    #[inline(always)]
    pub(crate) fn wrench(&self) -> Wrench<L> {
        let [hx, hy, _] = self.first;
        Wrench {
            force: [-hy, hx, hx.like(0.0)],
            moment: [-self.xz, -self.yz, self.xx + self.yy],
        }
    }
}
