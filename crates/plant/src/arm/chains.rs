//! Chains of several arms side by side: their accelerations, a register at a time.

use std::array::from_fn;

use pulp::{Arch, Simd, WithSimd};

use crate::arm::chain::{Chain, Link};
use crate::arm::unrolled::unrolled;
use crate::lanes::Lanes;
use crate::motion::links::{Acceleration, LinksSideBySide};
use crate::register::Register;
use crate::scalar::Scalar;
use crate::sine::Angle as _;

/// Arms side by side: no more than a register holds, so that few of them cost less.
pub(crate) const ARMS: usize = 4;

/// Chains of as many links, one a lane.
#[derive(Debug)]
pub(crate) struct Chains<const A: usize, const N: usize> {
    chain: Chain<A, Lanes<N>>,
    arch: Arch,
}

impl<const A: usize, const N: usize> LinksSideBySide<A, N> for Chain<A> {
    type InLanes = Chains<A, N>;

    fn alike(&self, other: &Self) -> bool {
        self.biased == other.biased
    }

    fn in_lanes(each: [&Self; N]) -> Chains<A, N> {
        let chain = Chain {
            links: from_fn(|i| Link::in_lanes(each.map(|chain| &chain.links[i]))),
            lift: in_lanes(each.map(|chain| &chain.lift)),
            biased: each[0].biased,
        };
        let arch = Arch::new();
        Chains { chain, arch }
    }
}

impl<const A: usize, const N: usize> Acceleration<Lanes<N>, A> for Chains<A, N> {
    /// Not inlined: compiled once, not once for each place it is called from.
    #[inline(never)]
    fn acceleration(
        &self,
        position: &[Lanes<N>; A],
        velocity: &[Lanes<N>; A],
        torque: &[Lanes<N>; A],
    ) -> [Lanes<N>; A] {
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
    fn sin(&self, angle: Lanes<N>) -> Lanes<N> {
        self.arch.dispatch(Sine(angle))
    }
}

impl<const N: usize> Link<Lanes<N>> {
    fn in_lanes(each: [&Link; N]) -> Self {
        Self {
            zero_rad: Lanes::of(|lane| each[lane].zero_rad),
            twist: in_lanes(each.map(|link| &link.twist)),
            offset: in_lanes(each.map(|link| &link.offset)),
            first: in_lanes(each.map(|link| &link.first)),
            second: in_lanes(each.map(|link| &link.second)),
        }
    }
}

fn in_lanes<const K: usize, const N: usize>(each: [&[f64; K]; N]) -> [Lanes<N>; K] {
    from_fn(|k| Lanes::of(|lane| each[lane][k]))
}

/// Accelerations of all chains.
struct Accelerations<'a, const A: usize, const N: usize> {
    chain: &'a Chain<A, Lanes<N>>,
    position: &'a [Lanes<N>; A],
    velocity: &'a [Lanes<N>; A],
    torque: &'a [Lanes<N>; A],
    found: &'a mut [Lanes<N>; A],
}

impl<const A: usize, const N: usize> WithSimd for Accelerations<'_, A, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for index in 0..N / S::F64_LANES {
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
struct Sine<const N: usize>(Lanes<N>);

impl<const N: usize> WithSimd for Sine<N> {
    type Output = Lanes<N>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Lanes<N> {
        let Self(mut angle) = self;
        for index in 0..N / S::F64_LANES {
            let (sin, _) = Register::load(simd, &angle, index).sin_cos();
            sin.store(&mut angle, index);
        }
        angle
    }
}

impl<S: Simd, const A: usize> Chain<A, Register<S>> {
    /// The chains of a register.
    #[inline(always)]
    fn load<const N: usize>(simd: S, chain: &Chain<A, Lanes<N>>, index: usize) -> Self {
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
    fn load<const N: usize>(simd: S, link: &Link<Lanes<N>>, index: usize) -> Self {
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
fn load<S: Simd, const K: usize, const N: usize>(
    simd: S,
    lanes: &[Lanes<N>; K],
    index: usize,
) -> [Register<S>; K] {
    let mut registers = [Register::load(simd, &lanes[0], index); K];
    unrolled!(for i in 1..K {
        registers[i] = Register::load(simd, &lanes[i], index);
    });
    registers
}
