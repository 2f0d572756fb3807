//! The closed-loop testbed: the reference is the motor velocity, a sampled PI controller makes the torque.

use std::sync::Arc;

use frfid_signals::{Event, EventKind, Record, Run, SignalError, Testbed, TestbedError};

use crate::controller::{PiAxis, PiOutput};
use crate::recorder::{Recorder, check_run};
use crate::{Acting, Clock, PiController, PlantError, Robot, Sensor, Trajectory};

/// A robot under velocity control.
///
/// At t_k the controller reads the sensors and sets the torque that is held on `[t_k, t_k + T)` (later by its delay). The run
/// starts at its place with motors and links at the run's constant velocity v and the controller holding them: its integral
/// is F_c sgn(v) + F_v v and what the gears transmit. Reaching the torque limit is logged as an event, once until the torque
/// is below it again.
#[derive(Debug, Clone)]
pub struct ClosedLoop {
    /// The robot.
    pub robot: Arc<dyn Robot>,
    /// Its controller.
    pub controller: PiController,
    /// Sensors and torque resolution, one per axis.
    pub sensors: Vec<Sensor>,
    /// Longest step of the integrator in s; [`Robot::default_step_s`] if `None`.
    pub max_step_s: Option<f64>,
    /// Seed of the sensors' noise.
    pub seed: u64,
}

impl ClosedLoop {
    /// A robot with ideal sensors.
    #[must_use]
    pub fn new(robot: Arc<dyn Robot>, controller: PiController) -> Self {
        let sensors = vec![Sensor::default(); robot.n_axes()];
        Self { robot, controller, sensors, max_step_s: None, seed: 0 }
    }

    /// Does one run; returns the true motion beside what the sensors recorded.
    ///
    /// # Errors
    /// [`PlantError`]; a run with another sample time than the controller's is refused.
    pub fn simulate(&self, run: &Run) -> Result<(Record, Trajectory), PlantError> {
        let n_axes = self.robot.n_axes();
        self.controller.check(n_axes)?;
        check_run(n_axes, &self.sensors, run)?;
        if run.sample_time_s != self.controller.sample_time_s {
            let needed = "the controller's sample time";
            return Err(SignalError::Parameter { name: "sample_time_s", found: run.sample_time_s, needed }.into());
        }
        let clock = Clock::new(run.sample_time_s, self.max_step_s.unwrap_or_else(|| self.robot.default_step_s()))?;
        let mut motion = self.robot.start(&run.start_rad, &run.velocity_rad_s)?;
        let mut recorder = Recorder::new(&self.sensors, self.seed, run, &*motion);
        let holding = motion.holding_nm().into_iter().enumerate();
        let mut axes: Vec<PiAxis> = holding.map(|(axis, holding_nm)| self.controller.axis(axis, holding_nm)).collect();
        let n_samples = run.reference.ncols();
        let mut truth = Trajectory::zeros(run.sample_time_s, n_axes, n_samples);
        let mut torque = vec![0.0; n_axes];
        for sample in 0..n_samples {
            truth.set(sample, &*motion);
            for (axis, acting_nm) in torque.iter_mut().enumerate() {
                let at = [axis, sample];
                let (_, velocity) =
                    recorder.motion(axis, sample, truth.motor_position_rad[at], truth.motor_velocity_rad_s[at]);
                let output = axes[axis].step(run.reference[at] - velocity);
                recorder.record.events.extend(limit_event(output, axis, sample as f64 * run.sample_time_s));
                *acting_nm = self.sensors[axis].acting_torque(output.torque_nm);
                recorder.torque(axis, sample, *acting_nm);
            }
            if sample + 1 < n_samples {
                motion.advance(clock.n_steps, clock.step_s(), Acting::Held(&torque))?;
            }
        }
        truth.set_stuck(&*motion);
        Ok((recorder.record, truth))
    }
}

/// The event of a torque that has just reached its limit.
fn limit_event(output: PiOutput, channel: usize, time_s: f64) -> Option<Event> {
    let PiOutput { asked_nm: value, max_torque_nm: limit, limit_reached, .. } = output;
    limit_reached
        .then(|| Event { time_s, kind: EventKind::Limit { channel, quantity: "effort_nm".into(), value, limit } })
}

impl Testbed for ClosedLoop {
    fn n_inputs(&self) -> usize {
        self.robot.n_axes()
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        self.simulate(run).map(|(record, _)| record).map_err(|error| error.in_run(run.id))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SingleJoint;
    use frfid_signals::{RunId, RunKind};
    use ndarray::Array2;
    use std::f64::consts::TAU;

    fn controller() -> PiController {
        PiController {
            gain: vec![2000.0],
            integral_gain: vec![16000.0],
            sample_time_s: 1e-3,
            delay_samples: 0,
            max_torque_nm: None,
        }
    }

    fn run(velocity: f64, amplitude: f64) -> Run {
        let reference = |(_, n)| velocity + amplitude * (TAU * 3.0 * n as f64 * 1e-3).sin();
        Run {
            id: RunId { kind: RunKind::Excitation, realization: 0, experiment: 0, repetition: 0 },
            sample_time_s: 1e-3,
            reference: Array2::from_shape_fn((1, 1000), reference),
            velocity_rad_s: vec![velocity],
            start_rad: vec![0.0],
        }
    }

    #[test]
    fn a_constant_velocity_is_held_against_friction_from_the_first_sample() {
        let joint = SingleJoint { coulomb_nm: 50.0, viscous_nms_per_rad: 20.0, ..SingleJoint::default() };
        for velocity in [0.1, -0.1] {
            let record =
                ClosedLoop::new(Arc::new(joint.clone()), controller()).run(&run(velocity, 0.0)).expect("sound");
            assert!(record.y.iter().all(|y| (y - velocity).abs() < 1e-12));
            assert!(record.u.iter().all(|u| (u - 520.0 * velocity).abs() < 1e-9));
            assert_eq!(record.check(), Ok(()));
        }
    }

    #[test]
    fn the_recorded_torque_makes_the_recorded_motion() {
        let joint = SingleJoint { coulomb_nm: 50.0, ..SingleJoint::default() };
        let (record, truth) =
            ClosedLoop::new(Arc::new(joint.clone()), controller()).simulate(&run(0.0, 0.1)).expect("sound");
        let again = crate::simulate(&joint, crate::Torque::Zoh(record.u.view()), 1e-3, 0.0, None).expect("sound");
        assert_eq!(again, truth);
        assert!(truth.stuck_share[0] > 0.0 && truth.stuck_share[0] < 0.2, "{:?}", truth.stuck_share);
    }

    #[test]
    fn reaching_the_torque_limit_is_an_event_and_not_an_error() {
        let limited = PiController { max_torque_nm: Some(vec![100.0]), ..controller() };
        let record = ClosedLoop::new(Arc::new(SingleJoint::default()), limited).run(&run(0.0, 0.1)).expect("sound");
        assert!(record.u.iter().all(|u| u.abs() <= 100.0));
        // a sine of 3 Hz over 1 s meets the limit once per half-wave
        assert!((3..=12).contains(&record.events.len()), "{:?}", record.events);
        let EventKind::Limit { channel: 0, value, limit, .. } = &record.events[0].kind else { panic!("no limit") };
        assert!(value.abs() > *limit && *limit == 100.0);
    }

    #[test]
    fn an_unstable_loop_says_where_it_left_the_numbers() {
        let wild = PiController { gain: vec![1e9], ..controller() };
        let error = ClosedLoop::new(Arc::new(SingleJoint::default()), wild).run(&run(0.0, 0.1)).expect_err("unstable");
        assert!(matches!(error, TestbedError::Diverged { quantity: "motor velocity", channel: 0, .. }), "{error}");
    }

    #[test]
    fn runs_that_do_not_fit_are_refused() {
        let testbed = ClosedLoop::new(Arc::new(SingleJoint::default()), controller());
        let refused = |run: Run| testbed.run(&run).expect_err("does not fit").to_string();
        assert!(refused(Run { sample_time_s: 2e-3, ..run(0.0, 0.1) }).contains("controller's sample time"));
        assert!(refused(Run { velocity_rad_s: vec![], ..run(0.0, 0.1) }).starts_with("velocity_rad_s has shape [0]"));
        assert!(refused(Run { reference: Array2::zeros((2, 5)), ..run(0.0, 0.1) }).starts_with("reference has shape"));
        assert!(refused(Run { reference: Array2::from_elem((1, 5), f64::NAN), ..run(0.0, 0.1) }).contains("NaN"));
    }
}
