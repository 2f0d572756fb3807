//! Simulated robot: a run goes in, a record comes out, in open loop (SK15 section 6.1) or under a
//! controller.

use std::sync::Arc;

use frfid_signals::{Record, Run, SignalError, Testbed, TestbedError};

use crate::control::controller::Controller;
use crate::control::sensor::Sensor;
use crate::control::watch::{Guard, Watch};
use crate::error::PlantError;
use crate::linear::state_space::Hold;
use crate::motion::trajectory::Trajectory;
use crate::motion::{Acting, Motion};
use crate::robot::Robot;
use crate::testbed::command::Command;
use crate::testbed::recorder::{Recorder, check_run};
use crate::testbed::simulate::Clock;

/// A robot in software with all that is around it: controller, sensors, and a watch over its
/// limits.
///
/// A run starts at its place with motors and links at its constant velocity v, held there: by F_c
/// sgn(v) + F_v v against friction and by what the gears transmit.
#[derive(Debug, Clone)]
pub struct SimulatedRobot {
    /// The robot.
    pub robot: Arc<dyn Robot>,
    /// What makes motor torques of a reference.
    pub actuation: Actuation,
    /// Sensors and torque resolution, one per axis.
    pub sensors: Vec<Sensor>,
    /// What stops a run before its end; `None` if nothing does.
    pub watch: Option<Watch>,
    /// Longest step of the integrator in s; [`Robot::default_step_s`] if `None`.
    pub max_step_s: Option<f64>,
    /// Seed of the sensors' noise.
    pub seed: u64,
}

/// What makes motor torques of a reference.
#[derive(Debug, Clone)]
pub enum Actuation {
    /// Open loop: the reference is the motor torque, on top of what holds the robot at the start of
    /// the run, rounded to the torque resolution.
    Torque {
        /// What the torque does between samples: [`Hold::Zoh`] or [`Hold::Linear`].
        hold: Hold,
    },
    /// Closed loop: the reference is the motor velocity. At t_k the controller reads the sensors and
    /// sets the torque that is held on `[t_k, t_k + T)` (later by its delay). Reaching a limit of
    /// the controller is logged as an event, once until the torque is free of it again, and does
    /// not stop the run; only a [`Watch`] does.
    Velocity {
        /// The controller.
        controller: Arc<dyn Controller>,
        /// Its sample time T in s; a run on another clock is refused.
        sample_time_s: f64,
    },
}

impl SimulatedRobot {
    /// A robot in open loop with ideal sensors, its torque held between samples, not watched.
    #[must_use]
    pub fn open_loop(robot: Arc<dyn Robot>) -> Self {
        Self::new(robot, Actuation::Torque { hold: Hold::Zoh })
    }

    /// A robot under a controller of this sample time in s with ideal sensors, not watched.
    #[must_use]
    pub fn closed_loop(
        robot: Arc<dyn Robot>,
        controller: Arc<dyn Controller>,
        sample_time_s: f64,
    ) -> Self {
        Self::new(
            robot,
            Actuation::Velocity {
                controller,
                sample_time_s,
            },
        )
    }

    fn new(robot: Arc<dyn Robot>, actuation: Actuation) -> Self {
        let sensors = vec![Sensor::default(); robot.n_axes()];
        Self {
            robot,
            actuation,
            sensors,
            watch: None,
            max_step_s: None,
            seed: 0,
        }
    }

    /// Does one run; returns the true motion beside what the sensors recorded.
    ///
    /// # Errors
    /// [`TestbedError`] for a run that does not fit, and one that leaves the numbers.
    pub fn simulate(&self, run: &Run) -> Result<(Record, Trajectory), TestbedError> {
        self.sampled(run)
            .map_err(|error| error.in_run(run.id, self.gain_nms_per_rad()))
    }

    /// Read the sensors, command the torque, watch, move on, sample by sample.
    fn sampled(&self, run: &Run) -> Result<(Record, Trajectory), PlantError> {
        self.check(run)?;
        let mut motion = self.robot.start(&run.start_rad, &run.velocity_rad_s)?;
        let max_step_s = self.max_step_s;
        let clock = Clock::new(
            run.sample_time_s,
            max_step_s.unwrap_or_else(|| self.robot.default_step_s()),
        )?;
        let mut command = Command::holding(&self.actuation, &*motion);
        let mut recorder = Recorder::new(&self.sensors, self.seed, run, &*motion);
        let mut guard = Guard::new(self.watch.as_ref(), run);
        let mut n_samples = run.reference.ncols();
        let mut truth = Trajectory::zeros(run.sample_time_s, self.robot.n_axes(), n_samples);
        let mut sample = 0;
        while sample < n_samples {
            truth.set(sample, &*motion);
            let reference = |axis| guard.share(sample) * run.reference[[axis, sample]];
            let torque = self.sample(&mut command, &mut recorder, sample, &*motion, reference);
            guard.look(&mut recorder.record, sample);
            sample += 1;
            if guard.ends(sample - 1) {
                n_samples = sample;
            } else if sample < n_samples {
                let reference = |axis| guard.share(sample) * run.reference[[axis, sample]];
                let next = self.next(&command, reference);
                let acting = next
                    .as_ref()
                    .map_or(Acting::Held(&torque), |next| Acting::Line(&torque, next));
                motion.advance(clock.n_steps, clock.step_s(), acting)?;
            }
        }
        truth.set_stuck(&*motion);
        let mut record = recorder.record;
        if n_samples < record.n_samples() {
            truth.truncate(n_samples);
            record.truncate(n_samples);
        }
        let last = n_samples.saturating_sub(1);
        let stopped = guard.stopped(last, self.gain_nms_per_rad());
        record.events.extend(stopped);
        Ok((record, truth))
    }

    fn check(&self, run: &Run) -> Result<(), PlantError> {
        let n_axes = self.robot.n_axes();
        match &self.actuation {
            Actuation::Torque {
                hold: Hold::Continuous,
            } => return Err(PlantError::NoHold),
            Actuation::Torque { .. } => {}
            Actuation::Velocity {
                controller,
                sample_time_s,
            } => {
                controller.check(n_axes, *sample_time_s)?;
                if run.sample_time_s != *sample_time_s {
                    let (key, found) = ("sample_time_s", run.sample_time_s);
                    let needed = "the controller's sample time";
                    return Err(SignalError::Parameter { key, found, needed }.into());
                }
            }
        }
        check_run(n_axes, &self.sensors, run)?;
        Ok(self
            .watch
            .as_ref()
            .map_or(Ok(()), |watch| watch.check(n_axes))?)
    }

    /// Reads the sensors of all axes and sets the torques in N m that act from a sample on, given
    /// the references.
    fn sample(
        &self,
        command: &mut Command,
        recorder: &mut Recorder,
        sample: usize,
        motion: &dyn Motion,
        reference: impl Fn(usize) -> f64,
    ) -> Vec<f64> {
        let (position, velocity) = (motion.motor_position_rad(), motion.motor_velocity_rad_s());
        let on_axis = |axis: usize| {
            let reference = reference(axis);
            recorder.reference(axis, sample, reference);
            let reading = recorder.motion(axis, sample, position[axis], velocity[axis]);
            let output = command.torque(axis, reference, reading);
            let acting_nm = self.sensors[axis].acting_torque(output.torque_nm);
            recorder.torque(axis, sample, acting_nm, output.reached);
            acting_nm
        };
        (0..self.sensors.len()).map(on_axis).collect()
    }

    /// The torques in N m at the next sample, given its references, towards which those of this one
    /// run in a straight line; `None` if they are held.
    fn next(&self, command: &Command, reference: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
        let on_axis = |(axis, sensor): (usize, &Sensor)| {
            let torque_nm = command.ahead(axis, reference(axis))?;
            Some(sensor.acting_torque(torque_nm))
        };
        self.sensors.iter().enumerate().map(on_axis).collect()
    }

    /// Gains in N m s/rad of the axes' controllers, to be named where a run fails; empty in open
    /// loop.
    fn gain_nms_per_rad(&self) -> &[f64] {
        match &self.actuation {
            Actuation::Torque { .. } => &[],
            Actuation::Velocity { controller, .. } => controller.gain_nms_per_rad(),
        }
    }
}

impl Testbed for SimulatedRobot {
    fn n_inputs(&self) -> usize {
        self.robot.n_axes()
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        Ok(self.simulate(run)?.0)
    }
}
