//! `frfid.Plant`.

use std::path::PathBuf;
use std::sync::Arc;

use frfid_experiment::{RobotTable, SingleJointTable, TomlText};
use frfid_plant::{Actuation, Arm, Challenges, Hold, Robot, Sensor, SimulatedRobot};
use ndarray::Ix1;
use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::real;
use crate::batch::simulate;
use crate::choice::{choice, from_json, from_python, json_object, json_value, to_python};
use crate::error;
use crate::frf::Frf;
use crate::record::Record;
use crate::states::per_state;

/// A robot in software, made by ``Plant.single_joint`` or ``Plant.load``.
#[pyclass(frozen, eq, module = "frfid")]
pub struct Plant {
    /// The robot as its file says it.
    table: RobotTable,
    pub robot: Arc<dyn Robot>,
    pub sensors: Vec<Sensor>,
}

/// Plants are the same if they move and measure in the same way, however they are written.
impl PartialEq for Plant {
    fn eq(&self, other: &Self) -> bool {
        let machine = |table: &RobotTable| (table.single_joint(), table.arm(), table.sensors());
        machine(&self.table) == machine(&other.table)
    }
}

#[pymethods]
impl Plant {
    /// One motor and one link with a gear between them, SK15 (20) to (22); everything on the joint
    /// side of the gear.
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
    ///     Harmonics of the torque ripple: ``{"cycles_per_turn": 12.0, "amplitude_nm": 3.0,
    ///     "phase_rad": 0.0}``.
    /// velocity_by_differencing : bool, optional
    ///     The velocity reading is the difference of the last two positions over the sample time.
    /// position_increment_rad, position_noise_rad, velocity_noise_rad_s, torque_quantum_nm, torque_noise_nm : float, optional
    ///     Encoder count, rms of the white noise on position and velocity, resolution of the
    ///     torque, rms of the noise on its reading; whatever is left out is ideal.
    /// velocity_filter_hz : float, optional
    ///     Corner of a low-pass of first order on the velocity reading.
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
    #[pyo3(signature = (**parameters))]
    fn single_joint(parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut joint = json_object(&SingleJointTable::default())?;
        let mut sensor = json_object(&Sensor::default())?;
        for (key, value) in parameters.into_iter().flatten() {
            let key: String = key.extract()?;
            let value = json_value(&key, &value)?;
            if sensor.contains_key(&key) {
                sensor.insert(key, value);
            } else {
                joint.insert(key, value);
            }
        }
        Self::of(RobotTable {
            single_joint: Some(from_json("single_joint", joint)?),
            sensor: Some(from_json("sensor", sensor)?),
            ..RobotTable::default()
        })
    }

    /// Reads a robot file, such as ``examples/robots/manutec_r3.toml``: a single joint, or an arm
    /// of any number of axes.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The TOML file; URDF that it names is looked up beside it.
    /// pose_rad : sequence of float, optional
    ///     Pose of an arm, one link position in rad for each axis; that of the file if left out.
    /// challenges : dict of bool, optional
    ///     Challenges to switch on or off, those that are not named as the file says:
    ///     ``gear_load_limit``, ``coulomb_friction``, ``stiffening``, ``position_dependence``,
    ///     ``torque_ripple``, ``sensing``, ``gravity``.
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
    ///     With file, line and caret of an unknown key or wrong type, or the parameter that is out
    ///     of range.
    #[staticmethod]
    #[pyo3(signature = (path, *, pose_rad = None, challenges = None))]
    fn load(
        path: PathBuf,
        pose_rad: Option<Vec<f64>>,
        challenges: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        path.metadata()?;
        let table = RobotTable::load(&path).map_err(error::config)?;
        let challenges: Option<Challenges> = challenges
            .map(|challenges| from_python("challenges", challenges))
            .transpose()?;
        if pose_rad.is_some() && table.arm().is_none() {
            return Err(PyValueError::new_err(
                "pose_rad: a single joint has no pose, leave it out",
            ));
        }
        Self::of(RobotTable {
            pose_rad: pose_rad.or_else(|| table.pose_rad.clone()),
            challenges: challenges.unwrap_or_default().or(table.challenges),
            ..table
        })
    }

    /// A plant from the text of a robot file that stands alone, as ``to_toml`` writes it.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     TOML.
    ///
    /// Returns
    /// -------
    /// Plant
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     As ``load``.
    #[staticmethod]
    fn from_toml(text: String) -> PyResult<Self> {
        let text = TomlText::new("robot", text);
        Self::of(text.parse().map_err(error::config)?)
    }

    /// The plant as the text of a robot file that stands alone.
    fn to_toml(&self) -> PyResult<String> {
        toml::to_string(&self.table).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Number of axes.
    #[getter]
    fn n_axes(&self) -> usize {
        self.robot.n_axes()
    }

    /// Names of the joints, from the base to the tip.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.table.joint_names()
    }

    /// The pose: link positions in rad, one for each axis; 0 for a single joint.
    #[getter]
    fn pose_rad(&self) -> Vec<f64> {
        self.table.pose()
    }

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
        let hz = real::<Ix1>("hz", hz, &[&["frequency"]])?
            .as_array()
            .to_vec();
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

    /// Simulates in open loop, from the pose.
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
    ///     Constant velocity in rad/s with which motors and links start; the torques that hold it
    ///     against friction, and the links against gravity, are added.
    /// seed : int, optional
    ///     Seed of the sensors' noise.
    /// progress : callable, optional
    ///     Called with (done, total), from (0, total) on; an exception from it stops the
    ///     simulation.
    ///
    /// Returns
    /// -------
    /// Record
    ///     ``u`` is the torque that acted, ``y`` the velocity reading in rad/s, ``r`` the torque
    ///     that was asked for.
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
        let (robot, sensors) = (self.robot.clone(), self.sensors.clone());
        let testbed = SimulatedRobot {
            sensors,
            seed,
            actuation: Actuation::Torque {
                hold: choice("hold", hold)?,
            },
            ..SimulatedRobot::open_loop(robot)
        };
        simulate(
            "u",
            u,
            &testbed,
            sample_time_s,
            velocity_rad_s,
            None,
            progress,
        )
    }

    /// Mass matrix of an arm's links.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, shape (axis,) or (batch, axis)
    ///     Link positions in rad.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape (axis, axis) or (batch, axis, axis)
    ///     In kg m^2.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint, or another number of axes.
    fn mass_matrix<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (arm, n) = (self.arm()?, self.n_axes());
        let matrix =
            |state: &[&[f64]]| Ok(arm.mass_matrix(state[0])?.transpose().as_slice().to_vec());
        per_state(q.py(), n, &[("q", q)], &[n, n], matrix)
    }

    /// Torques that hold an arm's links against gravity.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, shape (axis,) or (batch, axis)
    ///     Link positions in rad.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape of q
    ///     In N m.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint, or another number of axes.
    fn gravity_torque<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let arm = self.arm()?;
        per_state(
            q.py(),
            self.n_axes(),
            &[("q", q)],
            &[self.n_axes()],
            |state| arm.gravity_torque_nm(state[0]),
        )
    }

    /// Accelerations of an arm's links: M^-1 (torque - C qd - g).
    ///
    /// Parameters
    /// ----------
    /// q, qd, torque : array_like, shape (axis,) or (batch, axis)
    ///     Link positions in rad, velocities in rad/s, and the torques in N m that the gears
    ///     transmit.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape of q
    ///     In rad/s^2.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint, or shapes that do not fit.
    fn link_acceleration<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        qd: &Bound<'py, PyAny>,
        torque: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let arm = self.arm()?;
        let arguments = [("q", q), ("qd", qd), ("torque", torque)];
        per_state(
            q.py(),
            self.n_axes(),
            &arguments,
            &[self.n_axes()],
            |state| arm.link_acceleration(state[0], state[1], state[2]),
        )
    }

    /// Frequencies of an arm's undamped elastic modes at the pose, without gravity.
    ///
    /// Parameters
    /// ----------
    /// motors_locked : bool, optional
    ///     The modes of the links with the motors held: the zeros of the FRFs taken together.
    ///
    /// Returns
    /// -------
    /// list of float
    ///     In Hz, rising.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint.
    #[pyo3(signature = (*, motors_locked = false))]
    fn modes_hz(&self, motors_locked: bool) -> PyResult<Vec<f64>> {
        let arm = self.arm()?;
        if motors_locked {
            arm.locked_motor_hz()
        } else {
            arm.modes_hz()
        }
        .map_err(error::signal)
    }

    /// The parameters of a single joint, as ``Plant.single_joint`` takes them.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arm = || {
            PyValueError::new_err(
                "an arm has no parameters of a single joint; to_toml() tells its tables",
            )
        };
        let joint = self.table.single_joint.as_ref().ok_or_else(arm)?;
        let parameters = to_python(py, joint)?.cast_into::<PyDict>()?;
        let sensor =
            to_python(py, &self.table.sensor.unwrap_or_default())?.cast_into::<PyDict>()?;
        parameters.update(sensor.as_mapping())?;
        Ok(parameters)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        if self.table.single_joint.is_some() {
            return Ok(format!("<frfid.Plant: {}>", self.parameters(py)?));
        }
        let (n_axes, names, pose) = (
            self.n_axes(),
            self.joint_names().join(", "),
            self.pose_rad(),
        );
        Ok(format!(
            "<frfid.Plant: {n_axes} axes ({names}) at {pose:?} rad>"
        ))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((
            slf.get_type().getattr("from_toml")?,
            (slf.get().to_toml()?,),
        ))
    }
}

impl Plant {
    fn arm(&self) -> PyResult<Arm> {
        self.table.arm().ok_or_else(|| {
            PyValueError::new_err("a single joint is no arm: it has one link and one mode")
        })
    }

    /// The robot that the tables describe, once every number is found sound.
    fn of(table: RobotTable) -> PyResult<Self> {
        let robot = table.robot().map_err(error::config)?;
        let sensors = table.sensors();
        Ok(Self {
            table,
            robot,
            sensors,
        })
    }
}
