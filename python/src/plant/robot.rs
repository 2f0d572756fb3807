//! `frfid.Plant`: from parameters, files and text, and back.

use std::path::PathBuf;
use std::sync::Arc;

use frfid_experiment::{RobotTable, SingleJointTable, TomlText};
use frfid_plant::{Challenges, Robot, Sensor};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::choice::{from_json, from_python, json_object, json_value, to_python};
use crate::error;
use crate::size::List;

/// A robot in software, made by ``Plant.single_joint`` or ``Plant.load``.
#[pyclass(frozen, eq, module = "frfid")]
pub(crate) struct Plant {
    /// The robot as its file says it.
    pub table: RobotTable,
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
        pose_rad: Option<List<f64>>,
        challenges: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        error::check_there(&path)?;
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
            pose_rad: pose_rad.map_or_else(|| table.pose_rad.clone(), |List(pose)| Some(pose)),
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
