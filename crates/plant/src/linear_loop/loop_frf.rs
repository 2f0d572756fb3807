//! The linear closed loop in the frequency domain: what an ideal closed-loop experiment would find.

use std::f64::consts::TAU;

use frfid_signals::checks::positive;
use frfid_signals::{Frf, SignalError};
use nalgebra::{DMatrix, DVector};
use ndarray::Array3;
use num_complex::Complex64;

use crate::control::pi::{Gains, PiController};
use crate::control::sensor::Sensor;
use crate::robot::Robot;
use crate::state_space::{Hold, StateSpace};

/// Exact FRFs between the samples of a linear closed loop at the robot's pose, each
/// `(frequency, output, input)`: without limits, quantisation, noise, Coulomb friction and ripple,
/// with delay, differencing and filters.
///
/// In z = e^{j 2 pi f T}, with P the plant as the sensors see it, Q its positions, the controller K
/// = z^-delay (gain + integral_gain T / (z - 1)) and the position gain k_p, all diagonal but P and
/// Q: e = (1 + k_p T / (z - 1)) r - L u, u = K e, L = P + k_p Q.
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
    /// The FRFs at frequencies in Hz below the Nyquist frequency of the controller.
    ///
    /// # Errors
    /// [`SignalError`] for a parameter or frequency out of range, a number of axes that does not
    /// fit, or a frequency at which robot or loop have a pole.
    pub fn new(
        robot: &dyn Robot,
        controller: &PiController,
        sensors: &[Sensor],
        hz: &[f64],
    ) -> Result<Self, SignalError> {
        let n_axes = robot.n_axes();
        controller.check(n_axes)?;
        let sample_time_s = controller.sample_time_s;
        let plant = robot.frf_through_sensors(hz, Hold::Zoh, sample_time_s, sensors)?;
        let StateSpace { a, b, c, d } = robot.state_space();
        let positions = StateSpace {
            a,
            b,
            c: c.rows(n_axes, n_axes).into_owned(),
            d: d.rows(n_axes, n_axes).into_owned(),
        };
        let position = positions.frf(hz, Hold::Zoh, sample_time_s)?;
        let mut responses = [(); 3].map(|()| Array3::zeros(plant.response.dim()));
        for (line, &f) in hz.iter().enumerate() {
            let matrices = at_line(
                controller,
                f,
                [&plant, &position].map(|frf| matrix(frf, line)),
            )?;
            for (response, matrix) in responses.iter_mut().zip(matrices) {
                for output in 0..n_axes {
                    for input in 0..n_axes {
                        response[[line, output, input]] = matrix[(output, input)];
                    }
                }
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
    controller: &PiController,
    hz: f64,
    [plant, position]: [DMatrix<Complex64>; 2],
) -> Result<[DMatrix<Complex64>; 3], SignalError> {
    let n_axes = plant.nrows();
    let sample_time_s = controller.sample_time_s;
    positive("hz", hz)?;
    if 2.0 * hz * sample_time_s >= 1.0 {
        let needed = "a frequency below the Nyquist frequency of the controller";
        return Err(SignalError::Parameter {
            key: "hz",
            found: hz,
            needed,
        });
    }
    let advance = Complex64::cis(TAU * hz * sample_time_s) - 1.0;
    let delay = Complex64::cis(-TAU * hz * sample_time_s * controller.delay_samples as f64);
    let diagonal = |of: &dyn Fn(Gains) -> Complex64| {
        DMatrix::from_diagonal(&DVector::from_fn(n_axes, |axis, _| {
            of(controller.gains(axis))
        }))
    };
    let control = diagonal(&|gains| delay * (gains.proportional + gains.integral_step / advance));
    let ahead = diagonal(&|gains| 1.0 + gains.position * sample_time_s / advance);
    let open = &plant + diagonal(&|gains| gains.position.into()) * position;
    let needed = "a frequency at which the loop has no pole";
    let pole = SignalError::Parameter {
        key: "hz",
        found: hz,
        needed,
    };
    let sensitivity = (DMatrix::identity(n_axes, n_axes) + open * &control)
        .try_inverse()
        .ok_or(pole)?;
    let torque = control * &sensitivity * ahead;
    let velocity = plant * &torque;
    Ok([sensitivity, torque, velocity])
}

fn matrix(frf: &Frf, line: usize) -> DMatrix<Complex64> {
    DMatrix::from_fn(frf.n_outputs(), frf.n_inputs(), |output, input| {
        frf.response[[line, output, input]]
    })
}
