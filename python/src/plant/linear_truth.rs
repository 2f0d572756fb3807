//! Linear truth of a plant: `Plant.frf` at its pose, `Plant.frf_at` at any poses.

use frfid_plant::{Hold, Robot, Sensor};
use frfid_signals::SignalError;
use num_complex::Complex64;
use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::choice::choice;
use crate::error;
use crate::frf::matrix::Frf;
use crate::frf::parts::per_frequency;
use crate::interrupt::interruptible;
use crate::plant::robot::Plant;
use crate::plant::states::States;

#[pymethods]
impl Plant {
    /// Linearised truth from motor torque to motor velocity: gear damping and viscous friction are
    /// in it; Coulomb friction, ripple, quantisation and the stiffness beyond the knee are not.
    ///
    /// Parameters
    /// ----------
    /// hz : array_like, shape (frequency,)
    ///     Frequencies in Hz.
    /// hold : {"zoh", "linear", "continuous"}, optional
    ///     What the torque does between samples; "continuous" for the transfer function itself.
    /// sample_time_s : float, optional
    ///     Sample time in s; needed by all but the plain transfer function.
    /// sensor : bool, optional
    ///     Whether the velocity is the reading of the plant's sensors: differenced positions and
    ///     filters, where it has them.
    ///
    /// Returns
    /// -------
    /// Frf
    ///     Response of shape (frequency, output, input), without uncertainty.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For frequencies or sample times that are not above 0.
    #[pyo3(signature = (hz, *, hold = "zoh", sample_time_s = None, sensor = false))]
    fn frf(
        &self,
        hz: &Bound<'_, PyAny>,
        hold: &str,
        sample_time_s: Option<f64>,
        sensor: bool,
    ) -> PyResult<Frf> {
        let hz = per_frequency("hz", hz)?;
        let seen = Seen::new(hold, sample_time_s, sensor)?;
        let frf = seen.frf(&*self.robot, &self.sensors, &hz);
        Ok(frf.map_err(error::signal)?.into())
    }

    /// Linearised truth of an arm at one or many poses at once, on all threads: at each what ``frf``
    /// says of the arm loaded with it as ``pose_rad``, to the last digit.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, shape (axis,) or (batch, axis)
    ///     Poses: link positions in rad, around which the links rest.
    /// hz : array_like, shape (frequency,)
    ///     Frequencies in Hz.
    /// hold : {"zoh", "linear", "continuous"}, optional
    ///     As in ``frf``.
    /// sample_time_s : float, optional
    ///     As in ``frf``.
    /// sensor : bool, optional
    ///     As in ``frf``.
    ///
    /// Returns
    /// -------
    /// ndarray, complex128, shape (frequency, output, input) or (batch, frequency, output, input)
    ///     From motor torques to motor velocities, in rad/s per N m.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint, another number of axes, a pose that is not finite, and as ``frf``.
    /// MemoryError
    ///     For more numbers than can be held.
    #[pyo3(signature = (q, hz, *, hold = "zoh", sample_time_s = None, sensor = false))]
    fn frf_at<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        hz: &Bound<'py, PyAny>,
        hold: &str,
        sample_time_s: Option<f64>,
        sensor: bool,
    ) -> PyResult<Bound<'py, PyArrayDyn<Complex64>>> {
        let (arm, n) = (self.arm()?, self.robot.n_axes());
        let poses = States::new(n, &[("q", q)])?;
        let hz = per_frequency("hz", hz)?;
        let seen = Seen::new(hold, sample_time_s, sensor)?;
        if poses.is_empty() || hz.is_empty() {
            seen.frf(&arm, &self.sensors, &hz).map_err(error::signal)?; // what else is given is checked, too
        }
        let at_pose = |state: &[&[f64]]| {
            let frf = seen.frf(&arm.at_pose(state[0]), &self.sensors, &hz)?;
            Ok(frf.response.into_raw_vec_and_offset().0)
        };
        let responses = interruptible(q.py(), None, |progress| {
            poses.each(&[hz.len(), n, n], &|| progress.goes_on(), at_pose)
        })?;
        Ok(c_ordered(q.py(), responses.map_err(error::signal)?))
    }
}

/// How the truth is looked at: through which hold, and whether through the sensors.
struct Seen {
    hold: Hold,
    sample_time_s: f64,
    sensor: bool,
}

impl Seen {
    fn new(hold: &str, sample_time_s: Option<f64>, sensor: bool) -> PyResult<Self> {
        let hold: Hold = choice("hold", hold)?;
        let sample_time_s = match sample_time_s {
            Some(sample_time_s) => sample_time_s,
            None if hold == Hold::Continuous && !sensor => 1.0, // the transfer function does not depend on it
            None => {
                return Err(PyValueError::new_err(
                    "sample_time_s is needed by a hold and by the sensor",
                ));
            }
        };
        Ok(Self {
            hold,
            sample_time_s,
            sensor,
        })
    }

    /// The FRF of a robot at its pose.
    fn frf(
        &self,
        robot: &dyn Robot,
        sensors: &[Sensor],
        hz: &[f64],
    ) -> Result<frfid_signals::Frf, SignalError> {
        if self.sensor {
            robot.frf_through_sensors(hz, self.hold, self.sample_time_s, sensors)
        } else {
            robot.frf(hz, self.hold, self.sample_time_s)
        }
    }
}
