//! Machines side by side: those of a fleet, which move in lanes, or each alone where their torques are of
//! different kinds.

use std::any::Any;

use pulp::{Arch, Simd, WithSimd};

use crate::lanes::{LANES, Lanes};
use crate::motion::fleet::{Failed, Fleet};
use crate::motion::formula::FormulaSideBySide;
use crate::motion::in_lanes::InLanes;
use crate::motion::integrator::Integrator;
use crate::motion::links::LinksSideBySide;
use crate::motion::segment::Segment;
use crate::motion::{Acting, Motion};
use crate::scalar::Scalar;

/// Machines in motion, each with its own integrator.
#[derive(Debug)]
pub(crate) struct SideBySide<
    K: LinksSideBySide<A, N>,
    F: FormulaSideBySide<K, A, N>,
    const A: usize,
    const N: usize,
> {
    machines: Vec<Integrator<K, A, F>>,
    /// All of them in lanes; `None` until they move together.
    lanes: Option<Box<InLanes<K, F, A, N>>>,
    arch: Arch,
}

impl<K: LinksSideBySide<A, N>, F: FormulaSideBySide<K, A, N>, const A: usize, const N: usize>
    SideBySide<K, F, A, N>
{
    /// A machine that others may join.
    pub(crate) fn of(machine: Integrator<K, A, F>) -> Self {
        const { assert!(N <= LANES, "wider than any fleet may be") };
        Self {
            machines: vec![machine],
            lanes: None,
            arch: Arch::new(),
        }
    }

    /// Moves each machine on by itself.
    fn each_alone(
        &mut self,
        n_steps: usize,
        step_s: f64,
        acting: &[Option<Acting>],
    ) -> Vec<Failed> {
        self.lanes = None;
        let each = self.machines.iter_mut().zip(acting).enumerate();
        let failed = each.filter_map(|(robot, (machine, acting))| {
            let moved = machine.advance(n_steps, step_s, (*acting)?);
            Some((robot, moved.err()?))
        });
        failed.collect()
    }
}

impl<K: LinksSideBySide<A, N>, F: FormulaSideBySide<K, A, N>, const A: usize, const N: usize> Fleet
    for SideBySide<K, F, A, N>
{
    fn join(&mut self, motion: Box<dyn Motion>) -> Option<Box<dyn Motion>> {
        let machine: &dyn Any = &*motion;
        let machine = machine.downcast_ref::<Integrator<K, A, F>>();
        let first = self.machines[0].links();
        match machine.filter(|machine| machine.links().alike(first)) {
            Some(machine) if self.machines.len() < N => self.machines.push(machine.clone()),
            _ => return Some(motion),
        }
        self.lanes = None;
        None
    }

    fn n_robots(&self) -> usize {
        self.machines.len()
    }

    fn motion(&self, robot: usize) -> &dyn Motion {
        &self.machines[robot]
    }

    fn advance(&mut self, n_steps: usize, step_s: f64, acting: &[Option<Acting>]) -> Vec<Failed> {
        let several = acting.iter().flatten().count() >= F::FEWEST;
        let Some(torques) = Torques::of(acting).filter(|_| several) else {
            return self.each_alone(n_steps, step_s, acting);
        };
        let machines = &mut self.machines[..];
        let lanes = self
            .lanes
            .get_or_insert_with(|| Box::new(InLanes::of(machines)));
        let start = torques.segment(0, n_steps).at(0.0);
        for (lane, (machine, acting)) in machines.iter_mut().zip(acting).enumerate() {
            match acting {
                Some(_) => lanes.release(lane, machine, &start.map(|torque| torque.0[lane])),
                None => lanes.forget(lane),
            }
        }
        let mut failed = Vec::new();
        self.arch.dispatch(Steps {
            lanes,
            machines,
            torques: &torques,
            n_steps,
            step_s,
            failed: &mut failed,
        });
        for (lane, (machine, acting)) in machines.iter_mut().zip(acting).enumerate() {
            if acting.is_some() && failed.iter().all(|(of, _)| *of != lane) {
                lanes.tell(lane, machine);
                failed.extend(machine.check().err().map(|error| (lane, error)));
            }
        }
        failed
    }
}

/// Steps of machines in lanes.
struct Steps<
    'a,
    K: LinksSideBySide<A, N>,
    F: FormulaSideBySide<K, A, N>,
    const A: usize,
    const N: usize,
> {
    lanes: &'a mut InLanes<K, F, A, N>,
    machines: &'a mut [Integrator<K, A, F>],
    torques: &'a Torques<A, N>,
    n_steps: usize,
    step_s: f64,
    failed: &'a mut Vec<Failed>,
}

impl<K: LinksSideBySide<A, N>, F: FormulaSideBySide<K, A, N>, const A: usize, const N: usize>
    WithSimd for Steps<'_, K, F, A, N>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let segment = |step| self.torques.segment(step, self.n_steps);
        self.lanes.begin(&segment(0).at(0.0));
        for step in 0..self.n_steps {
            self.lanes
                .step(self.machines, &segment(step), self.step_s, self.failed);
        }
    }
}

/// Torques in N m of machines side by side from one sample to the next.
enum Torques<const A: usize, const N: usize> {
    Held([Lanes<N>; A]),
    Line([Lanes<N>; A], [Lanes<N>; A]),
}

impl<const A: usize, const N: usize> Torques<A, N> {
    /// Those that act, if all are held or all are lines; 0 where none acts.
    fn of(acting: &[Option<Acting>]) -> Option<Self> {
        let zero = [Lanes::splat(0.0); A];
        let (mut from, mut to, mut n_lines) = (zero, zero, 0);
        for (lane, acting) in acting.iter().enumerate() {
            match acting {
                None => {}
                Some(Acting::Held(torque)) => set(&mut from, lane, torque)?,
                Some(Acting::Line(start, end)) => {
                    n_lines += 1;
                    set(&mut from, lane, start)?;
                    set(&mut to, lane, end)?;
                }
                Some(Acting::Function(_)) => return None,
            }
        }
        let n_acting = acting.iter().flatten().count();
        match n_lines {
            0 => Some(Self::Held(from)),
            _ if n_lines == n_acting => Some(Self::Line(from, to)),
            _ => None,
        }
    }

    /// The torques within one of the steps.
    #[inline(always)]
    fn segment(&self, step: usize, n_steps: usize) -> Segment<A, Lanes<N>> {
        match self {
            Self::Held(torque) => Segment::constant(*torque),
            Self::Line(from, to) => Segment::line(from, to, step, n_steps),
        }
    }
}

/// Puts the torques of one machine into its lane; `None` if there are not as many as axes.
fn set<const A: usize, const N: usize>(
    lanes: &mut [Lanes<N>; A],
    lane: usize,
    torque: &[f64],
) -> Option<()> {
    let torque: &[f64; A] = torque.try_into().ok()?;
    for axis in 0..A {
        lanes[axis].0[lane] = torque[axis];
    }
    Some(())
}
