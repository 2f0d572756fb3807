//! Open-loop simulation: a motor torque in, the true motion out.

use std::array::from_fn;

use frfid_signals::{SignalError, check_finite};
use ndarray::ArrayView2;

use crate::dynamics::{Links, Machine};
use crate::{Motion, PlantError, Segment, SingleJoint, Trajectory};
use frfid_signals::range::{finite, positive};

/// A motor torque over time.
#[derive(Clone, Copy)]
pub enum Torque<'a> {
    /// Held between samples: `u[k]` in N m acts on `[t_k, t_k + sample_time_s)`; `(channel, sample)`.
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
pub struct Clock {
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
    pub fn new(sample_time_s: f64, max_step_s: f64) -> Result<Self, SignalError> {
        positive("sample_time_s", sample_time_s)?;
        positive("max_step_s", max_step_s)?;
        let n_steps = (sample_time_s / max_step_s - 1e-9).ceil().max(1.0);
        if n_steps > MAX_STEPS {
            let needed = "a step of at least a millionth of the sample time (a plant that needs less is too stiff)";
            return Err(SignalError::Parameter { name: "max_step_s", found: max_step_s, needed });
        }
        let n_steps = n_steps as usize;
        Ok(Self { sample_time_s, n_steps })
    }

    /// Length of a step in s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.sample_time_s / self.n_steps as f64
    }
}

/// Simulates a joint from position 0, motor and link moving at `velocity_rad_s`, under a motor torque, with steps of at
/// most `max_step_s` ([`SingleJoint::default_step_s`] if `None`). As many samples as the torque has; sample `k` is the
/// state at `t_k`, just before `u[k]` acts.
///
/// # Errors
/// [`PlantError::Signal`] for a parameter out of range or a torque that is not `(1, sample)` and finite,
/// [`PlantError::Diverged`], [`PlantError::Chatter`].
pub fn simulate(
    joint: &SingleJoint,
    torque: Torque,
    sample_time_s: f64,
    velocity_rad_s: f64,
    max_step_s: Option<f64>,
) -> Result<Trajectory, PlantError> {
    joint.check()?;
    finite("velocity_rad_s", velocity_rad_s)?;
    let clock = Clock::new(sample_time_s, max_step_s.unwrap_or_else(|| joint.default_step_s()))?;
    trajectory(&joint.machine(), torque, clock, [velocity_rad_s])
}

/// Simulates a machine of `A` axes from position 0, motors and links moving at `velocity_rad_s`.
///
/// # Errors
/// As [`simulate`], for a torque that is not `(A, sample)`.
pub fn trajectory<K: Links<A>, const A: usize>(
    machine: &Machine<K, A>,
    torque: Torque,
    clock: Clock,
    velocity_rad_s: [f64; A],
) -> Result<Trajectory, PlantError> {
    let n_samples = torque.n_samples(A)?;
    let mut motion = Motion::start(machine, velocity_rad_s);
    let mut trajectory = Trajectory::zeros(clock.sample_time_s, A, n_samples);
    for sample in 0..n_samples {
        trajectory.set(sample, motion.state());
        if sample + 1 < n_samples {
            torque.act(&mut motion, clock, sample)?;
        }
    }
    trajectory.set_stuck(motion.stuck_s(), motion.time_s());
    Ok(trajectory)
}

impl Torque<'_> {
    /// Number of samples, once the channels and the samples are found sound.
    fn n_samples(&self, n_axes: usize) -> Result<usize, SignalError> {
        let samples = match self {
            Self::Zoh(samples) | Self::Linear(samples) => samples,
            Self::Analytic { n_samples, .. } => return Ok(*n_samples),
        };
        if samples.nrows() != n_axes {
            let needed = format!("({n_axes}, sample)");
            return Err(SignalError::Shape { name: "torque", found: samples.shape().to_vec(), needed });
        }
        check_finite("torque", *samples)?;
        Ok(samples.ncols())
    }

    /// Moves the machine from one sample to the next.
    fn act<K: Links<A>, const A: usize>(
        &self,
        motion: &mut Motion<K, A>,
        clock: Clock,
        sample: usize,
    ) -> Result<(), PlantError> {
        let (n_steps, step_s) = (clock.n_steps, clock.step_s());
        match self {
            Self::Zoh(u) => {
                let segment = Segment::constant(from_fn(|axis| u[[axis, sample]]));
                motion.advance(n_steps, step_s, |_| segment)
            }
            Self::Linear(u) => motion.advance(n_steps, step_s, |step| {
                let at = |share: f64| {
                    let share = (step as f64 + share) / n_steps as f64;
                    from_fn(|axis| (1.0 - share) * u[[axis, sample]] + share * u[[axis, sample + 1]])
                };
                Segment::through(at(0.0), at(0.5), at(1.0))
            }),
            Self::Analytic { torque, .. } => motion.advance(n_steps, step_s, |step| {
                let start_s = sample as f64 * clock.sample_time_s + step as f64 * step_s;
                let at = |share: f64| from_fn(|axis| torque(start_s + share * step_s, axis));
                Segment::through(at(0.0), at(0.5), at(1.0))
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    use ndarray::{Array2, s};
    use num_complex::Complex64;

    use crate::{Hold, Velocity};

    const PERIOD: usize = 2000;

    /// Two periods of a multisine with lines up to 60 Hz at 1 ms, phases of Schroeder's kind.
    fn torque(lines: &[usize]) -> Array2<f64> {
        let sine =
            |n: usize, line: usize| (TAU * (n * line % PERIOD) as f64 / PERIOD as f64 + (line * line) as f64).sin();
        Array2::from_shape_fn((1, 2 * PERIOD), |(_, n)| lines.iter().map(|&line| sine(n, line)).sum())
    }

    /// DFT of the second period of channel 0 at one line.
    fn dft(x: &Array2<f64>, line: usize) -> Complex64 {
        let turn = |n: usize| Complex64::cis(-TAU * (n * line % PERIOD) as f64 / PERIOD as f64);
        x.slice(s![0, PERIOD..]).iter().enumerate().map(|(n, &value)| value * turn(n)).sum()
    }

    #[test]
    fn the_frf_of_a_steady_period_is_the_truth_under_either_hold() {
        let joint = SingleJoint { damping_nms_per_rad: 800.0, viscous_nms_per_rad: 3000.0, ..SingleJoint::default() };
        let lines: Vec<usize> = (2..120).step_by(3).collect();
        let u = torque(&lines);
        for hold in [Hold::Zoh, Hold::Linear] {
            let torque = if hold == Hold::Zoh { Torque::Zoh(u.view()) } else { Torque::Linear(u.view()) };
            let x = simulate(&joint, torque, 1e-3, 0.0, None).expect("sound");
            let q = &x.motor_position_rad;
            let differenced = Array2::from_shape_fn(u.dim(), |(_, n)| (q[[0, n]] - q[[0, n.saturating_sub(1)]]) / 1e-3);
            for (velocity, y) in [(Velocity::True, x.motor_velocity_rad_s), (Velocity::Differenced, differenced)] {
                for &line in &lines {
                    let hz = line as f64 / (PERIOD as f64 * 1e-3);
                    let truth = joint.frf(&[hz], hold, 1e-3, velocity).expect("sound").response[[0, 0, 0]];
                    let error = (dft(&y, line) / dft(&u, line) / truth - 1.0).norm();
                    assert!(error < 1e-9, "{hold:?}, {velocity:?}, {hz} Hz: {error}");
                }
            }
        }
    }
}
