//! What can be wrong in the description of a robot, each with its place, and what is merely
//! suspicious.

use std::collections::BTreeSet;

use frfid_signals::SignalError;

use crate::description::robot::RobotTable;
use crate::description::robot::arm::BodyTable;
use crate::description::text::{ConfigError, Source};

impl RobotTable {
    /// Checks every number; errors point into `source`, in which the robot is the table `[robot]`.
    pub(crate) fn check(&self, source: &Source) -> Result<(), ConfigError> {
        self.check_at(source, &["robot"])
    }

    pub(super) fn check_at(&self, source: &Source, table: &[&str]) -> Result<(), ConfigError> {
        match (&self.single_joint, self.body.is_empty()) {
            (Some(_), true) => self.check_single(source, table),
            (None, false) => self.check_arm(source, table),
            (Some(_), false) => {
                let message = "a single joint and the bodies of an arm are given; keep one of them";
                Err(source.error(&[table, &["single_joint"]].concat(), message))
            }
            (None, true) => Err(source.error(
                table,
                "no robot: `file` or a table [single_joint], [[body]] or [urdf] is needed",
            )),
        }
    }

    fn check_single(&self, source: &Source, table: &[&str]) -> Result<(), ConfigError> {
        let of_arms = [
            ("pose_rad", self.pose_rad.is_some()),
            ("gravity_m_s2", self.gravity_m_s2.is_some()),
            ("payload", self.payload.is_some()),
        ];
        if let Some((key, _)) = of_arms.iter().find(|(_, given)| *given) {
            let message = format!(
                "a single joint has no {key}; leave it out, or describe an arm by [[body]] tables"
            );
            return Err(source.error(&[table, &[key]].concat(), message));
        }
        let located = |sub: &str, error: &SignalError| {
            let key = if let SignalError::Parameter { name, .. } = error {
                name
            } else {
                ""
            };
            source.error(&[table, &[sub, key]].concat(), error.to_string())
        };
        // as described, not as the challenges leave it: a number that is wrong is wrong also while
        // it is switched off
        let joint = self.single_joint.iter().map(super::SingleJointTable::joint);
        joint
            .into_iter()
            .try_for_each(|joint| joint.check())
            .map_err(|error| located("single_joint", &error))?;
        let mut sensors = self.sensor.iter().map(super::SensorTable::sensor);
        sensors
            .try_for_each(|sensor| sensor.check())
            .map_err(|error| located("sensor", &error))
    }

    fn check_arm(&self, source: &Source, table: &[&str]) -> Result<(), ConfigError> {
        let at = |keys: &[&str], message: String| source.error(&[table, keys].concat(), message);
        if self.sensor.is_some() {
            return Err(at(
                &["sensor"],
                "the joints of an arm have sensors of their own: [body.joint.sensor]".into(),
            ));
        }
        let mut names = BTreeSet::new();
        for (index, body) in self.body.iter().enumerate() {
            let place = Place::of(body, index, source, table);
            body.check(source, &place)?;
            if !names.insert(&body.name) {
                let message = format!(
                    "two bodies are called {:?}; needed: a name for each",
                    body.name
                );
                return Err(place.error(source, &["name"], message));
            }
        }
        if self.n_axes() == 0 {
            return Err(at(
                &["body"],
                "no joint moves; at least one body needs a table [body.joint]".into(),
            ));
        }
        self.check_pose()
            .map_err(|message| at(&["pose_rad"], message))?;
        // the whole arm: inertias, axes, and a mass matrix that is positive definite
        self.arm()
            .map_or(Ok(()), |arm| arm.check())
            .map_err(|error| self.located(source, table, &error))
    }

    /// The arm's complaint, put where the value stands in the text.
    fn located(&self, source: &Source, table: &[&str], error: &SignalError) -> ConfigError {
        // a parameter's name begins with its key: "inertia_kg_m2's smallest principal moment"
        let key = |error: &SignalError| match error {
            SignalError::Parameter { name, .. } | SignalError::Shape { name, .. } => {
                name.split('\'').next().unwrap_or("")
            }
            _ => "",
        };
        let SignalError::In {
            part,
            source: cause,
        } = error
        else {
            return source.error(&[table, &[key(error)]].concat(), error.to_string());
        };
        match self
            .body
            .iter()
            .enumerate()
            .find(|(_, body)| *part == format!("body {}", body.name))
        {
            Some((index, body)) => Place::of(body, index, source, table).error(
                source,
                &[key(cause)],
                error.to_string(),
            ),
            None => source.error(&[table, &[part, key(cause)]].concat(), error.to_string()),
        }
    }

    /// The pose has a position for each joint, inside its range.
    fn check_pose(&self) -> Result<(), String> {
        let (pose, n_axes) = (self.pose(), self.n_axes());
        if pose.len() != n_axes {
            return Err(format!(
                "pose_rad has {} entries, needed: one for each of the {n_axes} joints that move",
                pose.len()
            ));
        }
        for ((body, joint), position) in self.joints().zip(pose) {
            let lowest = joint.min_position.unwrap_or(f64::NEG_INFINITY);
            let highest = joint.max_position.unwrap_or(f64::INFINITY);
            if !position.is_finite() || position < lowest || position > highest {
                let name = &body.name;
                return Err(format!(
                    "the pose cannot be reached: joint {name} at {position} rad, needed: {lowest} to {highest} rad"
                ));
            }
        }
        Ok(())
    }
}

/// Where a body and its joint stand in the text.
struct Place {
    body: Vec<String>,
    joint: Vec<String>,
}

impl Place {
    /// In the list of bodies; where those come from URDF, in the tables beside it.
    fn of(body: &BodyTable, index: usize, source: &Source, table: &[&str]) -> Self {
        let path = |keys: &[&str]| {
            [table, keys]
                .concat()
                .into_iter()
                .map(str::to_owned)
                .collect()
        };
        if source.has(&[table, &["urdf"]].concat()) {
            return Self {
                body: path(&["urdf", "file"]),
                joint: path(&["urdf", "joint", &body.name]),
            };
        }
        let index = index.to_string();
        Self {
            body: path(&["body", &index]),
            joint: path(&["body", &index, "joint"]),
        }
    }

    fn error(&self, source: &Source, keys: &[&str], message: String) -> ConfigError {
        let path: Vec<&str> = self
            .body
            .iter()
            .map(String::as_str)
            .chain(keys.iter().copied())
            .collect();
        source.error(&path, message)
    }
}

impl BodyTable {
    fn check(&self, source: &Source, place: &Place) -> Result<(), ConfigError> {
        let at = |keys: &[&str], message: &str| {
            place.error(source, keys, format!("body {}: {message}", self.name))
        };
        if self.name.trim().is_empty() {
            return Err(at(
                &["name"],
                "it has no name; needed: the name of its joint in the logs",
            ));
        }
        match (&self.joint, self.locked_position_rad) {
            (None, None) => Err(at(
                &[],
                "needed: locked_position_rad, or a table [body.joint]",
            )),
            (Some(_), Some(_)) => Err(at(
                &["locked_position_rad"],
                "it is locked and has a joint; keep one of them",
            )),
            (Some(joint), None) => {
                let path: Vec<&str> = place.joint.iter().map(String::as_str).collect();
                joint.check(&self.name, source, &path)
            }
            (None, Some(position)) if !position.is_finite() => Err(at(
                &["locked_position_rad"],
                &format!("it is locked at {position} rad, needed: a finite number"),
            )),
            (None, Some(_)) => Ok(()),
        }
    }
}
