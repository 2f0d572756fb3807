//! Loop of a simulated run: read the sensors, command the torques, watch, sample by sample.

use frfid_signals::Run;

use crate::control::changes::Changes;
use crate::control::sensor::{AxisSample, Sensor};
use crate::control::watch::{Guard, Moment};
use crate::motion::{Acting, Motion};
use crate::testbed::command::Command;
use crate::testbed::recorder::Recorder;
use crate::testbed::simulated_robot::{Simulated, SimulatedRobot};

/// Samples after a run for which the robot is brought back to its steady motion and watched: the
/// answer to the last step of the reference, controller delays included.
const AFTER: usize = 16;

/// All that goes on around a robot in motion during a run.
pub(crate) struct RunLoop<'a> {
    run: &'a Run,
    sensors: &'a [Sensor],
    command: Command,
    recorder: Recorder,
    guard: Guard<'a>,
    changes: Changes,
    /// Every axis at the last sample.
    axes: Vec<AxisSample>,
    /// Torques in N m that act from the last sample on.
    torque_nm: Vec<f64>,
    /// Those at the next sample towards which they run in a straight line; empty if they are held.
    ahead_nm: Vec<f64>,
}

impl<'a> RunLoop<'a> {
    /// The loop before the first sample of a run at whose start the robot is.
    pub(crate) fn new(robot: &'a SimulatedRobot, run: &'a Run, motion: &dyn Motion) -> Self {
        let n_axes = run.reference.nrows();
        let (holding, velocity) = (motion.holding_nm(), motion.motor_velocity_rad_s());
        Self {
            run,
            sensors: &robot.sensors,
            command: Command::holding(&robot.actuation, motion),
            recorder: Recorder::new(&robot.sensors, robot.seed, run, motion),
            guard: Guard::new(robot.watch.as_ref(), run),
            changes: Changes::steady(run.sample_time_s, &holding, velocity),
            axes: vec![AxisSample::default(); n_axes],
            torque_nm: vec![0.0; n_axes],
            ahead_nm: Vec::with_capacity(n_axes),
        }
    }

    /// Takes a sample, the run's or one of those after it, which bring the robot back to its steady
    /// motion. Returns the number of the run's samples once it has ended, fewer than were asked for
    /// if it was stopped.
    pub(crate) fn sample(&mut self, sample: usize, motion: &dyn Motion) -> Option<usize> {
        let n_samples = self.run.reference.ncols();
        if sample == n_samples + AFTER {
            return Some(n_samples);
        }
        self.set_torques(sample, motion);
        if sample < n_samples {
            self.recorder.take(&self.axes, motion);
        }
        self.look(sample, motion);
        let ends = self.guard.ends(sample);
        if sample + 1 == n_samples || (ends && sample < n_samples) {
            self.recorder.take_stuck(motion);
        }
        if ends {
            return Some(n_samples.min(sample + 1));
        }
        self.look_ahead(sample + 1);
        None
    }

    /// What acts until the next sample.
    pub(crate) fn acting(&self) -> Acting<'_> {
        match &self.ahead_nm[..] {
            [] => Acting::Held(&self.torque_nm),
            ahead_nm => Acting::Line(&self.torque_nm, ahead_nm),
        }
    }

    /// Watches a sample.
    fn look(&mut self, sample: usize, motion: &dyn Motion) {
        let velocity = motion.motor_velocity_rad_s();
        self.changes.step(&self.torque_nm, velocity);
        let event = self.guard.look(Moment {
            sample,
            axes: &self.axes,
            changes: &self.changes,
        });
        self.recorder.events.extend(event);
    }

    /// What came of the samples that were done, under controllers of these gains in N m s/rad.
    pub(crate) fn finish(self, n_samples: usize, gains: &[f64]) -> Simulated {
        let (mut record, truth) = self.recorder.finish();
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
    fn set_torques(&mut self, sample: usize, motion: &dyn Motion) {
        let (position, velocity) = (motion.motor_position_rad(), motion.motor_velocity_rad_s());
        let in_run = sample < self.run.reference.ncols();
        for (axis, sensor) in self.sensors.iter().enumerate() {
            let reference = self.reference(axis, sample);
            let reader = &mut self.recorder.readers[axis];
            let reading = reader.motion(position[axis], velocity[axis]);
            let output = self.command.torque(axis, reference, reading);
            let acting_nm = sensor.acting_torque(output.torque_nm);
            self.axes[axis] = AxisSample {
                reference,
                position_rad: reading.0,
                velocity_rad_s: reading.1,
                torque_nm: reader.torque(acting_nm),
            };
            self.torque_nm[axis] = acting_nm;
            if let Some(reached) = output.reached.filter(|_| in_run) {
                let event = reached.event(axis, sample as f64 * self.run.sample_time_s);
                self.recorder.events.push(event);
            }
        }
    }

    /// Sets the torques at the next sample, unless those of this one are held until then.
    fn look_ahead(&mut self, next_sample: usize) {
        self.ahead_nm.clear();
        for (axis, sensor) in self.sensors.iter().enumerate() {
            let reference = self.reference(axis, next_sample);
            if let Some(torque_nm) = self.command.ahead(axis, reference) {
                self.ahead_nm.push(sensor.acting_torque(torque_nm));
            }
        }
    }
}
