//! Robot: its tables in `experiment.toml` and in a robot file of its own.

pub(crate) mod body;
pub(crate) mod check;
pub(crate) mod joint;
pub(crate) mod urdf;
pub(crate) mod urdf_limits;
pub(crate) mod urdf_start;

use std::path::Path;
use std::sync::Arc;

use frfid_plant::{Arm, Challenges, Payload, Robot, Sensor, SingleJoint, is_posed};
use frfid_signals::{Limit, Limits};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::fault::Fault;
use crate::description::robot::body::BodyTable;
use crate::description::robot::check::no_robot;
use crate::description::robot::joint::{JointTable, SingleJointTable};
use crate::description::robot::urdf::UrdfTable;
use crate::description::text::{ConfigError, TomlText};

/// Gravity where none is given: z up.
const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];

/// The machine: `file`, a robot file of its own, or the tables of such a file right here. A robot
/// is a `[single_joint]`, an arm of `[[body]]` tables, or an arm from `[urdf]`. Beside `file`, only
/// `pose_rad` and `[challenges]` may be given; they go before those of the file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotTable {
    /// A robot file, relative to the file that names it.
    pub file: Option<String>,
    /// Acceleration of gravity in m/s^2 in the frame of the base; (0, 0, -9.81) without it.
    pub gravity_m_s2: Option<[f64; 3]>,
    /// The pose of an arm: link positions in rad, one for each joint that moves; zeros without it.
    pub pose_rad: Option<Vec<f64>>,
    /// One motor and one link with a gear between them.
    pub single_joint: Option<SingleJointTable>,
    /// Sensors and torque resolution of a single joint; ideal without this table. The joints of an
    /// arm have their own.
    pub sensor: Option<Sensor>,
    /// Which challenges the robot poses; all without this table.
    #[serde(default)]
    pub challenges: Challenges,
    /// The bodies of an arm, from the base to the tip.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub body: Vec<BodyTable>,
    /// What the last body of an arm carries.
    pub payload: Option<Payload>,
    /// An arm from URDF, with a table of its joints: URDF knows no gears.
    pub urdf: Option<UrdfTable>,
    /// Whether the bodies come from URDF: errors point there.
    #[serde(skip)]
    pub is_from_urdf: bool,
}

impl RobotTable {
    /// Reads a robot file; what it refers to is looked up beside it.
    ///
    /// # Errors
    /// [`ConfigError`]: the file cannot be read, or the place and reason of what is wrong in it.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        Self::of_text(
            &TomlText::read(path)?,
            path.parent().unwrap_or(Path::new("")),
        )
    }

    /// A robot file's text, checked; what it refers to is looked up in `folder`.
    fn of_text(text: &TomlText, folder: &Path) -> Result<Self, ConfigError> {
        let mut robot: Self = text.parse()?;
        if robot.file.is_some() {
            return Err(text.error(&["file"], "a robot file cannot name another one"));
        }
        robot.read_urdf(text, folder, &[])?;
        robot.check().map_err(|fault| text.locate(&[], fault))?;
        Ok(robot)
    }

    /// Puts what other files say in the place of their names: the robot file, and the bodies of
    /// URDF.
    pub(crate) fn read_files(&mut self, text: &TomlText, folder: &Path) -> Result<(), ConfigError> {
        let Some(file) = self.file.take() else {
            return self.read_urdf(text, folder, &["robot"]);
        };
        let (pose_rad, challenges) = (self.pose_rad.take(), std::mem::take(&mut self.challenges));
        if *self != Self::default() {
            let message = "a robot file and tables of a robot are given; keep one of them \
                           (only pose_rad and challenges may stand beside a file)";
            return Err(text.error(&["robot", "file"], message));
        }
        let path = folder.join(&file);
        let robot =
            Self::load(&path).map_err(|error| text.error(&["robot", "file"], error.to_string()))?;
        let pose_rad = pose_rad.or_else(|| robot.pose_rad.clone());
        *self = Self {
            pose_rad,
            challenges: challenges.or(robot.challenges),
            ..robot
        };
        Ok(())
    }

    /// The robot to be simulated.
    ///
    /// # Errors
    /// [`ConfigError`] with what is wrong in the tables.
    pub fn robot(&self) -> Result<Arc<dyn Robot>, ConfigError> {
        self.resolve().map_err(|fault| fault.without_text("robot"))
    }

    /// The robot to be simulated, once it is found sound.
    pub(crate) fn resolve(&self) -> Result<Arc<dyn Robot>, Fault> {
        self.check()?;
        Ok(match self.single_joint() {
            Some(joint) => Arc::new(joint),
            None => Arc::new(self.arm().ok_or_else(no_robot)?),
        })
    }

    /// Whether anything is said of a robot.
    pub(crate) fn is_described(&self) -> bool {
        *self != Self::default()
    }

    /// The opposite of [`RobotTable::is_described`].
    pub(crate) fn is_left_out(&self) -> bool {
        !self.is_described()
    }

    /// Whether the robot is an arm: a single joint has no bodies.
    pub(crate) fn is_arm(&self) -> bool {
        !self.body.is_empty()
    }

    /// Number of axes.
    #[must_use]
    pub fn n_axes(&self) -> usize {
        if self.is_arm() {
            self.joints().count()
        } else {
            1
        }
    }

    /// Names of the joints, as they stand in the logs: those of the bodies they move.
    #[must_use]
    pub fn joint_names(&self) -> Vec<String> {
        if !self.is_arm() {
            return vec!["joint_1".to_owned()];
        }
        self.joints().map(|(body, _)| body.name.clone()).collect()
    }

    /// The pose in rad, one position for each axis.
    #[must_use]
    pub fn pose(&self) -> Vec<f64> {
        self.pose_rad
            .clone()
            .unwrap_or_else(|| vec![0.0; self.n_axes()])
    }

    /// The bodies that move, with their joints.
    fn joints(&self) -> impl Iterator<Item = (&BodyTable, &JointTable)> {
        self.body
            .iter()
            .filter_map(|body| Some((body, body.joint.as_ref()?)))
    }

    /// The sensor of every axis; ideal, but for where the velocity comes from, which is linear.
    #[must_use]
    pub fn sensors(&self) -> Vec<Sensor> {
        if !is_posed(self.challenges.sensing) {
            return vec![Sensor::default(); self.n_axes()];
        }
        if !self.is_arm() {
            return vec![self.sensor.unwrap_or_default()];
        }
        self.joints().map(|(_, joint)| joint.sensor()).collect()
    }

    /// The robot's own limits; without challenge A no limit on the torque.
    #[must_use]
    pub fn limits(&self) -> Limits {
        let of_joints = |&limit: &Limit| Some((limit, self.limit_of_axes(limit)?));
        let mut limits: Limits = Limit::ALL.iter().filter_map(of_joints).collect();
        if !is_posed(self.challenges.gear_load_limit) {
            limits.remove(Limit::Torque);
        }
        limits
    }

    /// A limit of every axis, `None` where no joint has one.
    fn limit_of_axes(&self, limit: Limit) -> Option<Vec<f64>> {
        let of_joints = self.joints().map(|(_, joint)| joint.limit(limit));
        let of_axes: Vec<Option<f64>> = of_joints.collect();
        let is_given = of_axes.iter().any(Option::is_some);
        let value = |of_axis: Option<f64>| of_axis.unwrap_or(limit.unlimited());
        is_given.then(|| of_axes.into_iter().map(value).collect())
    }

    /// The joint to be simulated, if one is described, without the challenges that are switched
    /// off.
    #[must_use]
    pub fn single_joint(&self) -> Option<SingleJoint> {
        let SingleJoint {
            joint,
            link_inertia_kg_m2,
        } = self.single_joint.as_ref()?.single_joint();
        Some(SingleJoint {
            joint: joint.with(self.challenges),
            link_inertia_kg_m2,
        })
    }

    /// The arm to be simulated, if one is described.
    #[must_use]
    pub fn arm(&self) -> Option<Arm> {
        self.is_arm().then(|| Arm {
            bodies: self.body.iter().map(BodyTable::body).collect(),
            payload: self.payload,
            gravity_m_s2: self.gravity_m_s2.unwrap_or(GRAVITY_M_S2),
            pose_rad: self.pose(),
            challenges: self.challenges,
        })
    }
}
