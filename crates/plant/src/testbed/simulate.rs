//! Open-loop simulation: a motor torque in, the true motion out.

use frfid_signals::SignalError;
use frfid_signals::checks::{finite, positive, require};
use ndarray::ArrayView2;

use crate::error::PlantError;
use crate::motion::trajectory::Trajectory;
use crate::motion::{Acting, Motion};
use crate::robot::Robot;
use crate::testbed::recorder::check_channels;

/// A motor torque over time.
#[derive(Clone, Copy)]
pub enum Torque<'a> {
    /// Held between samples: `u[k]` in N m acts on `[t_k, t_k + sample_time_s)`;
    /// `(channel, sample)`.
    Zoh(ArrayView2<'a, f64>),
    /// A straight line from sample to sample, in N m; `(channel, sample)`.
    Linear(ArrayView2<'a, f64>),
    /// A smooth function of time in s and channel, in N m, simulated over `n_samples` samples.
    Analytic {
        /// The function.
        torque: &'a (dyn Fn(f64, usize) -> f64 + Sync),
        /// Number of samples of the trajectory.
        n_samples: usize,
    },
}

/// Most integrator steps per sample.
const MAX_STEPS: f64 = 1e6;

/// How finely time is cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clock {
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Steps of the integrator per sample.
    pub n_steps: usize,
}

impl Clock {
    /// The fewest whole steps per sample that are not longer than `max_step_s`.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] unless both times are finite and above 0.
    pub(crate) fn new(sample_time_s: f64, max_step_s: f64) -> Result<Self, SignalError> {
        positive("sample_time_s", sample_time_s)?;
        positive("max_step_s", max_step_s)?;
        let n_steps = (sample_time_s / max_step_s - 1e-9).ceil().max(1.0);
        let needed = "a step of at least a millionth of the sample time (a plant that needs less is too stiff)";
        require("max_step_s", max_step_s, n_steps <= MAX_STEPS, needed)?;
        let n_steps = n_steps as usize;
        Ok(Self {
            sample_time_s,
            n_steps,
        })
    }

    /// Length of a step in s.
    #[must_use]
    pub(crate) fn step_s(&self) -> f64 {
        self.sample_time_s / self.n_steps as f64
    }
}

/// Simulates a robot from its pose, motors and links moving at `velocity_rad_s` (the same for every
/// axis), under motor torques, with steps of at most `max_step_s` ([`Robot::default_step_s`] if
/// `None`). As many samples as the torque has; sample `k` is the state at `t_k`, just before `u[k]`
/// acts.
///
/// # Errors
/// [`PlantError::Signal`] for a parameter out of range or a torque that is not `(axis, sample)` and
/// finite, [`PlantError::Diverged`], [`PlantError::Chatter`].
pub fn simulate(
    robot: &dyn Robot,
    torque: Torque,
    sample_time_s: f64,
    velocity_rad_s: f64,
    max_step_s: Option<f64>,
) -> Result<Trajectory, PlantError> {
    finite("velocity_rad_s", velocity_rad_s)?;
    let mut motion = robot.start(
        &vec![0.0; robot.n_axes()],
        &vec![velocity_rad_s; robot.n_axes()],
    )?;
    let clock = Clock::new(
        sample_time_s,
        max_step_s.unwrap_or_else(|| robot.default_step_s()),
    )?;
    trajectory(&mut *motion, torque, clock)
}

/// Simulates a robot from where it is.
///
/// # Errors
/// As [`simulate`].
fn trajectory(
    motion: &mut dyn Motion,
    torque: Torque,
    clock: Clock,
) -> Result<Trajectory, PlantError> {
    let n_axes = motion.motor_position_rad().len();
    let n_samples = torque.n_samples(n_axes)?;
    let mut trajectory = Trajectory::zeros(clock.sample_time_s, n_axes, n_samples);
    for sample in 0..n_samples {
        trajectory.set(sample, motion);
        if sample + 1 < n_samples {
            torque.act(motion, clock, sample)?;
        }
    }
    trajectory.set_stuck(motion);
    Ok(trajectory)
}

impl Torque<'_> {
    /// Number of samples, once the channels and the samples are found sound.
    fn n_samples(&self, n_axes: usize) -> Result<usize, SignalError> {
        let samples = match self {
            Self::Zoh(samples) | Self::Linear(samples) => samples,
            Self::Analytic { n_samples, .. } => return Ok(*n_samples),
        };
        check_channels("torque", *samples, n_axes)?;
        Ok(samples.ncols())
    }

    /// Moves the robot from one sample to the next.
    fn act(&self, motion: &mut dyn Motion, clock: Clock, sample: usize) -> Result<(), PlantError> {
        let (n_steps, step_s) = (clock.n_steps, clock.step_s());
        let start_s = sample as f64 * clock.sample_time_s;
        match self {
            Self::Zoh(u) => {
                motion.advance(n_steps, step_s, Acting::Held(&u.column(sample).to_vec()))
            }
            Self::Linear(u) => {
                let [from, to] = [sample, sample + 1].map(|sample| u.column(sample).to_vec());
                motion.advance(n_steps, step_s, Acting::Line(&from, &to))
            }
            Self::Analytic { torque, .. } => motion.advance(
                n_steps,
                step_s,
                Acting::Function(&|time_s, axis| torque(start_s + time_s, axis)),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    use crate::control::sensor::Sensor;
    use crate::single_joint::SingleJoint;
    use crate::state_space::Hold;
    use ndarray::{Array2, s};
    use num_complex::Complex64;

    const PERIOD: usize = 2000;

    /// Two periods of a multisine with lines up to 60 Hz at 1 ms, phases of Schroeder's kind.
    fn torque(lines: &[usize]) -> Array2<f64> {
        let sine = |n: usize, line: usize| {
            (TAU * (n * line % PERIOD) as f64 / PERIOD as f64 + (line * line) as f64).sin()
        };
        Array2::from_shape_fn((1, 2 * PERIOD), |(_, n)| {
            lines.iter().map(|&line| sine(n, line)).sum()
        })
    }

    /// DFT of the second period of channel 0 at one line.
    fn dft(x: &Array2<f64>, line: usize) -> Complex64 {
        let turn = |n: usize| Complex64::cis(-TAU * (n * line % PERIOD) as f64 / PERIOD as f64);
        x.slice(s![0, PERIOD..])
            .iter()
            .enumerate()
            .map(|(n, &value)| value * turn(n))
            .sum()
    }

    #[test]
    fn the_frf_of_a_steady_period_is_the_truth_under_either_hold() {
        let mut joint = SingleJoint::default();
        joint.joint.damping_nms_per_rad = 800.0;
        joint.joint.friction.viscous_nms_per_rad = 3000.0;
        let lines: Vec<usize> = (2..120).step_by(3).collect();
        let u = torque(&lines);
        for hold in [Hold::Zoh, Hold::Linear] {
            let torque = if hold == Hold::Zoh {
                Torque::Zoh(u.view())
            } else {
                Torque::Linear(u.view())
            };
            let x = simulate(&joint, torque, 1e-3, 0.0, None).expect("sound");
            let q = &x.motor_position_rad;
            let differenced = Array2::from_shape_fn(u.dim(), |(_, n)| {
                (q[[0, n]] - q[[0, n.saturating_sub(1)]]) / 1e-3
            });
            for (differences, y) in [(false, x.motor_velocity_rad_s), (true, differenced)] {
                let sensors = [Sensor {
                    velocity_by_differencing: differences,
                    ..Sensor::default()
                }];
                for &line in &lines {
                    let hz = line as f64 / (PERIOD as f64 * 1e-3);
                    let truth = joint
                        .frf_through_sensors(&[hz], hold, 1e-3, &sensors)
                        .expect("sound")
                        .response[[0, 0, 0]];
                    let error = (dft(&y, line) / dft(&u, line) / truth - 1.0).norm();
                    assert!(
                        error < 1e-9,
                        "{hold:?}, differenced: {differences}, {hz} Hz: {error}"
                    );
                }
            }
        }
    }
}
