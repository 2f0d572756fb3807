//! Controller of the motor velocities: the K of SK15 figure 2, in time and as a linear system.

use std::fmt::Debug;

use frfid_signals::SignalError;
use nalgebra::{DMatrix, DVector, RowDVector};
use num_complex::Complex64;

use crate::control::watch::Reached;

/// A sampled controller that makes each axis' motor torque from its velocity error.
///
/// The error is e = r - y, r and y the reference and the reading of the motor velocity. A position
/// loop adds k_p (q_ref - q) to it, q the reading of the motor position and
/// `q_ref[k] = q_ref[0] + T (r[0] + ... + r[k-1])` the exact integral of a reference held between
/// samples, from where the motor starts.
///
/// In time ([`Controller::axis`]) it keeps its limits; as a linear system ([`Controller::linear`])
/// it is the same without them. The closed-loop run follows from the one, the loop's FRFs and poles
/// from the other.
pub trait Controller: Debug + Send + Sync {
    /// Checks every parameter for a robot of `n_axes` on a clock of `sample_time_s`.
    ///
    /// # Errors
    /// [`SignalError::Shape`] for another number of axes, [`SignalError::Parameter`] for a number
    /// out of range.
    fn check(&self, n_axes: usize, sample_time_s: f64) -> Result<(), SignalError>;

    /// The controller of an axis at work, holding a torque in N m until an error says otherwise.
    fn axis(&self, axis: usize, sample_time_s: f64, holding_nm: f64) -> Box<dyn ControllerAxis>;

    /// The controller of an axis without its limits.
    fn linear(&self, axis: usize, sample_time_s: f64) -> LinearController;

    /// Gain k_p in 1/s of an axis' position loop; 0 for none.
    fn position_gain_per_s(&self, axis: usize) -> f64;

    /// Proportional gain in N m s/rad of every axis: what to lower where a loop is unstable.
    fn gain_nms_per_rad(&self) -> &[f64];
}

/// A controller at work on one axis, sample after sample.
pub trait ControllerAxis {
    /// Takes the error in rad/s of this sample; returns the torque that acts from it on.
    fn step(&mut self, error_rad_s: f64) -> ControllerOutput;
}

/// What a controller does at one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControllerOutput {
    /// Torque in N m to act next.
    pub torque_nm: f64,
    /// The limit that has just been reached.
    pub reached: Option<Reached>,
}

/// A linear controller from error e in rad/s to torque u in N m: `x[k+1] = A x[k] + B e[k]`,
/// `u[k + delay_samples] = C x[k] + D e[k]`.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearController {
    /// A, (state, state).
    pub a: DMatrix<f64>,
    /// B, (state).
    pub b: DVector<f64>,
    /// C, (state).
    pub c: RowDVector<f64>,
    /// D.
    pub d: f64,
    /// Whole samples from the error to the torque's acting.
    pub delay_samples: usize,
}

impl LinearController {
    /// The response K(z) = z^-delay (C (z I - A)^-1 B + D); infinite at a pole.
    #[must_use]
    pub fn response(&self, z: Complex64) -> Complex64 {
        let n = self.a.nrows();
        let pencil = DMatrix::from_diagonal_element(n, n, z) - self.a.map(Complex64::from);
        let Some(state) = pencil.lu().solve(&self.b.map(Complex64::from)) else {
            return Complex64::from(f64::INFINITY);
        };
        let states = (self.c.map(Complex64::from) * state)[0];
        (states + self.d) / z.powu(self.delay_samples as u32)
    }

    /// Number of states.
    #[must_use]
    pub fn n_states(&self) -> usize {
        self.a.nrows()
    }
}

/// Checks that frequencies in Hz lie below the Nyquist frequency of a controller.
pub(crate) fn below_nyquist(
    key: &'static str,
    hz: &[f64],
    sample_time_s: f64,
) -> Result<(), SignalError> {
    let beyond = hz.iter().find(|&&hz| 2.0 * hz * sample_time_s >= 1.0);
    beyond.map_or(Ok(()), |&found| {
        let needed = "a frequency below the Nyquist frequency of the controller";
        Err(SignalError::parameter(key, found, needed))
    })
}
