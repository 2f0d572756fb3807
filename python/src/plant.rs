//! `frfid.Plant`.

use std::path::PathBuf;
use std::sync::Arc;

use frfid_experiment::{RobotTable, Source};
use frfid_plant::{Hold, OpenLoop, Ripple, Robot, Sensor, SingleJoint, Velocity};
use ndarray::Ix1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::array::real;
use crate::batch::simulate;
use crate::choice::{choice, from_python, to_python};
use crate::error;
use crate::frf::Frf;
use crate::record::Record;

/// A robot in software, made by ``Plant.single_joint`` or ``Plant.load``.
#[pyclass(frozen, eq, module = "frfid")]
#[derive(PartialEq)]
pub struct Plant {
    pub joint: SingleJoint,
    pub sensor: Sensor,
}

#[pymethods]
impl Plant {
    /// One motor and one link with a gear between them, SK15 (20) to (22); everything on the joint side of the gear.
    ///
    /// Without arguments the paper's example with its nonlinearities off and ideal sensors.
    ///
    /// Parameters
    /// ----------
    /// motor_inertia_kg_m2, link_inertia_kg_m2 : float, optional
    ///     Inertias in kg m^2.
    /// damping_nms_per_rad : float, optional
    ///     Damping of the gear in N m s/rad.
    /// stiffness_nm_per_rad : float, optional
    ///     Stiffness of the gear in N m/rad, up to the knee.
    /// stiffness_beyond_nm_per_rad : float, optional
    ///     Stiffness beyond the knee in N m/rad; the same as before it if left out.
    /// knee_rad : float, optional
    ///     Deflection in rad at which the stiffness changes.
    /// coulomb_nm : float, optional
    ///     Coulomb friction of the motor in N m; it sticks while the net torque is below.
    /// viscous_nms_per_rad : float, optional
    ///     Viscous friction of the motor in N m s/rad.
    /// ripple : list of dict, optional
    ///     Harmonics of the torque ripple: ``{"cycles_per_turn": 12.0, "amplitude_nm": 3.0, "phase_rad": 0.0}``.
    /// velocity_by_differencing : bool, optional
    ///     The velocity reading is the difference of the last two positions over the sample time.
    /// position_increment_rad, position_noise_rad, velocity_noise_rad_s, torque_quantum_nm, torque_noise_nm : float, optional
    ///     Encoder count, rms of the white noise on position and velocity, resolution of the torque, rms of the noise on its
    ///     reading; whatever is left out is ideal.
    ///
    /// Returns
    /// -------
    /// Plant
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a parameter out of range.
    #[staticmethod]
    #[pyo3(signature = (*, motor_inertia_kg_m2 = 35.0, link_inertia_kg_m2 = 150.0, damping_nms_per_rad = 400.0,
                        stiffness_nm_per_rad = 1.5e5, stiffness_beyond_nm_per_rad = None, knee_rad = 1e-3,
                        coulomb_nm = 0.0, viscous_nms_per_rad = 0.0, ripple = None, velocity_by_differencing = false,
                        position_increment_rad = None, position_noise_rad = None, velocity_noise_rad_s = None,
                        torque_quantum_nm = None, torque_noise_nm = None))]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn single_joint(
        motor_inertia_kg_m2: f64,
        link_inertia_kg_m2: f64,
        damping_nms_per_rad: f64,
        stiffness_nm_per_rad: f64,
        stiffness_beyond_nm_per_rad: Option<f64>,
        knee_rad: f64,
        coulomb_nm: f64,
        viscous_nms_per_rad: f64,
        ripple: Option<&Bound<'_, PyAny>>,
        velocity_by_differencing: bool,
        position_increment_rad: Option<f64>,
        position_noise_rad: Option<f64>,
        velocity_noise_rad_s: Option<f64>,
        torque_quantum_nm: Option<f64>,
        torque_noise_nm: Option<f64>,
    ) -> PyResult<Self> {
        let ripple: Option<Vec<Ripple>> = ripple.map(|ripple| from_python("ripple", ripple)).transpose()?;
        let joint = SingleJoint {
            motor_inertia_kg_m2,
            link_inertia_kg_m2,
            damping_nms_per_rad,
            stiffness_nm_per_rad,
            stiffness_beyond_nm_per_rad: stiffness_beyond_nm_per_rad.unwrap_or(stiffness_nm_per_rad),
            knee_rad,
            coulomb_nm,
            viscous_nms_per_rad,
            ripple: ripple.unwrap_or_default(),
        };
        let sensor = Sensor {
            velocity: if velocity_by_differencing { Velocity::Differenced } else { Velocity::True },
            position_increment_rad,
            position_noise_rad,
            velocity_noise_rad_s,
            velocity_filter_hz: None,
            torque_quantum_nm,
            torque_noise_nm,
        };
        Self::checked(joint, sensor)
    }

    /// Reads a robot file, such as ``examples/robots/paper_joint.toml``.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The TOML file.
    ///
    /// Returns
    /// -------
    /// Plant
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     With file, line and caret of an unknown key or wrong type, or the parameter that is out of range.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        path.metadata()?;
        let robot: RobotTable = Source::read(&path).and_then(|source| source.parse()).map_err(error::config)?;
        let missing = || PyValueError::new_err(format!("{}: a table [single_joint] is needed", path.display()));
        Self::checked(robot.joint().ok_or_else(missing)?, robot.sensor())
    }

    /// Linearised truth from motor torque to motor velocity: gear damping and viscous friction are in it; Coulomb friction,
    /// ripple, quantisation and the stiffness beyond the knee are not.
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
    ///     Whether the velocity is seen as the difference of the last two positions over the sample time.
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
    fn frf(&self, hz: &Bound<'_, PyAny>, hold: &str, sample_time_s: Option<f64>, sensor: bool) -> PyResult<Frf> {
        let hz = real::<Ix1>("hz", hz, &[&["frequency"]])?.as_array().to_vec();
        let hold: Hold = choice("hold", hold)?;
        let sample_time_s = match sample_time_s {
            Some(sample_time_s) => sample_time_s,
            None if hold == Hold::Continuous && !sensor => 1.0, // the transfer function does not depend on it
            None => return Err(PyValueError::new_err("sample_time_s is needed by a hold and by the sensor")),
        };
        let velocity = if sensor { Velocity::Differenced } else { Velocity::True };
        Ok(self.joint.frf(&hz, hold, sample_time_s, velocity).map_err(error::signal)?.into())
    }

    /// Simulates in open loop, from position 0.
    ///
    /// Parameters
    /// ----------
    /// u : array_like, shape (input, sample) or (batch, input, sample)
    ///     Motor torque in N m.
    /// sample_time_s : float
    ///     Sample time in s.
    /// hold : {"zoh", "linear"}, optional
    ///     What the torque does between samples.
    /// velocity_rad_s : float or sequence of float, optional
    ///     Constant velocity in rad/s with which motor and link start; the torque that holds it against friction is added.
    /// seed : int, optional
    ///     Seed of the sensors' noise.
    /// progress : callable, optional
    ///     Called with (done, total), from (0, total) on; an exception from it stops the simulation.
    ///
    /// Returns
    /// -------
    /// Record
    ///     ``u`` is the torque that acted, ``y`` the velocity reading in rad/s, ``r`` the torque that was asked for.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For shapes that do not fit and samples that are not finite.
    /// NumericalError
    ///     If the simulation diverges.
    #[pyo3(signature = (u, *, sample_time_s, hold = "zoh", velocity_rad_s = None, seed = 0, progress = None))]
    fn simulate(
        &self,
        u: &Bound<'_, PyAny>,
        sample_time_s: f64,
        hold: &str,
        velocity_rad_s: Option<&Bound<'_, PyAny>>,
        seed: u64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Record> {
        let (joint, sensors) = (self.joint.clone(), vec![self.sensor]);
        let testbed = OpenLoop { sensors, seed, hold: choice("hold", hold)?, ..OpenLoop::new(Arc::new(joint)) };
        simulate("u", u, &testbed, sample_time_s, velocity_rad_s, progress)
    }

    /// The parameters, as ``Plant.single_joint`` takes them.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters = to_python(py, &self.joint)?.cast_into::<PyDict>()?;
        let sensor = to_python(py, &self.sensor)?.cast_into::<PyDict>()?;
        sensor.del_item("velocity")?;
        sensor.set_item("velocity_by_differencing", self.sensor.velocity == Velocity::Differenced)?;
        parameters.update(sensor.as_mapping())?;
        Ok(parameters)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<frfid.Plant: {}>", self.parameters(py)?))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, ())> {
        let single_joint = slf.get_type().getattr("single_joint")?;
        let keywords = slf.get().parameters(slf.py())?.into_py_dict(slf.py())?;
        let partial = slf.py().import("functools")?.getattr("partial")?;
        Ok((partial.call((single_joint,), Some(&keywords))?, ()))
    }
}

impl Plant {
    fn checked(joint: SingleJoint, sensor: Sensor) -> PyResult<Self> {
        joint.check().and_then(|()| sensor.check()).map_err(error::signal)?;
        Ok(Self { joint, sensor })
    }
}
