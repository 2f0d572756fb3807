//! Loop of a simulated run: read the sensors, command the torques, watch, move on, sample by sample.

use frfid_signals::{GoOn, Run, SignalError};

use crate::control::changes::Changes;
use crate::control::sensor::Sensor;
use crate::control::watch::{Guard, Moment};
use crate::error::PlantError;
use crate::motion::trajectory::Trajectory;
use crate::motion::{Acting, Motion};
use crate::testbed::command::Command;
use crate::testbed::recorder::Recorder;
use crate::testbed::simulate::Clock;
use crate::testbed::simulated_robot::{Simulated, SimulatedRobot};

/// Samples after a run for which the robot is brought back to its steady motion and watched: the
/// answer to the last step of the reference, controller delays included.
const AFTER: usize = 16;

/// How many samples are done before it is asked again whether to go on.
const SAMPLES_BETWEEN: usize = 256;

/// All that goes on around a robot in motion during a run.
pub(crate) struct RunLoop<'a> {
    run: &'a Run,
    sensors: &'a [Sensor],
    command: Command,
    recorder: Recorder,
    guard: Guard<'a>,
    changes: Changes,
    truth: Trajectory,
}

impl<'a> RunLoop<'a> {
    /// The loop before the first sample of a run at whose start the robot is.
    pub(crate) fn new(robot: &'a SimulatedRobot, run: &'a Run, motion: &dyn Motion) -> Self {
        let (n_axes, n_samples) = run.reference.dim();
        let (holding, velocity) = (motion.holding_nm(), motion.motor_velocity_rad_s());
        Self {
            run,
            sensors: &robot.sensors,
            command: Command::holding(&robot.actuation, motion),
            recorder: Recorder::new(&robot.sensors, robot.seed, run, motion, AFTER),
            guard: Guard::new(robot.watch.as_ref(), run),
            changes: Changes::steady(run.sample_time_s, &holding, velocity),
            truth: Trajectory::zeros(run.sample_time_s, n_axes, n_samples + AFTER),
        }
    }

    /// Goes through the run and brings the robot back to its steady motion; returns the number of the
    /// run's samples, fewer than were asked for if it was stopped.
    ///
    /// # Errors
    /// Those of the motion; [`SignalError::Interrupted`] where `go_on` says so.
    pub(crate) fn advance(
        &mut self,
        motion: &mut dyn Motion,
        clock: Clock,
        go_on: GoOn,
    ) -> Result<usize, PlantError> {
        let n_samples = self.run.reference.ncols();
        for sample in 0..n_samples + AFTER {
            if sample % SAMPLES_BETWEEN == 0 && !go_on() {
                return Err(SignalError::Interrupted.into());
            }
            self.truth.set(sample, motion);
            let torque = self.acting_nm(sample, motion);
            self.look(sample, &torque, motion);
            let ends = self.guard.ends(sample);
            if sample + 1 == n_samples || (ends && sample < n_samples) {
                self.truth.set_stuck(motion);
            }
            if ends {
                return Ok(n_samples.min(sample + 1));
            }
            let next = self.next_nm(sample + 1);
            let acting = next
                .as_ref()
                .map_or(Acting::Held(&torque), |next| Acting::Line(&torque, next));
            motion.advance(clock.n_steps, clock.step_s(), acting)?;
        }
        Ok(n_samples)
    }

    /// Watches a sample from which on torques in N m act.
    fn look(&mut self, sample: usize, torque_nm: &[f64], motion: &dyn Motion) {
        self.changes.step(torque_nm, motion.motor_velocity_rad_s());
        let record = &mut self.recorder.record;
        let changes = &self.changes;
        let event = self.guard.look(Moment {
            record,
            sample,
            changes,
        });
        record.events.extend(event);
    }

    /// What came of the samples that were done, under controllers of these gains in N m s/rad.
    pub(crate) fn finish(self, n_samples: usize, gains: &[f64]) -> Simulated {
        let (mut record, mut truth) = (self.recorder.record, self.truth);
        truth.truncate(n_samples);
        record.truncate(n_samples);
        let last = n_samples.saturating_sub(1);
        record.events.extend(self.guard.stopped(last, gains));
        Simulated {
            record,
            truth,
            changes: self.changes.largest(),
        }
    }

    /// What is injected on an axis at a sample: rest after the last.
    fn reference(&self, axis: usize, sample: usize) -> f64 {
        let planned = self.run.reference.get([axis, sample]);
        let rest = || self.command.rest(self.run.velocity_rad_s[axis]);
        self.guard.share(sample) * planned.copied().unwrap_or_else(rest)
    }

    /// Reads the sensors of all axes and sets the torques in N m that act from a sample on.
    fn acting_nm(&mut self, sample: usize, motion: &dyn Motion) -> Vec<f64> {
        let (position, velocity) = (motion.motor_position_rad(), motion.motor_velocity_rad_s());
        let n_axes = self.sensors.len();
        let in_run = sample < self.run.reference.ncols();
        let on_axis = |axis: usize| {
            let reference = self.reference(axis, sample);
            self.recorder.reference(axis, sample, reference);
            let reading = self
                .recorder
                .motion(axis, sample, position[axis], velocity[axis]);
            let output = self.command.torque(axis, reference, reading);
            let acting_nm = self.sensors[axis].acting_torque(output.torque_nm);
            self.recorder
                .torque(axis, sample, acting_nm, output.reached.filter(|_| in_run));
            acting_nm
        };
        (0..n_axes).map(on_axis).collect()
    }

    /// The torques in N m at the next sample towards which those of this one run in a straight
    /// line; `None` if they are held.
    fn next_nm(&self, next_sample: usize) -> Option<Vec<f64>> {
        let on_axis = |(axis, sensor): (usize, &Sensor)| {
            let reference = self.reference(axis, next_sample);
            let torque_nm = self.command.ahead(axis, reference)?;
            Some(sensor.acting_torque(torque_nm))
        };
        self.sensors.iter().enumerate().map(on_axis).collect()
    }
}
