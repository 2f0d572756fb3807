//! Poles of the linear closed loop from sample to sample: whether it is stable, and which axis drives
//! the motion if it is not.

use std::f64::consts::TAU;

use frfid_signals::SignalError;
use frfid_signals::checks::of_axes;
use nalgebra::{DMatrix, DVector, Schur, linalg::balancing::balance_parlett_reinsch};
use num_complex::Complex64;

use crate::control::controller::{Controller, LinearController};
use crate::control::sensor::Sensor;
use crate::error::PlantError;
use crate::robot::Robot;
use crate::state_space::{Hold, StateSpace};

/// A pole counts as on the unit circle within this distance: it needs a million samples to grow by
/// a factor e. Velocity control leaves positions free, which is a pole at 1 for each axis without a
/// position loop.
const TOLERANCE: f64 = 1e-6;

/// Relative precisions of the Schur decomposition, the first that can be reached is taken; all far
/// below [`TOLERANCE`].
const PRECISIONS: [f64; 3] = [f64::EPSILON, 1e-14, 1e-12];

/// Most iterations per eigenvalue of the Schur decomposition; a handful is usual.
const ITERATIONS_PER_POLE: usize = 1000;

/// Largest entry of a matrix whose squares the balancing can still add up.
const LARGEST_ENTRY: f64 = 1e100;

/// The poles in the z-plane of the loop of robot, controller and sensors without limits,
/// quantisation, Coulomb friction and ripple, largest first. The loop is stable if none lies
/// outside the unit circle; position control aside, one at 1 for each axis says that velocity
/// control leaves its position free. Poles at 0 are delays.
///
/// They are the eigenvalues of the matrix that takes the states of the robot behind its zero-order
/// hold, and the memories of sensors and controller, from sample to sample. The controller's sample
/// time is given in s.
///
/// # Errors
/// [`SignalError`] for a parameter out of range or a number of axes that does not fit.
pub fn loop_poles(
    robot: &dyn Robot,
    controller: &dyn Controller,
    sample_time_s: f64,
    sensors: &[Sensor],
) -> Result<Vec<Complex64>, SignalError> {
    let matrix = LinearLoop::new(robot, controller, sample_time_s, sensors)?.matrix();
    let needed = "a sample time over which this robot under these gains stays in numbers";
    let refused = SignalError::parameter("sample_time_s", sample_time_s, needed);
    let mut poles = eigenvalues(matrix).ok_or(refused)?;
    poles.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    Ok(poles)
}

/// Eigenvalues of a real matrix; `None` if its entries are not finite or absurdly large.
fn eigenvalues(mut matrix: DMatrix<f64>) -> Option<Vec<Complex64>> {
    if matrix
        .iter()
        .any(|entry| entry.is_nan() || entry.abs() > LARGEST_ENTRY)
    {
        return None;
    }
    balance_parlett_reinsch(&mut matrix); // states in rad and in N m are orders of magnitude apart
    let iterations = ITERATIONS_PER_POLE * matrix.nrows();
    // an entry beneath the diagonal must vanish beside its neighbours, which the rounding of larger
    // ones may not allow
    let schur = PRECISIONS
        .into_iter()
        .find_map(|precision| Schur::try_new(matrix.clone(), precision, iterations))?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

/// Checks that the linear loop is stable.
///
/// # Errors
/// [`PlantError::Unstable`] with the fastest growing motion and the axis whose controller feeds it
/// most; [`PlantError::Signal`] as [`loop_poles`].
pub fn check_stability(
    robot: &dyn Robot,
    controller: &dyn Controller,
    sample_time_s: f64,
    sensors: &[Sensor],
) -> Result<(), PlantError> {
    let worst = loop_poles(robot, controller, sample_time_s, sensors)?
        .first()
        .copied()
        .unwrap_or_default(); // largest first
    if worst.norm() <= 1.0 + TOLERANCE {
        return Ok(());
    }
    let channel = LinearLoop::new(robot, controller, sample_time_s, sensors)?.loudest_axis(worst);
    Err(PlantError::Unstable {
        spectral_radius: worst.norm(),
        hz: worst.arg().abs() / (TAU * sample_time_s),
        channel,
        gain_nms_per_rad: controller.gain_nms_per_rad()[channel],
    })
}

/// What an axis' sensor remembers from sample to sample: the position and velocity readings of the
/// sample before.
const READINGS: usize = 2;

/// The loop as a linear map of its state: the robot's states, then of axis after axis the readings
/// of the sample before, the controller's states and the torques on their way.
struct LinearLoop<'a> {
    sensors: &'a [Sensor],
    controllers: Vec<LinearController>,
    position_gain_per_s: Vec<f64>,
    gain_nms_per_rad: &'a [f64],
    sample_time_s: f64,
    phi: DMatrix<f64>,
    gamma: DMatrix<f64>,
    /// Motor velocities, then motor positions.
    c: DMatrix<f64>,
}

impl<'a> LinearLoop<'a> {
    fn new(
        robot: &dyn Robot,
        controller: &'a dyn Controller,
        sample_time_s: f64,
        sensors: &'a [Sensor],
    ) -> Result<Self, SignalError> {
        let n_axes = robot.n_axes();
        robot.check()?;
        controller.check(n_axes, sample_time_s)?;
        of_axes("sensors", sensors, n_axes)?
            .iter()
            .try_for_each(Sensor::check)?;
        let model = robot.state_space();
        let (phi, [gamma, _]) = model.held(Hold::Zoh, sample_time_s);
        let StateSpace { c, .. } = model;
        let linear = |axis| controller.linear(axis, sample_time_s);
        let position_gain = |axis| controller.position_gain_per_s(axis);
        Ok(Self {
            sensors,
            controllers: (0..n_axes).map(linear).collect(),
            position_gain_per_s: (0..n_axes).map(position_gain).collect(),
            gain_nms_per_rad: controller.gain_nms_per_rad(),
            sample_time_s,
            phi,
            gamma,
            c,
        })
    }

    /// Number of states of an axis' sensor and controller.
    fn n_states(&self, axis: usize) -> usize {
        READINGS + self.controllers[axis].n_states() + self.controllers[axis].delay_samples
    }

    /// Its matrix, column by column.
    fn matrix(&self) -> DMatrix<f64> {
        let of_axes = (0..self.sensors.len()).map(|axis| self.n_states(axis));
        let n = self.phi.nrows() + of_axes.sum::<usize>();
        let columns: Vec<DVector<f64>> = (0..n)
            .map(|k| self.next(&DVector::from_fn(n, |row, _| f64::from(u8::from(row == k)))))
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// The state at the next sample, without a reference.
    fn next(&self, state: &DVector<f64>) -> DVector<f64> {
        let n_axes = self.sensors.len();
        let (robot, mut memories) = state.as_slice().split_at(self.phi.nrows());
        let robot = DVector::from_column_slice(robot);
        let seen = &self.c * &robot;
        let mut torque = DVector::zeros(n_axes);
        let mut next = Vec::with_capacity(state.len());
        for axis in 0..n_axes {
            let (memory, others) = memories.split_at(self.n_states(axis));
            torque[axis] = self.step(axis, memory, [seen[axis], seen[n_axes + axis]], &mut next);
            memories = others;
        }
        let robot = &self.phi * robot + &self.gamma * torque;
        DVector::from_iterator(state.len(), robot.iter().copied().chain(next))
    }

    /// One step of an axis' sensor and controller, as [`Sensor`] and [`LinearController`] say:
    /// returns the torque in N m that acts next and appends what they remember.
    fn step(
        &self,
        axis: usize,
        memory: &[f64],
        [velocity, position]: [f64; 2],
        next: &mut Vec<f64>,
    ) -> f64 {
        let controller = &self.controllers[axis];
        let (readings, memory) = memory.split_at(READINGS);
        let (states, on_their_way) = memory.split_at(controller.n_states());
        let last = [readings[0], readings[1]];
        let reading = self.velocity_reading(axis, last, [velocity, position]);
        let error = -self.position_gain_per_s[axis] * position - reading;
        let states = DVector::from_column_slice(states);
        let asked = (&controller.c * &states)[0] + controller.d * error;
        let torques: Vec<f64> = on_their_way.iter().copied().chain([asked]).collect();
        next.extend([position, reading]);
        next.extend(&(&controller.a * &states + &controller.b * error));
        next.extend(&torques[1..]);
        torques[0]
    }

    /// The velocity reading of an axis' sensor, given the position and velocity readings of the
    /// sample before.
    fn velocity_reading(
        &self,
        axis: usize,
        [last_position, last_reading]: [f64; 2],
        [velocity, position]: [f64; 2],
    ) -> f64 {
        let sensor = &self.sensors[axis];
        let velocity = if sensor.velocity_by_differencing {
            (position - last_position) / self.sample_time_s
        } else {
            velocity
        };
        let pole = sensor.filter_pole(self.sample_time_s);
        pole * last_reading + (1.0 - pole) * velocity
    }

    /// The axis to which the proportional gain gives most power in the motion of a pole: gain |v|^2
    /// in its eigenvector.
    fn loudest_axis(&self, pole: Complex64) -> usize {
        let state = eigenvector(self.matrix().map(Complex64::from), pole);
        let velocity = self.c.map(Complex64::from) * state.rows(0, self.phi.nrows());
        let power = |axis: &usize| self.gain_nms_per_rad[*axis] * velocity[*axis].norm_sqr();
        (0..self.sensors.len())
            .max_by(|a, b| power(a).total_cmp(&power(b)))
            .unwrap_or(0)
    }
}

/// Eigenvector of a matrix at one of its eigenvalues, by inverse iteration.
fn eigenvector(matrix: DMatrix<Complex64>, eigenvalue: Complex64) -> DVector<Complex64> {
    let n = matrix.nrows();
    let nearby = DMatrix::from_diagonal_element(n, n, eigenvalue * (1.0 + 1e-9));
    let lu = (matrix - nearby).lu();
    let mut state = DVector::from_element(n, Complex64::from(1.0));
    for _ in 0..3 {
        let Some(next) = lu.solve(&state) else { break };
        state = next.normalize();
    }
    state
}
