//! Chains of several arms side by side: their accelerations, a register at a time.

use std::array::from_fn;

use pulp::{Arch, Simd, WithSimd};

use crate::arm::chain::{Chain, Link};
use crate::arm::unrolled::unrolled;
use crate::lanes::{LANES, Lanes};
use crate::motion::links::{Acceleration, LinksSideBySide};
use crate::register::Register;
use crate::scalar::Scalar;
use crate::sine::Angle as _;

/// Chains of as many links, one a lane.
#[derive(Debug)]
pub(crate) struct Chains<const A: usize> {
    chain: Chain<A, Lanes>,
    arch: Arch,
}

impl<const A: usize> LinksSideBySide<A> for Chain<A> {
    type InLanes = Chains<A>;

    fn alike(&self, other: &Self) -> bool {
        self.biased == other.biased
    }

    fn in_lanes(each: [&Self; LANES]) -> Chains<A> {
        let chain = Chain {
            links: from_fn(|i| Link::in_lanes(each.map(|chain| &chain.links[i]))),
            lift: in_lanes(each.map(|chain| &chain.lift)),
            biased: each[0].biased,
        };
        let arch = Arch::new();
        Chains { chain, arch }
    }
}

impl<const A: usize> Acceleration<Lanes, A> for Chains<A> {
    /// Not inlined: compiled once, not once for each place it is called from.
    #[inline(never)]
    fn acceleration(
        &self,
        position: &[Lanes; A],
        velocity: &[Lanes; A],
        torque: &[Lanes; A],
    ) -> [Lanes; A] {
        let mut found = [Lanes::splat(0.0); A];
        self.arch.dispatch(Accelerations {
            chain: &self.chain,
            position,
            velocity,
            torque,
            found: &mut found,
        });
        found
    }

    #[inline(never)]
    fn sin(&self, angle: Lanes) -> Lanes {
        self.arch.dispatch(Sine(angle))
    }
}

impl Link<Lanes> {
    fn in_lanes(each: [&Link; LANES]) -> Self {
        Self {
            zero_rad: Lanes::of(|lane| each[lane].zero_rad),
            twist: in_lanes(each.map(|link| &link.twist)),
            offset: in_lanes(each.map(|link| &link.offset)),
            first: in_lanes(each.map(|link| &link.first)),
            second: in_lanes(each.map(|link| &link.second)),
        }
    }
}

fn in_lanes<const N: usize>(each: [&[f64; N]; LANES]) -> [Lanes; N] {
    from_fn(|k| Lanes::of(|lane| each[lane][k]))
}

/// Accelerations of all chains.
struct Accelerations<'a, const A: usize> {
    chain: &'a Chain<A, Lanes>,
    position: &'a [Lanes; A],
    velocity: &'a [Lanes; A],
    torque: &'a [Lanes; A],
    found: &'a mut [Lanes; A],
}

impl<const A: usize> WithSimd for Accelerations<'_, A> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for index in 0..LANES / S::F64_LANES {
            let accelerations = Chain::load(simd, self.chain, index).accelerations(
                load(simd, self.position, index),
                load(simd, self.velocity, index),
                load(simd, self.torque, index),
            );
            unrolled!(for i in 0..A {
                accelerations[i].store(&mut self.found[i], index);
            });
        }
    }
}

/// Sines of a number of each arm.
struct Sine(Lanes);

impl WithSimd for Sine {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Lanes {
        let Self(mut angle) = self;
        for index in 0..LANES / S::F64_LANES {
            let (sin, _) = Register::load(simd, &angle, index).sin_cos();
            sin.store(&mut angle, index);
        }
        angle
    }
}

impl<S: Simd, const A: usize> Chain<A, Register<S>> {
    /// The chains of a register.
    #[inline(always)]
    fn load(simd: S, chain: &Chain<A, Lanes>, index: usize) -> Self {
        let mut links = [Link::load(simd, &chain.links[0], index); A];
        unrolled!(for i in 1..A {
            links[i] = Link::load(simd, &chain.links[i], index);
        });
        Self {
            links,
            lift: load(simd, &chain.lift, index),
            biased: chain.biased,
        }
    }
}

impl<S: Simd> Link<Register<S>> {
    /// The links of a register.
    #[inline(always)]
    fn load(simd: S, link: &Link<Lanes>, index: usize) -> Self {
        Self {
            zero_rad: Register::load(simd, &link.zero_rad, index),
            twist: load(simd, &link.twist, index),
            offset: load(simd, &link.offset, index),
            first: load(simd, &link.first, index),
            second: load(simd, &link.second, index),
        }
    }
}

/// Some numbers of a register.
#[inline(always)]
fn load<S: Simd, const N: usize>(simd: S, lanes: &[Lanes; N], index: usize) -> [Register<S>; N] {
    let mut registers = [Register::load(simd, &lanes[0], index); N];
    unrolled!(for i in 1..N {
        registers[i] = Register::load(simd, &lanes[i], index);
    });
    registers
}
