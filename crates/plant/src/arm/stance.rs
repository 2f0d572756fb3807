//! Stance of a link on its parent: vectors, wrenches and moments of mass from frame to frame.

use crate::arm::chain::Link;
use crate::arm::composite::Composite;
use crate::arm::wrench::{Wrench, add, cross};
use crate::scalar::Number;
use crate::sine::Angle;

/// How a link stands on its parent.
#[derive(Clone, Copy)]
pub(crate) struct Stance<L> {
    /// Cosine and sine of the twist about x.
    twist: [L; 2],
    /// Cosine and sine of the turn about z.
    turn: [L; 2],
    /// Origin in the parent's frame.
    pub offset: [L; 3],
}

impl<L: Number> Stance<L> {
    /// The stance of a link whose joint is at a position in rad.
    #[inline(always)]
    pub(crate) fn new(link: &Link<L>, position: L) -> Self
    where
        L: Angle,
    {
        let (sin, cos) = Angle::sin_cos(position + link.zero_rad);
        Self {
            twist: link.twist,
            turn: [cos, sin],
            offset: link.offset,
        }
    }

    /// A vector of the parent's frame in the link's.
    #[inline(always)]
    pub(crate) fn inwards(&self, [x, y, z]: [L; 3]) -> [L; 3] {
        let ([c, s], [cos, sin]) = (self.twist, self.turn);
        let (y, z) = (c * y + s * z, c * z - s * y);
        [cos * x + sin * y, cos * y - sin * x, z]
    }

    /// A vector of the link's frame in the parent's.
    #[inline(always)]
    pub(crate) fn outwards(&self, [x, y, z]: [L; 3]) -> [L; 3] {
        let ([c, s], [cos, sin]) = (self.twist, self.turn);
        let (x, y) = (cos * x - sin * y, sin * x + cos * y);
        [x, c * y - s * z, s * y + c * z]
    }

    /// A wrench on the link as one on the parent.
    #[inline(always)]
    pub(crate) fn wrench(&self, wrench: Wrench<L>) -> Wrench<L> {
        let force = self.outwards(wrench.force);
        Wrench {
            force,
            moment: add(self.outwards(wrench.moment), cross(self.offset, force)),
        }
    }

    /// What the link carries as a part of what the parent carries.
    #[inline(always)]
    pub(crate) fn carried(
        &self,
        Composite {
            first,
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        }: Composite<L>,
    ) -> Composite<L> {
        let ([c, s], [cos, sin]) = (self.twist, self.turn);
        // about z
        let (u, v) = (cos * xx - sin * xy, cos * xy - sin * yy);
        let (sum, xx, xy) = (xx + yy, cos * u - sin * v, sin * u + cos * v);
        let (yy, xz, yz) = (sum - xx, cos * xz - sin * yz, sin * xz + cos * yz);
        // about x
        let (u, v) = (c * yy - s * yz, c * yz - s * zz);
        let (sum, yy, yz) = (yy + zz, c * u - s * v, s * u + c * v);
        let (zz, xy, xz) = (sum - yy, c * xy - s * xz, s * xy + c * xz);
        // to the parent's origin
        let first = self.outwards(first);
        let ([hx, hy, hz], [ox, oy, oz]) = (first, self.offset);
        let two = first[0].like(2.0);
        Composite {
            first,
            xx: xx + two * (ox * hx),
            yy: yy + two * (oy * hy),
            zz: zz + two * (oz * hz),
            xy: xy + (ox * hy + oy * hx),
            xz: xz + (ox * hz + oz * hx),
            yz: yz + (oy * hz + oz * hy),
        }
    }
}
