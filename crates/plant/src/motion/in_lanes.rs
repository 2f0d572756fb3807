//! Machines in lanes: their equations, modes and states as numbers side by side, and their steps.

use std::array::from_fn;

use crate::lanes::Lanes;
use crate::motion::equations::{Equations, State};
use crate::motion::fleet::Failed;
use crate::motion::formula::FormulaSideBySide;
use crate::motion::integrator::Integrator;
use crate::motion::links::LinksSideBySide;
use crate::motion::modes::{Course, Modes};
use crate::motion::segment::Segment;
use crate::scalar::{Scalar, each};

/// Where machines are.
#[derive(Debug, Clone, Copy)]
struct Moment<const A: usize, const N: usize> {
    state: State<Lanes<N>, A>,
    derivative: State<Lanes<N>, A>,
    time_s: Lanes<N>,
    stuck_s: [Lanes<N>; A],
}

/// Equations, modes and motion of machines, one a lane; lanes beyond the last machine are at rest.
#[derive(Debug)]
pub(crate) struct InLanes<
    K: LinksSideBySide<A, N>,
    F: FormulaSideBySide<K, A, N>,
    const A: usize,
    const N: usize,
> {
    equations: Equations<Lanes<N>, K::InLanes, A>,
    formula: F::InLanes,
    modes: Modes<A, N>,
    now: Moment<A, N>,
    /// Whether any machine has a mode that can end.
    watched: bool,
}

impl<K: LinksSideBySide<A, N>, F: FormulaSideBySide<K, A, N>, const A: usize, const N: usize>
    InLanes<K, F, A, N>
{
    /// Of machines, one at least.
    pub(crate) fn of(machines: &[Integrator<K, A, F>]) -> Self {
        let each: [&Integrator<K, A, F>; N] =
            from_fn(|lane| machines.get(lane).unwrap_or(&machines[0]));
        let zero = Lanes::splat(0.0);
        let mut lanes = Self {
            equations: Equations::side_by_side(
                each.map(|machine| &machine.joints),
                each.map(|machine| &machine.equations),
            ),
            formula: F::in_lanes(each.map(|machine| &machine.formula)),
            modes: Modes::endless(),
            now: Moment {
                state: State::zero(),
                derivative: State::zero(),
                time_s: zero,
                stuck_s: [zero; A],
            },
            watched: machines.iter().any(|machine| machine.watched),
        };
        for (lane, machine) in machines.iter().enumerate() {
            lanes.now.set(lane, machine);
            lanes.enter(lane, machine);
        }
        lanes
    }

    /// Takes note of the modes of a machine.
    fn enter(&mut self, lane: usize, machine: &Integrator<K, A, F>) {
        self.modes.set(lane, &machine.joints, &machine.modes);
        F::set(&mut self.formula, lane, &machine.formula);
    }

    /// Prepares a machine for torques in N m that may have jumped.
    pub(crate) fn release(
        &mut self,
        lane: usize,
        machine: &mut Integrator<K, A, F>,
        torque: &[f64; A],
    ) {
        if machine.state.motor_velocity.contains(&0.0) {
            let before = machine.modes;
            machine.release(torque);
            if machine.modes != before {
                self.enter(lane, machine);
            }
        }
    }

    /// Lets a machine drift, of which nobody hears any more.
    pub(crate) fn forget(&mut self, lane: usize) {
        self.modes.keep(lane);
    }

    /// Tells a machine where it is.
    pub(crate) fn tell(&self, lane: usize, machine: &mut Integrator<K, A, F>) {
        machine.state = self.now.state.lane(lane);
        machine.time_s = self.now.time_s.0[lane];
        machine.stuck_s = self.now.stuck_s.map(|stuck| stuck.0[lane]);
    }

    /// Sets the derivatives before the first of several steps.
    #[inline(always)]
    pub(crate) fn begin(&mut self, torque: &[Lanes<N>; A]) {
        let (regimes, state) = (&self.modes.regimes, &self.now.state);
        self.now.derivative = self.equations.derivative(regimes, torque, state);
    }

    /// One step of `step_s` of all machines; one that cannot is put to the `failed`.
    #[inline(always)]
    pub(crate) fn step(
        &mut self,
        machines: &mut [Integrator<K, A, F>],
        torque: &Segment<A, Lanes<N>>,
        step_s: f64,
        failed: &mut Vec<Failed>,
    ) {
        let mut next = self.next(torque, step_s);
        if self.watched {
            let mut any = false;
            for axis in 0..A {
                let courses = self.courses(axis, torque, step_s, &next);
                for lane in 0..N {
                    any |= self.modes.may_end(axis, lane, &courses);
                }
            }
            if any {
                self.alone(machines, torque, step_s, &mut next, failed);
            }
        }
        self.now = next;
    }

    /// The end of a step in which no mode ends.
    #[inline(always)]
    fn next(&self, torque: &Segment<A, Lanes<N>>, step_s: f64) -> Moment<A, N> {
        let (now, regimes, step) = (&self.now, &self.modes.regimes, Lanes::splat(step_s));
        let (equations, from) = (&self.equations, [&now.state, &now.derivative]);
        let state = F::step(&self.formula, equations, regimes, torque, from, step);
        Moment {
            state,
            derivative: equations.derivative(regimes, &torque.at(1.0), &state),
            time_s: now.time_s + step,
            stuck_s: each(|axis| now.stuck_s[axis] + self.modes.stuck[axis] * step),
        }
    }

    /// What decides on the modes of an axis over a step: the velocity, which is 0 when stuck, and
    /// then the net torque; the deflection.
    #[inline(always)]
    fn courses(
        &self,
        axis: usize,
        torque: &Segment<A, Lanes<N>>,
        step_s: f64,
        next: &Moment<A, N>,
    ) -> [Course<N>; 2] {
        let step = Lanes::splat(step_s);
        let (before, after) = (&self.now.derivative, &next.derivative);
        let [mut slip, branch] = [
            Course {
                start: self.now.state.motor_velocity[axis],
                before: step * before.motor_velocity[axis],
                after: step * after.motor_velocity[axis],
                end: next.state.motor_velocity[axis],
            },
            Course {
                start: self.now.state.deflection[axis],
                before: step * before.deflection[axis],
                after: step * after.deflection[axis],
                end: next.state.deflection[axis],
            },
        ];
        if self.modes.any_stuck(axis) {
            let (start, end) = (torque.at(0.0)[axis], torque.at(1.0)[axis]);
            slip.start = slip.start + self.stuck_net(axis, start, &self.now.state);
            slip.end = slip.end + self.stuck_net(axis, end, &next.state);
            let (first, last) = (torque.slope(axis, 0.0), torque.slope(axis, 1.0));
            slip.before = slip.before + self.stuck_net_change(axis, first, step, before);
            slip.after = slip.after + self.stuck_net_change(axis, last, step, after);
        }
        [slip, branch]
    }

    /// Net torque in N m on the motors of an axis that are stuck, 0 on others.
    #[inline(always)]
    fn stuck_net(&self, axis: usize, torque: Lanes<N>, state: &State<Lanes<N>, A>) -> Lanes<N> {
        let regime = &self.modes.regimes[axis];
        self.modes.stuck[axis] * self.equations.net_torque(axis, regime, torque, state)
    }

    /// Its change per step in N m under a torque that changes by so much per step.
    #[inline(always)]
    fn stuck_net_change(
        &self,
        axis: usize,
        torque_change: Lanes<N>,
        step: Lanes<N>,
        derivative: &State<Lanes<N>, A>,
    ) -> Lanes<N> {
        let regime = &self.modes.regimes[axis];
        let rate = self
            .equations
            .net_torque_rate(axis, regime, torque_change / step, derivative);
        self.modes.stuck[axis] * (step * rate)
    }

    /// Takes the step with each machine's own integrator where a mode may end within it.
    #[cold]
    #[inline(never)]
    fn alone(
        &mut self,
        machines: &mut [Integrator<K, A, F>],
        torque: &Segment<A, Lanes<N>>,
        step_s: f64,
        next: &mut Moment<A, N>,
        failed: &mut Vec<Failed>,
    ) {
        let courses: [[Course<N>; 2]; A] = from_fn(|axis| self.courses(axis, torque, step_s, next));
        for (lane, machine) in machines.iter_mut().enumerate() {
            let ends = |axis: usize| self.modes.may_end(axis, lane, &courses[axis]);
            if !(0..A).any(ends) {
                continue;
            }
            self.tell(lane, machine);
            let derivative = self.now.derivative.lane(lane);
            match machine.step(&torque.lane(lane), step_s, derivative) {
                Ok(derivative) => {
                    next.set(lane, machine);
                    next.derivative.set(lane, &derivative);
                    self.enter(lane, machine);
                }
                Err(error) => {
                    failed.push((lane, error));
                    self.forget(lane);
                }
            }
        }
    }
}

impl<const A: usize, const N: usize> Moment<A, N> {
    /// Puts a machine into its lane.
    fn set<K, F>(&mut self, lane: usize, machine: &Integrator<K, A, F>) {
        self.state.set(lane, &machine.state);
        self.time_s.0[lane] = machine.time_s;
        for (stuck, of_machine) in self.stuck_s.iter_mut().zip(machine.stuck_s) {
            stuck.0[lane] = of_machine;
        }
    }
}

impl<const A: usize, const N: usize> State<Lanes<N>, A> {
    /// That of one machine.
    fn lane(&self, lane: usize) -> State<f64, A> {
        let of = |x: &[Lanes<N>; A]| x.map(|x| x.0[lane]);
        State {
            motor_position: of(&self.motor_position),
            deflection: of(&self.deflection),
            motor_velocity: of(&self.motor_velocity),
            link_velocity: of(&self.link_velocity),
        }
    }

    fn set(&mut self, lane: usize, machine: &State<f64, A>) {
        for axis in 0..A {
            self.motor_position[axis].0[lane] = machine.motor_position[axis];
            self.deflection[axis].0[lane] = machine.deflection[axis];
            self.motor_velocity[axis].0[lane] = machine.motor_velocity[axis];
            self.link_velocity[axis].0[lane] = machine.link_velocity[axis];
        }
    }
}
