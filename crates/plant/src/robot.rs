//! Robot in software: the seam between descriptions of machines, testbeds and the linear truth.

use std::fmt::Debug;

use frfid_signals::checks::of_axes;
use frfid_signals::{Frf, SignalError};

use crate::control::sensor::Sensor;
use crate::error::PlantError;
use crate::motion::Motion;
use crate::state_space::{Hold, StateSpace};

/// A robot in software: the description of a machine that can be set in motion and linearised.
pub trait Robot: Debug + Send + Sync {
    /// Number of axes, each with a motor.
    fn n_axes(&self) -> usize;

    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError`] naming the first parameter that is not finite or out of range.
    fn check(&self) -> Result<(), SignalError>;

    /// The fastest rate at which it moves by itself in rad/s: of its stiffest resonance, or of a
    /// decay; NaN for an unsound robot.
    fn fastest_rad_s(&self) -> f64;

    /// A step of the integrator in s that keeps its error far below that of any measurement.
    fn default_step_s(&self) -> f64;

    /// Sets the robot in motion: links at `start_rad` from the pose, motors and links at
    /// `velocity_rad_s`, gears deflected by the torques that hold them there. One value for each
    /// axis.
    ///
    /// # Errors
    /// [`PlantError`] for a parameter out of range or another number of axes.
    fn start(
        &self,
        start_rad: &[f64],
        velocity_rad_s: &[f64],
    ) -> Result<Box<dyn Motion>, PlantError>;

    /// As [`Robot::start`], to move by exact steps of `step_s` within its modes of friction and
    /// spring: where the joint is piecewise linear. The steps are at most a 32nd of a period of the
    /// [fastest](Robot::fastest_rad_s) motion.
    ///
    /// # Errors
    /// As [`Robot::start`]; [`PlantError::NotExact`] unless it is a single joint without ripple.
    fn start_exact(
        &self,
        _start_rad: &[f64],
        _velocity_rad_s: &[f64],
        _step_s: f64,
    ) -> Result<Box<dyn Motion>, PlantError> {
        let found = "this robot is no single joint";
        Err(PlantError::NotExact { found })
    }

    /// The linear model at the pose from motor torques to motor velocities and motor positions,
    /// outputs in this order. Gear damping, viscous friction and the gradient of gravity are in it;
    /// Coulomb friction, ripple and the stiffness beyond the knee are not.
    fn state_space(&self) -> StateSpace;

    /// Coulomb friction in N m of every axis.
    fn coulomb_nm(&self) -> Vec<f64>;

    /// What is possible but looks like a mistake, in words.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// The exact FRF in rad/s per N m from motor torques to the true motor velocities at the pose,
    /// `(frequency, output, input)`, through a hold of `sample_time_s`.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a parameter of the robot, a frequency or a sample time out of
    /// range.
    fn frf(&self, hz: &[f64], hold: Hold, sample_time_s: f64) -> Result<Frf, SignalError> {
        let ideal = vec![Sensor::default(); self.n_axes()];
        self.frf_through_sensors(hz, hold, sample_time_s, &ideal)
    }

    /// [`Robot::frf`] as each axis' own sensor sees it, filter included.
    ///
    /// A sensor sees samples, so the FRF of the velocity, or the position where it is differenced,
    /// times [`Sensor::response`] is exact under every hold.
    ///
    /// # Errors
    /// As [`Robot::frf`]; [`SignalError::Shape`] unless there is a sensor for each axis.
    fn frf_through_sensors(
        &self,
        hz: &[f64],
        hold: Hold,
        sample_time_s: f64,
        sensors: &[Sensor],
    ) -> Result<Frf, SignalError> {
        self.check()?;
        let n_axes = self.n_axes();
        of_axes("sensors", sensors, n_axes)?
            .iter()
            .try_for_each(Sensor::check)?;
        // differences are taken of positions, the rows after those of the velocities
        let row = |(axis, sensor): (usize, &Sensor)| {
            axis + if sensor.velocity_by_differencing {
                n_axes
            } else {
                0
            }
        };
        let rows: Vec<usize> = sensors.iter().enumerate().map(row).collect();
        let model = self.state_space().of_outputs(&rows);
        let mut frf = model.frf(hz, hold, sample_time_s)?;
        for ((line, axis, _), value) in frf.response.indexed_iter_mut() {
            *value *= sensors[axis].response(hz[line], sample_time_s);
        }
        Ok(frf)
    }
}
