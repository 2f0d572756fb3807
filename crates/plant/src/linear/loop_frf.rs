//! FRFs of the linear closed loop: what an ideal closed-loop experiment would find.

use std::f64::consts::TAU;

use frfid_signals::checks::positive;
use frfid_signals::{Frf, SignalError};
use nalgebra::{DMatrix, DVector};
use ndarray::Array3;
use num_complex::Complex64;

use crate::control::controller::{Controller, below_nyquist};
use crate::control::sensor::Sensor;
use crate::robot::Robot;
use crate::state_space::{Hold, put_line};

/// Exact FRFs between the samples of a linear closed loop at the robot's pose, each
/// `(frequency, output, input)`: without limits, quantisation, noise, Coulomb friction and ripple,
/// with delay, differencing and filters.
///
/// In z = e^{j 2 pi f T}, with P the plant as the sensors see it, Q its positions, the controller K
/// ([`LinearController::response`](crate::LinearController::response)) and the position gain k_p,
/// all diagonal but P and Q: e = (1 + k_p T / (z - 1)) r - L u, u = K e, L = P + k_p Q.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopFrf {
    /// S = (I + L K)^-1: what is left of an error. S = I where the controller does nothing; peaks
    /// show a small margin.
    pub sensitivity: Frf,
    /// From reference velocity r in rad/s to motor torque u in N m: K S (1 + k_p T / (z - 1)).
    pub reference_to_torque: Frf,
    /// From reference velocity r to velocity reading y, both in rad/s: P K S (1 + k_p T / (z - 1)).
    pub reference_to_velocity: Frf,
    /// From motor torque u in N m to velocity reading y in rad/s: P, as [`Robot::frf_through_sensors`] gives
    /// it behind a zoh.
    pub plant: Frf,
}

impl LoopFrf {
    /// The FRFs at frequencies in Hz below the Nyquist frequency of the controller, whose sample
    /// time is given in s.
    ///
    /// ```
    /// use frfid_plant::{LoopFrf, PiController, Sensor, SingleJoint};
    ///
    /// let controller = PiController::new(vec![2000.0], vec![16_000.0]);
    /// let (joint, sensors) = (SingleJoint::default(), [Sensor::default()]);
    /// let frf = LoopFrf::new(&joint, &controller, 1e-3, &sensors, &[0.5, 100.0])?;
    /// let sensitivity = |k: usize| frf.sensitivity.response[[k, 0, 0]].norm();
    /// assert!(sensitivity(0) < 0.12 && sensitivity(1) > 1.0); // little is left of an error at 0.5 Hz
    /// # Ok::<(), frfid_signals::SignalError>(())
    /// ```
    ///
    /// # Errors
    /// [`SignalError`] for a parameter or frequency out of range, a number of axes that does not
    /// fit, or a frequency at which robot or loop have a pole.
    pub fn new(
        robot: &dyn Robot,
        controller: &dyn Controller,
        sample_time_s: f64,
        sensors: &[Sensor],
        hz: &[f64],
    ) -> Result<Self, SignalError> {
        let n_axes = robot.n_axes();
        controller.check(n_axes, sample_time_s)?;
        let plant = robot.frf_through_sensors(hz, Hold::Zoh, sample_time_s, sensors)?;
        let positions: Vec<usize> = (n_axes..2 * n_axes).collect();
        let model = robot.state_space().of_outputs(&positions);
        let position = model.frf(hz, Hold::Zoh, sample_time_s)?;
        let mut responses = [(); 3].map(|()| Array3::zeros(plant.response.dim()));
        for (line, &f) in hz.iter().enumerate() {
            let matrices = at_line(
                controller,
                sample_time_s,
                f,
                [&plant, &position].map(|frf| matrix(frf, line)),
            )?;
            for (response, matrix) in responses.iter_mut().zip(&matrices) {
                put_line(response, line, matrix);
            }
        }
        let [sensitivity, reference_to_torque, reference_to_velocity] =
            responses.map(|response| Frf {
                response,
                ..plant.clone()
            });
        Ok(Self {
            sensitivity,
            reference_to_torque,
            reference_to_velocity,
            plant,
        })
    }
}

/// S, r to u and r to y at a frequency in Hz, given P and Q.
fn at_line(
    controller: &dyn Controller,
    sample_time_s: f64,
    hz: f64,
    [plant, position]: [DMatrix<Complex64>; 2],
) -> Result<[DMatrix<Complex64>; 3], SignalError> {
    let n_axes = plant.nrows();
    positive("hz", hz)?;
    below_nyquist("hz", &[hz], sample_time_s)?;
    let z = Complex64::cis(TAU * hz * sample_time_s);
    let control = diagonal(n_axes, |axis| {
        controller.linear(axis, sample_time_s).response(z)
    });
    let position_gain = diagonal(n_axes, |axis| controller.position_gain_per_s(axis).into());
    let ahead = diagonal(n_axes, |_| 1.0.into()) + &position_gain * (sample_time_s / (z - 1.0));
    let open = &plant + position_gain * position;
    let needed = "a frequency at which the loop has no pole";
    let sensitivity = (DMatrix::identity(n_axes, n_axes) + open * &control)
        .try_inverse()
        .ok_or(SignalError::parameter("hz", hz, needed))?;
    let torque = control * &sensitivity * ahead;
    let velocity = plant * &torque;
    Ok([sensitivity, torque, velocity])
}

/// A diagonal matrix of one number for each axis.
fn diagonal(n_axes: usize, number: impl Fn(usize) -> Complex64) -> DMatrix<Complex64> {
    DMatrix::from_diagonal(&DVector::from_fn(n_axes, |axis, _| number(axis)))
}

/// The matrix of an FRF at one of its frequencies.
fn matrix(frf: &Frf, line: usize) -> DMatrix<Complex64> {
    DMatrix::from_fn(frf.n_outputs(), frf.n_inputs(), |output, input| {
        frf.response[[line, output, input]]
    })
}
