//! Mass matrix, Coriolis and gravity torques of a chain, link by link.
//!
//! The mass matrix follows from what each joint carries as one rigid body (composite rigid bodies),
//! the torques at constant velocity from accelerations outwards and forces inwards (Newton, Euler):
//! Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5 and 6. A point x of a link at angular
//! velocity w accelerates by E x with E = [w'] + [w]^2 ([w] x = w cross x), so with the moments h =
//! integral x dm and S = integral x x^T dm its force is E h and its moment the axial vector of E S.

use std::array::from_fn;

use crate::arm::chain::{Chain, Link};
use crate::arm::chains::ARMS;
use crate::arm::composite::Composite;
use crate::arm::positive_definite::solve;
use crate::arm::stance::Stance;
use crate::arm::unrolled::unrolled;
use crate::arm::wrench::{Wrench, add};
use crate::motion::fleet::Fleet;
use crate::motion::integrator::Integrator;
use crate::motion::links::{Acceleration, Links};
use crate::motion::side_by_side::SideBySide;
use crate::scalar::Number;
use crate::sine::Angle;

impl<L: Number> Link<L> {
    /// What it takes to accelerate the link's points by a, its mass being the base's.
    #[inline(always)]
    fn moved(&self, [ax, ay, az]: [L; 3]) -> Wrench<L> {
        let [hx, hy] = self.first;
        Wrench {
            force: [hx.like(0.0); 3],
            moment: [hy * az, -(hx * az), hx * ay - hy * ax],
        }
    }

    /// What it takes to accelerate the link's points x by E x.
    #[inline(always)]
    fn spun(&self, e: &[[L; 3]; 3]) -> Wrench<L> {
        let ([hx, hy], [xx, yy, xy, xz, yz]) = (self.first, self.second);
        let [[exx, exy, exz], [eyx, eyy, eyz], [ezx, ezy, ezz]] = *e;
        Wrench {
            force: [
                exx * hx + exy * hy,
                eyx * hx + eyy * hy,
                ezx * hx + ezy * hy,
            ],
            moment: [
                ezx * xy + ezy * yy + (ezz - eyy) * yz - eyx * xz,
                (exx - ezz) * xz + exy * yz - ezx * xx - ezy * xy,
                eyx * xx - exy * yy + (eyy - exx) * xy + eyz * xz - exz * yz,
            ],
        }
    }
}

/// E = [w'] + [w]^2.
#[inline(always)]
fn spin<L: Number>([x, y, z]: [L; 3], [dx, dy, dz]: [L; 3]) -> [[L; 3]; 3] {
    let (xx, yy, zz, xy, xz, yz) = (x * x, y * y, z * z, x * y, x * z, y * z);
    [
        [-(yy + zz), xy - dz, xz + dy],
        [xy + dz, -(xx + zz), yz - dx],
        [xz - dy, yz + dx, -(xx + yy)],
    ]
}

/// E x.
#[inline(always)]
fn product<L: Number>(e: &[[L; 3]; 3], [x, y, z]: [L; 3]) -> [L; 3] {
    let [p, q, r] = *e;
    [
        p[0] * x + p[1] * y + p[2] * z,
        q[0] * x + q[1] * y + q[2] * z,
        r[0] * x + r[1] * y + r[2] * z,
    ]
}

/// Without closures, which are not always inlined: see [`equations`](crate::motion::equations).
impl<L: Number, const A: usize> Chain<A, L> {
    #[inline(always)]
    fn stances(&self, position: [L; A]) -> [Stance<L>; A]
    where
        L: Angle,
    {
        let mut stances = [Stance::new(&self.links[0], position[0]); A];
        unrolled!(for i in 1..A {
            stances[i] = Stance::new(&self.links[i], position[i]);
        });
        stances
    }

    /// What each joint carries.
    #[inline(always)]
    fn composites(&self, stances: &[Stance<L>; A]) -> [Composite<L>; A] {
        let last = A - 1;
        let mut composites = [Composite::own(&self.links[last]); A];
        unrolled!(for i in (0..last).rev() {
            let carried = stances[i + 1].carried(composites[i + 1]);
            composites[i] = Composite::own(&self.links[i]).plus(carried);
        });
        composites
    }

    /// The lower triangle of the mass matrix in kg m^2.
    #[inline(always)]
    fn lower_mass(&self, stances: &[Stance<L>; A]) -> [[L; A]; A] {
        let composites = self.composites(stances);
        let mut mass = [[self.lift[0].like(0.0); A]; A];
        unrolled!(for j in 0..A {
            let mut wrench = composites[j].wrench();
            mass[j][j] = wrench.moment[2];
            unrolled!(for i in (0..j).rev() {
                wrench = stances[i + 1].wrench(wrench);
                mass[j][i] = wrench.moment[2];
            });
        });
        mass
    }

    /// Torques in N m at constant velocities: what each link's own motion takes, added up from the
    /// tip inwards.
    #[inline(always)]
    fn bias(&self, stances: &[Stance<L>; A], velocity: [L; A]) -> [L; A] {
        let mut torque = [self.lift[0].like(0.0); A];
        if self.biased {
            let (mut wrenches, last) = (self.own_wrenches(stances, velocity), A - 1);
            unrolled!(for i in (0..last).rev() {
                wrenches[i] = wrenches[i].plus(stances[i + 1].wrench(wrenches[i + 1]));
            });
            unrolled!(for i in 0..A {
                torque[i] = wrenches[i].moment[2];
            });
        }
        torque
    }

    /// What each link's own motion takes at constant velocities: its accelerations, from the base
    /// outwards, times its mass.
    #[inline(always)]
    fn own_wrenches(&self, stances: &[Stance<L>; A], velocity: [L; A]) -> [Wrench<L>; A] {
        let zero = self.lift[0].like(0.0);
        let mut a = stances[0].inwards(self.lift);
        // the first joint feels nothing of what its link takes to go on turning about it
        let mut wrenches = [self.links[0].moved(a); A];
        let (mut w, mut dw) = ([zero, zero, velocity[0]], [zero; 3]);
        let mut e = [[zero; 3]; 3];
        e[0][0] = -(velocity[0] * velocity[0]);
        e[1][1] = e[0][0];
        unrolled!(for i in 1..A {
            a = stances[i].inwards(add(a, product(&e, stances[i].offset)));
            (w, dw) = (stances[i].inwards(w), stances[i].inwards(dw));
            dw = [
                dw[0] + w[1] * velocity[i],
                dw[1] - w[0] * velocity[i],
                dw[2],
            ];
            w[2] = w[2] + velocity[i];
            e = spin(w, dw);
            wrenches[i] = self.links[i].moved(a).plus(self.links[i].spun(&e));
        });
        wrenches
    }

    /// Accelerations in rad/s^2 of the links under torques in N m: M^-1 (torque - C qo' - g).
    #[inline(always)]
    pub(crate) fn accelerations(&self, position: [L; A], velocity: [L; A], torque: [L; A]) -> [L; A]
    where
        L: Angle,
    {
        let stances = self.stances(position);
        let (bias, mut net) = (self.bias(&stances, velocity), torque);
        unrolled!(for i in 0..A {
            net[i] = torque[i] - bias[i];
        });
        solve(&self.lower_mass(&stances), net)
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

impl<const A: usize> Acceleration<f64, A> for Chain<A> {
    /// Not inlined: it is long, is called from many places, and its call costs less than a
    /// hundredth of its time.
    #[inline(never)]
    fn acceleration(
        &self,
        position: &[f64; A],
        velocity: &[f64; A],
        torque: &[f64; A],
    ) -> [f64; A] {
        self.accelerations(*position, *velocity, *torque)
    }

    #[inline(always)]
    fn sin(&self, angle: f64) -> f64 {
        Angle::sin_cos(angle).0
    }
}

impl<const A: usize> Links<A> for Chain<A> {
    fn fleet(machine: &Integrator<Self, A>) -> Option<Box<dyn Fleet>> {
        Some(Box::new(SideBySide::<_, _, A, ARMS>::of(machine.clone())))
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
