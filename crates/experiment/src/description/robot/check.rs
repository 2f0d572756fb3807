//! Checks of a robot's description: each fault with its place in the tables.

use std::collections::BTreeSet;
use std::iter::zip;

use frfid_plant::Robot as _;
use frfid_signals::SignalError;

use crate::description::fault::{Fault, check_entries};
use crate::description::robot::RobotTable;
use crate::description::robot::body::BodyTable;
use crate::description::robot::joint::{JointTable, SingleJointTable};

/// No machine is described.
pub(super) fn no_robot() -> Fault {
    let needed = "no robot: `file` or a table [single_joint], [[body]] or [urdf] is needed";
    Fault::new(&[], needed)
}

impl RobotTable {
    /// Checks every number and name.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        match (&self.single_joint, self.is_arm()) {
            (Some(joint), false) => self.check_single(joint),
            (None, true) => self.check_arm(),
            (Some(_), true) => Err(Fault::new(
                &["single_joint"],
                "a single joint and the bodies of an arm are given; keep one of them",
            )),
            (None, false) => Err(no_robot()),
        }
    }

    /// As described, not as the challenges leave it: a number that is wrong is wrong also while it
    /// is switched off.
    fn check_single(&self, table: &SingleJointTable) -> Result<(), Fault> {
        self.check_nothing_of_arms()?;
        let checked = table.single_joint().check();
        checked.map_err(Fault::in_table("single_joint"))?;
        let checked = self.sensor.map_or(Ok(()), |sensor| sensor.check());
        checked.map_err(Fault::in_table("sensor"))
    }

    /// Refuses what only an arm has.
    fn check_nothing_of_arms(&self) -> Result<(), Fault> {
        let of_arms = [
            ("pose_rad", self.pose_rad.is_some()),
            ("gravity_m_s2", self.gravity_m_s2.is_some()),
            ("payload", self.payload.is_some()),
        ];
        if let Some((key, _)) = of_arms.iter().find(|(_, given)| *given) {
            let message = format!(
                "a single joint has no {key}; leave it out, or describe an arm by [[body]] tables"
            );
            return Err(Fault::new(&[key], message));
        }
        Ok(())
    }

    fn check_arm(&self) -> Result<(), Fault> {
        if self.sensor.is_some() {
            let message = "the joints of an arm have sensors of their own: [body.joint.sensor]";
            return Err(Fault::new(&["sensor"], message));
        }
        self.check_bodies()?;
        if self.n_axes() == 0 {
            let message = "no joint moves; at least one body needs a table [body.joint]";
            return Err(Fault::new(&["body"], message));
        }
        self.check_pose()?;
        // the whole arm: inertias, axes, and a mass matrix that is positive definite
        let checked = self.arm().map_or(Ok(()), |arm| arm.check());
        checked.map_err(|error| self.of_arm(&error))
    }

    /// Checks every body by itself, and that no two have the same name.
    fn check_bodies(&self) -> Result<(), Fault> {
        let mut names = BTreeSet::new();
        for (index, body) in self.body.iter().enumerate() {
            body.check().map_err(|fault| self.of_body(index, fault))?;
            if !names.insert(&body.name) {
                let name = &body.name;
                let message = format!("two bodies are called {name:?}; needed: a name for each");
                return Err(self.of_body(index, Fault::new(&["name"], message)));
            }
        }
        Ok(())
    }

    /// The arm's complaint, where the value stands: the arm counts its bodies, and so does the
    /// list of tables.
    fn of_arm(&self, error: &SignalError) -> Fault {
        let path = error.path();
        let fault = |path: &[&str]| Fault::new(path, error.to_string());
        if let ["body", index, of_body @ ..] = &path[..]
            && let Ok(index) = index.parse()
        {
            return self.of_body(index, fault(of_body));
        }
        fault(&path)
    }

    /// The fault of a body, where it stands: in the list of bodies or, where those come from URDF,
    /// in the file's name and the tables of joints beside it.
    fn of_body(&self, index: usize, fault: Fault) -> Fault {
        if !self.is_from_urdf {
            return fault.within(&["body", &index.to_string()]);
        }
        match fault.inside("joint") {
            Ok(of_joint) => of_joint.within(&["urdf", "joint", &self.body[index].name]),
            Err(of_body) => of_body.at(&["urdf", "file"]),
        }
    }

    /// The pose has a position for each joint, inside its range.
    fn check_pose(&self) -> Result<(), Fault> {
        let pose = self.pose();
        check_entries("pose_rad", pose.len(), self.n_axes(), "joints that move")
            .and_then(|()| zip(self.joints(), pose).try_for_each(check_reach))
            .map_err(|message| Fault::new(&["pose_rad"], message))
    }
}

/// Refuses a position that a joint cannot reach.
fn check_reach(((body, joint), position): ((&BodyTable, &JointTable), f64)) -> Result<(), String> {
    let (lowest, highest) = joint.range_rad();
    if position.is_finite() && lowest <= position && position <= highest {
        return Ok(());
    }
    let name = &body.name;
    Err(format!(
        "the pose cannot be reached: pose_rad puts joint {name} at {position} rad, needed: \
         {lowest} to {highest} rad"
    ))
}

impl BodyTable {
    fn check(&self) -> Result<(), Fault> {
        if self.name.trim().is_empty() {
            let message = "it has no name; needed: the name of its joint in the logs";
            return Err(self.fault(&["name"], message));
        }
        self.check_joint()
    }

    /// Checks the joint, or that the body is locked somewhere.
    fn check_joint(&self) -> Result<(), Fault> {
        let locked = &["locked_position_rad"];
        match (&self.joint, self.locked_position_rad) {
            (None, None) => {
                Err(self.fault(&[], "needed: locked_position_rad, or a table [body.joint]"))
            }
            (Some(_), Some(_)) => {
                Err(self.fault(locked, "it is locked and has a joint; keep one of them"))
            }
            (Some(joint), None) => joint
                .check()
                .map_err(|fault| fault.of(&format!("joint {}", self.name)).within(&["joint"])),
            (None, Some(position)) if !position.is_finite() => {
                let message = format!("it is locked at {position} rad, needed: a finite number");
                Err(self.fault(locked, &message))
            }
            (None, Some(_)) => Ok(()),
        }
    }

    fn fault(&self, keys: &[&str], message: &str) -> Fault {
        Fault::new(keys, format!("body {}: {message}", self.name))
    }
}
