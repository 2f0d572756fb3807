//! What every simulated robot can tell of itself: the seam between descriptions, testbeds and the linear truth.

use std::f64::consts::TAU;
use std::fmt::Debug;

use frfid_signals::{Frf, SignalError};
use num_complex::Complex64;

use crate::{Hold, Moving, PlantError, StateSpace, Velocity};

/// A robot in software: the description of a machine that can be set in motion and linearised.
pub trait Robot: Debug + Send + Sync {
    /// Number of axes, each with a motor.
    fn n_axes(&self) -> usize;

    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError`] naming the first parameter that is not finite or out of range.
    fn check(&self) -> Result<(), SignalError>;

    /// A step of the integrator in s that keeps its error far below that of any measurement.
    fn default_step_s(&self) -> f64;

    /// Sets the robot in motion: links at `start_rad` from the pose, motors and links at `velocity_rad_s`, gears deflected by
    /// the torques that hold them there. One value for each axis.
    ///
    /// # Errors
    /// [`PlantError`] for a parameter out of range or another number of axes.
    fn start(&self, start_rad: &[f64], velocity_rad_s: &[f64]) -> Result<Box<dyn Moving>, PlantError>;

    /// The linear model at the pose from motor torques to motor velocities and motor positions, outputs in this order. Gear
    /// damping, viscous friction and the gradient of gravity are in it; Coulomb friction, ripple and the stiffness beyond the
    /// knee are not.
    fn state_space(&self) -> StateSpace;

    /// The exact FRF in rad/s per N m from motor torques to the velocity readings at the pose, `(frequency, output, input)`,
    /// through a hold of `sample_time_s`.
    ///
    /// A differenced velocity is the FRF of the position times (1 - e^{-s T}) / T, which is exact under every hold.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a parameter of the robot, a frequency or a sample time out of range.
    fn frf(&self, hz: &[f64], hold: Hold, sample_time_s: f64, velocity: Velocity) -> Result<Frf, SignalError> {
        self.check()?;
        let StateSpace { a, b, c, d } = self.state_space();
        let n_axes = self.n_axes();
        let first = match velocity {
            Velocity::True => 0,
            Velocity::Differenced => n_axes,
        };
        let (c, d) = (c.rows(first, n_axes).into_owned(), d.rows(first, n_axes).into_owned());
        let mut frf = StateSpace { a, b, c, d }.frf(hz, hold, sample_time_s)?;
        if velocity == Velocity::Differenced {
            for (mut matrix, f) in frf.response.outer_iter_mut().zip(hz) {
                let difference = (1.0 - Complex64::cis(-TAU * f * sample_time_s)) / sample_time_s;
                matrix.mapv_inplace(|value| value * difference);
            }
        }
        Ok(frf)
    }
}
