//! Simulated robot: a run goes in, a record comes out, in open loop (SK15 section 6.1) or under a
//! controller.

use std::sync::Arc;

use frfid_signals::{GoOn, Peaks, Record, Run, SignalError, Testbed, TestbedError};

use crate::control::controller::Controller;
use crate::control::sensor::Sensor;
use crate::control::watch::Watch;
use crate::error::PlantError;
use crate::lanes::LANES;
use crate::motion::trajectory::Trajectory;
use crate::robot::Robot;
use crate::state_space::Hold;
use crate::testbed::integration::Integration;
use crate::testbed::recorder::check_run;
use crate::testbed::run_loop::RunLoop;
use crate::testbed::runs::{Begun, go_through};
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
    /// How it is moved on from sample to sample.
    pub integration: Integration,
    /// Longest step of the integrator in s; if `None` [`Robot::default_step_s`] for RK4, and for
    /// exact steps a 32nd of the period of the robot's fastest motion, which is their longest.
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

/// What came of a simulated run.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// What the sensors recorded.
    pub record: Record,
    /// The true motion.
    pub truth: Trajectory,
    /// Largest torque rate, acceleration and jerk, from the steady motion before the run to the one
    /// after it.
    pub changes: Peaks,
}

impl SimulatedRobot {
    /// A robot in open loop with ideal sensors, its torque held between samples, not watched.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use frfid_plant::{SimulatedRobot, SingleJoint};
    /// use frfid_signals::{Run, RunId, Testbed};
    /// use ndarray::Array2;
    ///
    /// let mut joint = SingleJoint::default();
    /// joint.joint.friction.coulomb_nm = 50.0;
    /// let run = Run {
    ///     id: RunId::excitation(0, 0, 0),
    ///     sample_time_s: 1e-3,
    ///     reference: Array2::from_elem((1, 1000), 49.0), // N m
    ///     velocity_rad_s: vec![0.0],
    ///     start_rad: vec![0.0],
    /// };
    /// let record = SimulatedRobot::open_loop(Arc::new(joint)).run(&run)?;
    /// assert!(record.y.iter().all(|velocity| *velocity == 0.0)); // friction holds it
    /// # Ok::<(), frfid_signals::TestbedError>(())
    /// ```
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
            integration: Integration::default(),
            max_step_s: None,
            seed: 0,
        }
    }

    /// Does one run; returns the true motion and its largest changes beside what the sensors
    /// recorded.
    ///
    /// # Errors
    /// [`TestbedError`] for a run that does not fit, and one that diverges.
    pub fn simulate(&self, run: &Run) -> Result<Simulated, TestbedError> {
        self.simulate_while(run, &|| true)
    }

    /// The same as long as `go_on` says so.
    ///
    /// # Errors
    /// As [`SimulatedRobot::simulate`]; [`SignalError::Interrupted`] as [`TestbedError::Run`].
    pub fn simulate_while(&self, run: &Run, go_on: GoOn) -> Result<Simulated, TestbedError> {
        let mut simulated = self.simulate_each(std::slice::from_ref(run), go_on);
        simulated.remove(0)
    }

    /// Does runs side by side, which takes less time than one after the other, as long as `go_on`
    /// says so. Each comes out as it does alone, to the last digit.
    ///
    /// # Errors
    /// Of each run, as [`SimulatedRobot::simulate_while`].
    pub fn simulate_each(&self, runs: &[Run], go_on: GoOn) -> Vec<Result<Simulated, TestbedError>> {
        simulate_robots(runs.iter().map(|run| (self, run)), go_on)
    }

    /// A run at its beginning.
    fn begun<'a>(&'a self, run: &'a Run) -> Result<Begun<'a>, PlantError> {
        self.check(run)?;
        self.robot.check()?;
        let clock = Clock::new(run.sample_time_s, self.longest_step_s())?;
        let from = [&run.start_rad[..], &run.velocity_rad_s];
        let motion = self.integration.start(&*self.robot, clock.step_s(), from)?;
        Ok(Begun {
            clock,
            run_loop: RunLoop::new(self, run, &*motion),
            motion,
        })
    }

    fn longest_step_s(&self) -> f64 {
        self.integration
            .longest_step_s(&*self.robot, self.max_step_s)
    }

    fn check(&self, run: &Run) -> Result<(), PlantError> {
        let n_axes = self.robot.n_axes();
        self.check_actuation(run.sample_time_s)?;
        check_run(n_axes, &self.sensors, run)?;
        if let Some(watch) = &self.watch {
            watch.check(n_axes)?;
        }
        Ok(())
    }

    /// Checks the actuation for a run of this sample time in s.
    fn check_actuation(&self, found: f64) -> Result<(), PlantError> {
        match &self.actuation {
            Actuation::Torque {
                hold: Hold::Continuous,
            } => Err(PlantError::NoHold),
            Actuation::Torque { .. } => Ok(()),
            Actuation::Velocity {
                controller,
                sample_time_s,
            } => {
                controller.check(self.robot.n_axes(), *sample_time_s)?;
                if found == *sample_time_s {
                    return Ok(());
                }
                let needed = "the controller's sample time";
                Err(SignalError::parameter("sample_time_s", found, needed).into())
            }
        }
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

/// Does a run of each robot side by side, as [`SimulatedRobot::simulate_each`] does those of one: robots
/// that differ in their numbers, as the machines of a series do.
///
/// # Errors
/// Of each run, as [`SimulatedRobot::simulate_while`].
pub fn simulate_robots<'a>(
    runs: impl Iterator<Item = (&'a SimulatedRobot, &'a Run)> + Clone,
    go_on: GoOn,
) -> Vec<Result<Simulated, TestbedError>> {
    let begun = runs.clone().map(|(robot, run)| robot.begun(run));
    let named = runs
        .zip(go_through(begun, go_on))
        .map(|((robot, run), done)| {
            let gains = robot.gain_nms_per_rad();
            let (run_loop, n_samples) = done.map_err(|error| error.in_run(run.id, gains))?;
            Ok(run_loop.finish(n_samples, gains))
        });
    named.collect()
}

impl Testbed for SimulatedRobot {
    fn n_inputs(&self) -> usize {
        self.robot.n_axes()
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        Ok(self.simulate(run)?.record)
    }

    fn run_while(&self, run: &Run, go_on: GoOn) -> Result<Record, TestbedError> {
        Ok(self.simulate_while(run, go_on)?.record)
    }

    fn n_at_once(&self) -> usize {
        let rest = vec![0.0; self.robot.n_axes()];
        let (integration, step_s) = (self.integration, self.longest_step_s());
        let motion = integration.start(&*self.robot, step_s, [&rest, &rest]);
        let goes_side_by_side = motion.is_ok_and(|motion| motion.fleet().is_some());
        if goes_side_by_side { LANES } else { 1 }
    }

    fn run_each(&self, runs: &[Run], go_on: GoOn) -> Vec<Result<Record, TestbedError>> {
        let simulated = self.simulate_each(runs, go_on).into_iter();
        simulated.map(|run| Ok(run?.record)).collect()
    }
}
