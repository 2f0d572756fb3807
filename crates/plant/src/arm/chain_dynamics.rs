//! Mass matrix, Coriolis and gravity torques of a chain, link by link.
//!
//! The mass matrix follows from what each joint carries as one rigid body (composite rigid bodies),
//! the torques at constant velocity from accelerations outwards and forces inwards (Newton, Euler):
//! Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5 and 6. A point x of a link at angular
//! velocity w accelerates by E x with E = [w'] + [w]^2 ([w] x = w cross x), so with the moments h =
//! integral x dm and S = integral x x^T dm its force is E h and its moment the axial vector of E S.

use std::array::from_fn;

use crate::arm::chain::{Chain, Link};
use crate::arm::positive_definite::solve;
use crate::motion::equations::Links;
use crate::motion::scalar::Scalar;

/// How a link stands on its parent.
#[derive(Clone, Copy)]
struct Stance<L> {
    /// Cosine and sine of the twist about x.
    twist: [L; 2],
    /// Cosine and sine of the turn about z.
    turn: [L; 2],
    /// Origin in the parent's frame.
    offset: [L; 3],
}

/// First moments h and second moments S of a link with all that it carries. (Its mass is put to the
/// base's.)
#[derive(Clone, Copy)]
struct Composite<L> {
    first: [L; 3],
    xx: L,
    yy: L,
    zz: L,
    xy: L,
    xz: L,
    yz: L,
}

/// Force and moment about the origin of a link.
#[derive(Clone, Copy)]
struct Wrench<L> {
    force: [L; 3],
    moment: [L; 3],
}

#[inline(always)]
fn add<L: Scalar>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    from_fn(|k| a[k] + b[k])
}

#[inline(always)]
fn cross<L: Scalar>([ax, ay, az]: [L; 3], [bx, by, bz]: [L; 3]) -> [L; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

impl<L: Scalar> Stance<L> {
    #[inline(always)]
    fn new(link: &Link, position: L) -> Self {
        let (sin, cos) = (position + L::splat(link.zero_rad)).sin_cos();
        Self {
            twist: link.twist.map(L::splat),
            turn: [cos, sin],
            offset: link.offset.map(L::splat),
        }
    }

    /// A vector of the parent's frame in the link's.
    #[inline(always)]
    fn inwards(&self, [x, y, z]: [L; 3]) -> [L; 3] {
        let ([c, s], [cos, sin]) = (self.twist, self.turn);
        let (y, z) = (c * y + s * z, c * z - s * y);
        [cos * x + sin * y, cos * y - sin * x, z]
    }

    /// A vector of the link's frame in the parent's.
    #[inline(always)]
    fn outwards(&self, [x, y, z]: [L; 3]) -> [L; 3] {
        let ([c, s], [cos, sin]) = (self.twist, self.turn);
        let (x, y) = (cos * x - sin * y, sin * x + cos * y);
        [x, c * y - s * z, s * y + c * z]
    }

    /// A wrench on the link as one on the parent.
    #[inline(always)]
    fn wrench(&self, wrench: Wrench<L>) -> Wrench<L> {
        let force = self.outwards(wrench.force);
        Wrench {
            force,
            moment: add(self.outwards(wrench.moment), cross(self.offset, force)),
        }
    }

    /// What the link carries as a part of what the parent carries.
    #[inline(always)]
    fn carried(
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
        let two = L::splat(2.0);
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

impl<L: Scalar> Composite<L> {
    #[inline(always)]
    fn own(link: &Link) -> Self {
        let ([hx, hy], [xx, yy, xy, xz, yz], zero) = (
            link.first.map(L::splat),
            link.second.map(L::splat),
            L::splat(0.0),
        );
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
    fn plus(self, other: Self) -> Self {
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
    fn wrench(&self) -> Wrench<L> {
        let ([hx, hy, _], zero) = (self.first, L::splat(0.0));
        Wrench {
            force: [-hy, hx, zero],
            moment: [-self.xz, -self.yz, self.xx + self.yy],
        }
    }
}

impl Link {
    /// What it takes to accelerate the link's points x by a + E x.
    #[inline(always)]
    fn wrench<L: Scalar>(&self, [ax, ay, az]: [L; 3], e: &[[L; 3]; 3]) -> Wrench<L> {
        let ([hx, hy], [xx, yy, xy, xz, yz]) =
            (self.first.map(L::splat), self.second.map(L::splat));
        Wrench {
            force: from_fn(|k| e[k][0] * hx + e[k][1] * hy),
            moment: [
                hy * az + (e[2][0] * xy + e[2][1] * yy + (e[2][2] - e[1][1]) * yz - e[1][0] * xz),
                -(hx * az)
                    + ((e[0][0] - e[2][2]) * xz + e[0][1] * yz - e[2][0] * xx - e[2][1] * xy),
                hx * ay - hy * ax
                    + (e[1][0] * xx - e[0][1] * yy + (e[1][1] - e[0][0]) * xy + e[1][2] * xz
                        - e[0][2] * yz),
            ],
        }
    }
}

/// E = [w'] + [w]^2.
#[inline(always)]
fn spin<L: Scalar>([x, y, z]: [L; 3], [dx, dy, dz]: [L; 3]) -> [[L; 3]; 3] {
    let (xx, yy, zz, xy, xz, yz) = (x * x, y * y, z * z, x * y, x * z, y * z);
    [
        [-(yy + zz), xy - dz, xz + dy],
        [xy + dz, -(xx + zz), yz - dx],
        [xz - dy, yz + dx, -(xx + yy)],
    ]
}

impl<const A: usize> Chain<A> {
    #[inline(always)]
    fn stances<L: Scalar>(&self, position: [L; A]) -> [Stance<L>; A] {
        from_fn(|i| Stance::new(&self.links[i], position[i]))
    }

    /// What each joint carries.
    #[inline(always)]
    fn composites<L: Scalar>(&self, stances: &[Stance<L>; A]) -> [Composite<L>; A] {
        let mut composites = self.links.each_ref().map(Composite::own);
        for i in (1..A).rev() {
            composites[i - 1] = composites[i - 1].plus(stances[i].carried(composites[i]));
        }
        composites
    }

    /// The lower triangle of the mass matrix in kg m^2.
    #[inline(always)]
    fn lower_mass<L: Scalar>(&self, stances: &[Stance<L>; A]) -> [[L; A]; A] {
        let composites = self.composites(stances);
        let mut mass = [[L::splat(0.0); A]; A];
        for j in 0..A {
            let mut wrench = composites[j].wrench();
            mass[j][j] = wrench.moment[2];
            for i in (0..j).rev() {
                wrench = stances[i + 1].wrench(wrench);
                mass[j][i] = wrench.moment[2];
            }
        }
        mass
    }

    /// Torques in N m at constant velocities.
    #[inline(always)]
    fn bias<L: Scalar>(&self, stances: &[Stance<L>; A], velocity: [L; A]) -> [L; A] {
        let zero = L::splat(0.0);
        if !self.biased {
            return [zero; A];
        }
        let (mut w, mut dw, mut a) = ([zero; 3], [zero; 3], self.lift.map(L::splat));
        let mut e = [[zero; 3]; 3];
        let mut wrenches = [Wrench {
            force: [zero; 3],
            moment: [zero; 3],
        }; A];
        for i in 0..A {
            if i > 0 {
                let [ox, oy, oz] = stances[i].offset;
                a = from_fn(|k| a[k] + (e[k][0] * ox + e[k][1] * oy + e[k][2] * oz));
                (w, dw) = (stances[i].inwards(w), stances[i].inwards(dw));
            }
            a = stances[i].inwards(a);
            dw = [
                dw[0] + w[1] * velocity[i],
                dw[1] - w[0] * velocity[i],
                dw[2],
            ];
            w[2] = w[2] + velocity[i];
            e = spin(w, dw);
            wrenches[i] = self.links[i].wrench(a, &e);
        }
        for i in (1..A).rev() {
            let Wrench { force, moment } = stances[i].wrench(wrenches[i]);
            let own = wrenches[i - 1];
            wrenches[i - 1] = Wrench {
                force: add(own.force, force),
                moment: add(own.moment, moment),
            };
        }
        wrenches.map(|wrench| wrench.moment[2])
    }
}

impl<const A: usize> Links<A> for Chain<A> {
    /// Not inlined: it is long, is called from many places, and its call costs less than a
    /// hundredth of its time.
    #[inline(never)]
    fn acceleration<L: Scalar>(
        &self,
        position: [L; A],
        velocity: [L; A],
        torque: [L; A],
    ) -> [L; A] {
        let stances = self.stances(position);
        let bias = self.bias(&stances, velocity);
        solve(&self.lower_mass(&stances), from_fn(|i| torque[i] - bias[i]))
    }

    fn holding(&self, position: [f64; A], velocity: [f64; A]) -> [f64; A] {
        self.bias(&self.stances(position), velocity)
    }

    fn mass(&self, position: [f64; A]) -> [[f64; A]; A] {
        let lower = self.lower_mass(&self.stances(position));
        from_fn(|i| from_fn(|j| lower[i.max(j)][i.min(j)]))
    }

    /// Turning joint j turns the first moment h beyond it by z_j cross h, which changes the torque
    /// z_i (h cross a) of every joint i before it.
    fn gravity_gradient(&self, position: [f64; A]) -> [[f64; A]; A] {
        let mut gradient = [[0.0; A]; A];
        if !self.biased {
            return gradient;
        }
        let stances = self.stances(position);
        let (composites, lifts) = (self.composites(&stances), self.lifts(&stances));
        for j in 0..A {
            let [hx, hy, _] = composites[j].first;
            let mut change = [-hy, hx, 0.0];
            for i in (0..=j).rev() {
                gradient[i][j] = change[0] * lifts[i][1] - change[1] * lifts[i][0];
                gradient[j][i] = gradient[i][j];
                change = stances[i].outwards(change);
            }
        }
        gradient
    }

    fn potential_j(&self, position: [f64; A]) -> f64 {
        if !self.biased {
            return 0.0;
        }
        let stances = self.stances(position);
        let (composites, lifts) = (self.composites(&stances), self.lifts(&stances));
        (0..3).map(|k| composites[0].first[k] * lifts[0][k]).sum()
    }
}

impl<const A: usize> Chain<A> {
    /// The lift of the base in the frame of each link.
    fn lifts(&self, stances: &[Stance<f64>; A]) -> [[f64; 3]; A] {
        let mut lift = self.lift;
        from_fn(|i| {
            lift = stances[i].inwards(lift);
            lift
        })
    }
}
