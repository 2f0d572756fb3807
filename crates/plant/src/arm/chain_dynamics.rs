//! Mass matrix, Coriolis and gravity torques of a chain, link by link.
//!
//! The mass matrix follows from what each joint carries as one rigid body (composite rigid bodies),
//! the torques at constant velocity from accelerations outwards and forces inwards (Newton, Euler):
//! Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5 and 6. A point x of a link at angular
//! velocity w accelerates by E x with E = [w'] + [w]^2 ([w] x = w cross x), so with the moments h =
//! integral x dm and S = integral x x^T dm its force is E h and its moment the axial vector of E S.

use std::array::from_fn;

use crate::arm::chain::{Chain, Link};
use crate::arm::composite::Composite;
use crate::arm::positive_definite::solve;
use crate::arm::stance::Stance;
use crate::arm::wrench::Wrench;
use crate::motion::links::{Acceleration, Links};
use crate::scalar::Scalar;

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

    /// Torques in N m at constant velocities: what each link's own motion takes, added up from the
    /// tip inwards.
    #[inline(always)]
    fn bias<L: Scalar>(&self, stances: &[Stance<L>; A], velocity: [L; A]) -> [L; A] {
        if !self.biased {
            return [L::splat(0.0); A];
        }
        let mut wrenches = self.own_wrenches(stances, velocity);
        for i in (1..A).rev() {
            wrenches[i - 1] = wrenches[i - 1].plus(stances[i].wrench(wrenches[i]));
        }
        wrenches.map(|wrench| wrench.moment[2])
    }

    /// What each link's own motion takes at constant velocities: its accelerations, from the base
    /// outwards, times its mass.
    #[inline(always)]
    fn own_wrenches<L: Scalar>(
        &self,
        stances: &[Stance<L>; A],
        velocity: [L; A],
    ) -> [Wrench<L>; A] {
        let zero = L::splat(0.0);
        let (mut w, mut dw, mut a) = ([zero; 3], [zero; 3], self.lift.map(L::splat));
        let mut e = [[zero; 3]; 3];
        let mut wrenches = [Wrench::zero(); A];
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
        wrenches
    }

    /// The lift of the base in the frame of each link.
    fn lifts(&self, stances: &[Stance<f64>; A]) -> [[f64; 3]; A] {
        let mut lift = self.lift;
        from_fn(|i| {
            lift = stances[i].inwards(lift);
            lift
        })
    }
}

impl<L: Scalar, const A: usize> Acceleration<L, A> for Chain<A> {
    /// Not inlined: it is long, is called from many places, and its call costs less than a
    /// hundredth of its time.
    #[inline(never)]
    fn acceleration(&self, position: [L; A], velocity: [L; A], torque: [L; A]) -> [L; A] {
        let stances = self.stances(position);
        let bias = self.bias(&stances, velocity);
        solve(&self.lower_mass(&stances), from_fn(|i| torque[i] - bias[i]))
    }
}

impl<const A: usize> Links<A> for Chain<A> {
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
