//! Integrator through the modes of friction and spring: steps, of RK4 or exact, that end where a mode ends.
//!
//! Within a mode the right-hand side is smooth, so RK4 keeps its order when no step reaches across
//! a change of mode. A stuck motor has no mobility: its velocity is exactly 0 until the net torque
//! exceeds F_c.

use std::array::from_fn;

use crate::error::PlantError;
use crate::joint::flexible_joint::{FlexibleJoint, Mode, Regime};
use crate::joint::friction::Slip;
use crate::motion::equations::{Equations, Machine, State};
use crate::motion::event_location::{ModeChange, Signal, Trial};
use crate::motion::formula::{Formula, RungeKutta};
use crate::motion::links::Links;
use crate::motion::segment::Segment;

/// Mode changes allowed per axis within one step.
const CHANGES_PER_AXIS: usize = 64;

/// A machine in motion.
#[derive(Debug, Clone)]
pub(crate) struct Integrator<K, const A: usize, F = RungeKutta> {
    pub(crate) joints: [FlexibleJoint; A],
    pub(crate) equations: Equations<f64, K, A>,
    pub(crate) formula: F,
    pub(crate) state: State<f64, A>,
    pub(crate) modes: [Mode; A],
    pub(crate) regimes: [Regime<f64>; A],
    /// Time in s since the start.
    pub(crate) time_s: f64,
    pub(crate) stuck_s: [f64; A],
    /// Whether any axis has a mode that can end.
    pub(crate) watched: bool,
}

impl<K: Links<A>, const A: usize> Integrator<K, A> {
    /// Starts with the links at positions in rad and motors and links at velocities in rad/s, the
    /// gears deflected by the torques that hold the links there; moves by RK4.
    pub(crate) fn start(
        machine: Machine<K, A>,
        position_rad: [f64; A],
        velocity_rad_s: [f64; A],
    ) -> Self {
        Self::start_by(RungeKutta, machine, position_rad, velocity_rad_s)
    }
}

impl<K: Links<A>, F: Formula<K, A>, const A: usize> Integrator<K, A, F> {
    /// [`Integrator::start`], to move by a formula.
    pub(crate) fn start_by(
        mut formula: F,
        machine: Machine<K, A>,
        position_rad: [f64; A],
        velocity_rad_s: [f64; A],
    ) -> Self {
        let state = held_state(&machine, position_rad, velocity_rad_s);
        let modes = from_fn(|axis| {
            let joint = &machine.joints[axis];
            Mode {
                slip: joint.friction.slip(velocity_rad_s[axis]),
                branch: joint.spring.branch(state.deflection[axis]),
            }
        });
        let regimes = from_fn(|axis| machine.joints[axis].regime(modes[axis]));
        let watched = machine
            .joints
            .iter()
            .any(|joint| joint.friction.coulomb_nm > 0.0 || !joint.spring.is_linear());
        formula.enter(&modes);
        Self {
            formula,
            equations: Equations::of(&machine.joints, machine.links),
            joints: machine.joints,
            state,
            modes,
            regimes,
            time_s: 0.0,
            stuck_s: [0.0; A],
            watched,
        }
    }

    /// What the gears drive.
    pub(crate) fn links(&self) -> &K {
        &self.equations.links
    }

    /// The present state.
    #[must_use]
    pub(crate) fn state(&self) -> &State<f64, A> {
        &self.state
    }

    /// Time in s since the start.
    pub(crate) fn time(&self) -> f64 {
        self.time_s
    }

    /// Time in s that each motor has spent stuck.
    pub(crate) fn stuck(&self) -> &[f64; A] {
        &self.stuck_s
    }

    /// Motor torque in N m that holds the present velocity of an axis against friction and against
    /// what the gear transmits.
    pub(crate) fn axis_holding_nm(&self, axis: usize) -> f64 {
        let friction = self.joints[axis]
            .friction
            .holding_nm(self.state.motor_velocity[axis]);
        friction
            + self
                .equations
                .transmitted(axis, &self.regimes[axis], &self.state)
    }

    /// Moves on by `n_steps` steps of `step_s` under the torque of each, which may jump before the
    /// first but not between.
    ///
    /// # Errors
    /// [`PlantError::Diverged`] if the state is no longer finite, [`PlantError::Chatter`].
    pub(crate) fn steps(
        &mut self,
        n_steps: usize,
        step_s: f64,
        torque: impl Fn(usize) -> Segment<A>,
    ) -> Result<(), PlantError> {
        let start = torque(0).at(0.0);
        self.release(&start);
        let mut derivative = self
            .equations
            .derivative(&self.regimes, &start, &self.state);
        for step in 0..n_steps {
            derivative = self.step(&torque(step), step_s, derivative)?;
        }
        self.check()
    }

    /// Decides again for motors at rest, whose torque may have jumped.
    pub(crate) fn release(&mut self, torque: &[f64; A]) {
        for axis in 0..A {
            if self.state.motor_velocity[axis] == 0.0 {
                self.enter(
                    axis,
                    Mode {
                        slip: self.at_rest(axis, torque),
                        ..self.modes[axis]
                    },
                );
            }
        }
    }

    /// The branch of friction of a motor at rest.
    fn at_rest(&self, axis: usize, torque: &[f64; A]) -> Slip {
        let net = self
            .equations
            .net_torque(axis, &self.regimes[axis], torque[axis], &self.state);
        self.joints[axis].friction.at_rest(net)
    }

    fn enter(&mut self, axis: usize, mode: Mode) {
        self.modes[axis] = mode;
        self.regimes[axis] = self.joints[axis].regime(mode);
        self.formula.enter(&self.modes);
    }

    /// One step, in as many pieces as modes end within it; takes and returns the derivative at its
    /// ends.
    pub(crate) fn step(
        &mut self,
        torque: &Segment<A>,
        step_s: f64,
        mut derivative: State<f64, A>,
    ) -> Result<State<f64, A>, PlantError> {
        let mut from = 0.0;
        for _ in 0..CHANGES_PER_AXIS * A {
            let trial = Trial {
                motion: self,
                torque,
                from,
                step_s,
                derivative: &derivative,
                kept: F::Kept::default(),
            };
            let end = trial.state(1.0);
            let end_derivative = trial.derivative(1.0, &end);
            let may_end = self.watched.then_some(&trial);
            let exit = may_end.and_then(|trial| trial.first_exit(&end, &end_derivative));
            let (theta, state) =
                exit.map_or((1.0, end), |exit| (exit.theta, trial.state(exit.theta)));
            let (duration_s, share) = (theta * trial.duration_s(), trial.share(theta));
            self.accept(state, duration_s);
            let Some(exit) = exit else {
                return Ok(end_derivative);
            };
            from = share;
            let torque = torque.at(from);
            self.change(exit, &torque);
            derivative = self
                .equations
                .derivative(&self.regimes, &torque, &self.state);
        }
        Err(PlantError::Chatter {
            limit: CHANGES_PER_AXIS * A,
            time_s: self.time_s,
        })
    }

    fn accept(&mut self, state: State<f64, A>, duration_s: f64) {
        self.state = state;
        self.time_s += duration_s;
        for axis in 0..A {
            if self.modes[axis].slip == Slip::Stuck {
                self.stuck_s[axis] += duration_s;
            }
        }
    }

    /// Takes an axis into the mode that follows.
    fn change(
        &mut self,
        ModeChange {
            axis,
            signal,
            upwards,
            ..
        }: ModeChange,
        torque: &[f64; A],
    ) {
        let mut mode = self.modes[axis];
        match signal {
            Signal::Velocity => mode.slip = self.come_to_rest(axis, torque),
            Signal::NetTorque if upwards => mode.slip = Slip::Forward,
            Signal::NetTorque => mode.slip = Slip::Backward,
            Signal::Deflection => mode.branch = mode.branch.next(upwards),
        }
        self.enter(axis, mode);
    }

    /// Stops a motor whose velocity has come to 0; returns the branch of friction that follows.
    fn come_to_rest(&mut self, axis: usize, torque: &[f64; A]) -> Slip {
        self.state.motor_velocity[axis] = 0.0; // it is, but for rounding
        let slip = self.at_rest(axis, torque);
        // what drove it on does so no longer, whatever the rounding of a torque near F_c says
        if slip == self.modes[axis].slip {
            Slip::Stuck
        } else {
            slip
        }
    }

    /// Checks that the machine is somewhere.
    ///
    /// # Errors
    /// [`PlantError::Diverged`] if the state is no longer finite.
    pub(crate) fn check(&self) -> Result<(), PlantError> {
        let x = &self.state;
        let quantities = [
            ("motor velocity", &x.motor_velocity),
            ("link velocity", &x.link_velocity),
            ("deflection", &x.deflection),
        ];
        for (quantity, values) in quantities {
            if let Some(channel) = values.iter().position(|value| !value.is_finite()) {
                return Err(PlantError::Diverged {
                    quantity,
                    channel,
                    time_s: self.time_s,
                });
            }
        }
        Ok(())
    }
}

/// Links at positions in rad, motors and links at velocities in rad/s, the gears deflected by the
/// torques that hold the links there.
fn held_state<K: Links<A>, const A: usize>(
    machine: &Machine<K, A>,
    position_rad: [f64; A],
    velocity_rad_s: [f64; A],
) -> State<f64, A> {
    let transmitted = machine.links.holding(position_rad, velocity_rad_s);
    let spring = |axis: usize| &machine.joints[axis].spring;
    let deflection: [f64; A] = from_fn(|axis| spring(axis).deflection_rad(transmitted[axis]));
    State {
        motor_position: from_fn(|axis| position_rad[axis] + deflection[axis]),
        deflection,
        motor_velocity: velocity_rad_s,
        link_velocity: velocity_rad_s,
    }
}
