//! Linear truth of a plant: `Plant.frf`.

use frfid_plant::Hold;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::choice::choice;
use crate::error;
use crate::frf::matrix::Frf;
use crate::frf::parts::per_frequency;
use crate::plant::robot::Plant;

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
        let frf = if sensor {
            self.robot
                .frf_through_sensors(&hz, hold, sample_time_s, &self.sensors)
        } else {
            self.robot.frf(&hz, hold, sample_time_s)
        };
        Ok(frf.map_err(error::signal)?.into())
    }
}
