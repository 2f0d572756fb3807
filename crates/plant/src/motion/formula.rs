//! Step formula: how a state moves on within a mode, by Runge-Kutta here, exactly in a file of its own.

use std::fmt::Debug;

use crate::error::PlantError;
use crate::joint::flexible_joint::{Mode, Regime};
use crate::lanes::Lanes;
use crate::motion::equations::{Equations, State};
use crate::motion::event_location::{Bound, Trial};
use crate::motion::fleet::Fleet;
use crate::motion::integrator::Integrator;
use crate::motion::links::{Links, LinksSideBySide};
use crate::motion::segment::Segment;

/// How the state of a machine moves on within a mode.
pub(crate) trait Formula<K, const A: usize>: Clone + Debug + 'static {
    /// What a trial works out once, if at all.
    type Kept: Default;

    /// Takes note of the modes that follow.
    fn enter(&mut self, modes: &[Mode; A]);

    /// Checks the length of a step in s.
    ///
    /// # Errors
    /// [`PlantError::Signal`] for another one than the formula is for.
    fn check_step(&self, step_s: f64) -> Result<(), PlantError>;

    /// Checks that the torque may be any function of the time.
    ///
    /// # Errors
    /// [`PlantError::NotExact`].
    fn check_function() -> Result<(), PlantError>;

    /// The state at a share of a trial.
    fn state(trial: &Trial<K, A, Self>, theta: f64) -> State<f64, A>;

    /// Where in a trial, whose end state and its derivative are given, a signal first crosses a bound.
    fn exit(trial: &Trial<K, A, Self>, bound: Bound, end: [&State<f64, A>; 2]) -> Option<f64>;

    /// A fleet of a machine that moves so; `None` if it moves alone.
    fn fleet(machine: &Integrator<K, A, Self>) -> Option<Box<dyn Fleet>>;
}

/// A formula for machines side by side.
pub(crate) trait FormulaSideBySide<K: LinksSideBySide<A, N>, const A: usize, const N: usize>:
    Formula<K, A>
{
    /// What it knows of the present modes of several machines.
    type InLanes: Debug;

    /// Machines that move faster side by side than each alone: lanes that none of them fills cost as much.
    const FEWEST: usize;

    /// That of a machine for each lane.
    fn in_lanes(each: [&Self; N]) -> Self::InLanes;

    /// Takes note of the modes of one machine.
    fn set(in_lanes: &mut Self::InLanes, lane: usize, formula: &Self);

    /// The states of all machines after a step of `step` s in which no mode ends, from a state and
    /// its derivative.
    fn step(
        in_lanes: &Self::InLanes,
        equations: &Equations<Lanes<N>, K::InLanes, A>,
        regimes: &[Regime<Lanes<N>>; A],
        torque: &Segment<A, Lanes<N>>,
        from: [&State<Lanes<N>, A>; 2],
        step: Lanes<N>,
    ) -> State<Lanes<N>, A>;
}

/// The classical Runge-Kutta formula of fourth order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RungeKutta;

impl<K: Links<A>, const A: usize> Formula<K, A> for RungeKutta {
    type Kept = ();

    #[inline(always)]
    fn enter(&mut self, _modes: &[Mode; A]) {}

    #[inline(always)]
    fn check_step(&self, _step_s: f64) -> Result<(), PlantError> {
        Ok(())
    }

    #[inline(always)]
    fn check_function() -> Result<(), PlantError> {
        Ok(())
    }

    #[inline(always)]
    fn state(trial: &Trial<K, A, Self>, theta: f64) -> State<f64, A> {
        let torques = [
            &trial.torque.at(trial.share(0.5 * theta)),
            &trial.torque.at(trial.share(theta)),
        ];
        let motion = trial.motion;
        motion.equations.rk4(
            &motion.regimes,
            torques,
            &motion.state,
            trial.derivative,
            theta * trial.duration_s(),
        )
    }

    #[inline(always)]
    fn exit(trial: &Trial<K, A, Self>, bound: Bound, end: [&State<f64, A>; 2]) -> Option<f64> {
        trial.exit(bound, end)
    }

    fn fleet(machine: &Integrator<K, A, Self>) -> Option<Box<dyn Fleet>> {
        K::fleet(machine)
    }
}

impl<K: LinksSideBySide<A, N>, const A: usize, const N: usize> FormulaSideBySide<K, A, N>
    for RungeKutta
{
    type InLanes = ();

    const FEWEST: usize = 2;

    fn in_lanes(_each: [&Self; N]) {}

    #[inline(always)]
    fn set(_in_lanes: &mut (), _lane: usize, _formula: &Self) {}

    #[inline(always)]
    fn step(
        _in_lanes: &(),
        equations: &Equations<Lanes<N>, K::InLanes, A>,
        regimes: &[Regime<Lanes<N>>; A],
        torque: &Segment<A, Lanes<N>>,
        [state, derivative]: [&State<Lanes<N>, A>; 2],
        step: Lanes<N>,
    ) -> State<Lanes<N>, A> {
        let torques = [&torque.at(0.5), &torque.at(1.0)];
        equations.rk4(regimes, torques, state, derivative, step)
    }
}
