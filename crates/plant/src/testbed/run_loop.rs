//! How a run on a simulated robot goes, sample by sample: read the sensors, command the torque,
//! watch, move on.

use frfid_signals::{Record, Run};

use crate::control::sensor::Sensor;
use crate::control::watch::{Guard, Reached, Watch};
use crate::error::PlantError;
use crate::motion::trajectory::Trajectory;
use crate::motion::{Acting, Motion};
use crate::robot::Robot;
use crate::testbed::recorder::{Recorder, check_run};
use crate::testbed::simulate::Clock;

/// What makes motor torques of a reference.
pub(crate) trait Command {
    /// Motor torque in N m to act on an axis from this sample on, given the reference and the
    /// readings of position in rad and velocity in rad/s; and the limit that it has just reached.
    fn torque(
        &mut self,
        axis: usize,
        reference: f64,
        reading: (f64, f64),
    ) -> (f64, Option<Reached>);

    /// Motor torque in N m at the next sample, towards which it runs in a straight line; `None` if
    /// it is held until then.
    fn ahead(&self, _axis: usize, _next_reference: f64) -> Option<f64> {
        None
    }
}

/// A robot with all that is around it during a run.
pub(crate) struct Rig<'a> {
    /// The robot.
    pub robot: &'a dyn Robot,
    /// Sensors and torque resolution, one per axis.
    pub sensors: &'a [Sensor],
    /// What stops a run, if anything does.
    pub watch: Option<&'a Watch>,
    /// Longest step of the integrator in s; [`Robot::default_step_s`] if `None`.
    pub max_step_s: Option<f64>,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// Gains in N m s/rad of the axes' controllers, to be named when a run is stopped; empty in
    /// open loop.
    pub gains: &'a [f64],
}

impl Rig<'_> {
    /// Does one run; returns what the sensors recorded and the true motion.
    ///
    /// # Errors
    /// [`PlantError`].
    pub fn run<C: Command>(
        &self,
        run: &Run,
        command: impl FnOnce(&dyn Motion) -> C,
    ) -> Result<(Record, Trajectory), PlantError> {
        let n_axes = self.robot.n_axes();
        check_run(n_axes, self.sensors, run)?;
        self.watch.map_or(Ok(()), |watch| watch.check(n_axes))?;
        let mut motion = self.robot.start(&run.start_rad, &run.velocity_rad_s)?;
        let clock = Clock::new(
            run.sample_time_s,
            self.max_step_s
                .unwrap_or_else(|| self.robot.default_step_s()),
        )?;
        let mut command = command(&*motion);
        let mut recorder = Recorder::new(self.sensors, self.seed, run, &*motion);
        let mut guard = Guard::new(self.watch, run);
        let mut n_samples = run.reference.ncols();
        let mut truth = Trajectory::zeros(run.sample_time_s, n_axes, n_samples);
        let mut sample = 0;
        while sample < n_samples {
            truth.set(sample, &*motion);
            let reference = |axis, sample| guard.share(sample) * run.reference[[axis, sample]];
            let torque = self.sample(&mut command, &mut recorder, sample, &*motion, reference);
            guard.look(&mut recorder.record, sample);
            sample += 1;
            if guard.ends(sample - 1) {
                n_samples = sample;
            } else if sample < n_samples {
                let reference = |axis: usize| guard.share(sample) * run.reference[[axis, sample]];
                let ahead = |axis| Some(self.acting(axis, command.ahead(axis, reference(axis))?));
                let to: Option<Vec<f64>> = (0..n_axes).map(ahead).collect();
                let acting = to
                    .as_ref()
                    .map_or(Acting::Held(&torque), |to| Acting::Line(&torque, to));
                motion.advance(clock.n_steps, clock.step_s(), acting)?;
            }
        }
        truth.set_stuck(&*motion);
        let mut record = recorder.record;
        if n_samples < run.reference.ncols() {
            truth.truncate(n_samples);
            record.truncate(n_samples);
        }
        record
            .events
            .extend(guard.stopped(n_samples.saturating_sub(1), self.gains));
        Ok((record, truth))
    }

    /// Reads the sensors of all axes and sets the torques in N m that act from a sample on, given
    /// the references.
    fn sample(
        &self,
        command: &mut impl Command,
        recorder: &mut Recorder,
        sample: usize,
        motion: &dyn Motion,
        reference: impl Fn(usize, usize) -> f64,
    ) -> Vec<f64> {
        let (position, velocity) = (motion.motor_position_rad(), motion.motor_velocity_rad_s());
        let on_axis = |axis: usize| {
            let reference = reference(axis, sample);
            recorder.reference(axis, sample, reference);
            let reading = recorder.motion(axis, sample, position[axis], velocity[axis]);
            let (torque_nm, reached) = command.torque(axis, reference, reading);
            let acting_nm = self.acting(axis, torque_nm);
            recorder.torque(axis, sample, acting_nm, reached);
            acting_nm
        };
        (0..self.sensors.len()).map(on_axis).collect()
    }

    /// The torque in N m that acts on an axis when this one is commanded.
    fn acting(&self, axis: usize, command_nm: f64) -> f64 {
        self.sensors[axis].acting_torque(command_nm)
    }
}
