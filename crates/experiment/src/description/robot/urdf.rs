//! URDF: an arm from such a file and a table of its joints. URDF says where the bodies are and what
//! they weigh, the table what drives them.

use std::collections::BTreeMap;
use std::path::Path;

use frfid_plant::Inertia;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use urdf_rs::{Inertial, Joint, JointType, Link};

use crate::description::fault::Fault;
use crate::description::robot::RobotTable;
use crate::description::robot::body::{BodyTable, rotation};
use crate::description::robot::joint::JointTable;
use crate::description::robot::urdf_limits::with_limits;
use crate::description::text::{ConfigError, TomlText};

/// An arm from URDF: the chain of joints from the base link to the tip link. Revolute and
/// continuous joints move and need a table of their name; fixed ones are locked. Limits that a
/// table leaves out are those of URDF.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UrdfTable {
    /// The URDF file, relative to the file that names it; plain URDF, xacro expanded.
    pub file: String,
    /// Link at the base of the chain; the one link that hangs on no joint without it.
    pub base_link: Option<String>,
    /// Link at the tip of the chain; the one link on which nothing hangs without it.
    pub tip_link: Option<String>,
    /// Names of joints whose bodies are simplified: moments of inertia that never move are left
    /// out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub simplified: Vec<String>,
    /// Motor and gear of every joint that moves, by the joint's name: `[urdf.joint.NAME]`.
    #[serde(default)]
    pub joint: BTreeMap<String, JointTable>,
}

impl RobotTable {
    /// Puts the bodies of URDF, if a file is named, in the place of its name; the robot is the
    /// table at `table` of the text.
    pub(super) fn read_urdf(
        &mut self,
        text: &TomlText,
        folder: &Path,
        table: &[&str],
    ) -> Result<(), ConfigError> {
        let Some(urdf) = self.urdf.take() else {
            return Ok(());
        };
        let bodies = if self.is_arm() {
            let message = "URDF and [[body]] tables are given; keep one of them";
            Err(Fault::new(&["file"], message))
        } else {
            urdf.read(folder)
        };
        self.body = bodies.map_err(|fault| text.locate(table, fault.within(&["urdf"])))?;
        self.is_from_urdf = true;
        Ok(())
    }
}

impl UrdfTable {
    /// Reads the file, which is looked up in `folder`.
    fn read(&self, folder: &Path) -> Result<Vec<BodyTable>, Fault> {
        let unread = |error: ConfigError| Fault::new(&["file"], error.to_string());
        self.bodies(&read_robot(&folder.join(&self.file)).map_err(unread)?)
    }

    /// The bodies of the chain, from the base to the tip.
    fn bodies(&self, robot: &urdf_rs::Robot) -> Result<Vec<BodyTable>, Fault> {
        let chain = self.chain(robot)?;
        self.check_names(&chain)?;
        check_nothing_beside(robot, &chain)?;
        let joints = chain.into_iter();
        joints.map(|joint| self.body(robot, joint)).collect()
    }

    /// Refuses tables and entries for joints that the chain does not have.
    fn check_names(&self, chain: &[&Joint]) -> Result<(), Fault> {
        let known: Vec<&str> = chain.iter().map(|joint| joint.name.as_str()).collect();
        let is_unknown = |(_, name): &(_, &String)| !known.contains(&name.as_str());
        let Some((key, name)) = self.named_joints().find(is_unknown) else {
            return Ok(());
        };
        let known = known.join(", ");
        let message = format!("no joint of the chain is called {name}; there are {known}");
        Err(Fault::new(&[key], message))
    }

    /// Joints that the table names, each with the key at which it does.
    fn named_joints(&self) -> impl Iterator<Item = (&'static str, &String)> {
        let joints = self.joint.keys().map(|name| ("joint", name));
        joints.chain(self.simplified.iter().map(|name| ("simplified", name)))
    }

    /// The joints from the base link to the tip link.
    pub(super) fn chain<'a>(&self, robot: &'a urdf_rs::Robot) -> Result<Vec<&'a Joint>, Fault> {
        let (base, tip) = (self.base(robot)?, self.tip(robot)?);
        let (mut chain, mut link) = (Vec::new(), tip);
        while link != base {
            // a chain longer than all joints runs in a circle
            let joint = above(link, robot).filter(|_| chain.len() < robot.joints.len());
            let Some(joint) = joint else {
                let message = format!("no chain of joints leads from {base} to {tip}");
                return Err(Fault::new(&["tip_link"], message));
            };
            chain.push(joint);
            link = &joint.parent.link;
        }
        chain.reverse();
        Ok(chain)
    }

    pub(super) fn base<'a>(&self, robot: &'a urdf_rs::Robot) -> Result<&'a str, Fault> {
        let is_base = |link: &&str| above(link, robot).is_none();
        named("base_link", self.base_link.as_deref(), robot, is_base)
    }

    fn tip<'a>(&self, robot: &'a urdf_rs::Robot) -> Result<&'a str, Fault> {
        let is_tip = |link: &&str| below(link, robot).next().is_none();
        named("tip_link", self.tip_link.as_deref(), robot, is_tip)
    }

    /// The body that a joint of the chain carries.
    fn body(&self, robot: &urdf_rs::Robot, joint: &Joint) -> Result<BodyTable, Fault> {
        let table = self.table_of(joint)?;
        let Inertial {
            origin,
            mass,
            inertia,
        } = inertial_of(joint, robot);
        Ok(BodyTable {
            name: joint.name.clone(),
            offset_m: joint.origin.xyz.0,
            rotation_rpy_rad: joint.origin.rpy.0,
            axis: joint.axis.xyz.0,
            mass_kg: mass.value,
            center_of_mass_m: origin.xyz.0,
            inertia_kg_m2: tensor(&inertia).turned(&rotation(origin.rpy.0)),
            simplified: self.simplified.contains(&joint.name),
            locked_position_rad: table.is_none().then_some(0.0),
            joint: table,
        })
    }

    /// Motor and gear of a joint with the limits of both files; `None` for one that is fixed.
    fn table_of(&self, joint: &Joint) -> Result<Option<JointTable>, Fault> {
        let name = &joint.name;
        if joint.mimic.is_some() {
            let message = format!("joint {name} mimics another; every joint must move on its own");
            return Err(Fault::new(&["file"], message));
        }
        match &joint.joint_type {
            JointType::Fixed => Ok(None),
            JointType::Revolute | JointType::Continuous => self.table_of_moving(joint).map(Some),
            other => {
                let kind = format!("{other:?}").to_lowercase();
                let message = format!(
                    "joint {name} is {kind}; only revolute, continuous and fixed joints can be simulated"
                );
                Err(Fault::new(&["file"], message))
            }
        }
    }

    /// The same of a joint that moves.
    fn table_of_moving(&self, joint: &Joint) -> Result<JointTable, Fault> {
        let name = &joint.name;
        let table = self.joint.get(name).ok_or_else(|| {
            let message = format!(
                "no table urdf.joint.{name}: URDF knows no motor, gear and friction; \
                 frfid init urdf writes a table for every joint, with guesses"
            );
            Fault::new(&["joint"], message)
        })?;
        Ok(with_limits(table, joint))
    }
}

/// Reads a URDF file.
pub(super) fn read_robot(path: &Path) -> Result<urdf_rs::Robot, ConfigError> {
    let xml = TomlText::read(path)?;
    let robot = urdf_rs::read_from_string(&xml.text);
    let robot = robot.map_err(|error| xml.error(&[], format!("not URDF: {error}")))?;
    if robot.links.is_empty() {
        return Err(xml.error(&[], "not URDF: found no link"));
    }
    Ok(robot)
}

/// The joint on which a link hangs.
fn above<'a>(link: &str, robot: &'a urdf_rs::Robot) -> Option<&'a Joint> {
    robot.joints.iter().find(|joint| joint.child.link == link)
}

/// The joints that hang on a link.
fn below<'a>(link: &str, robot: &'a urdf_rs::Robot) -> impl Iterator<Item = &'a Joint> {
    let joints = robot.joints.iter();
    joints.filter(move |joint| joint.parent.link == link)
}

/// What the link weighs that a joint carries.
fn inertial_of(joint: &Joint, robot: &urdf_rs::Robot) -> Inertial {
    let link = robot
        .links
        .iter()
        .find(|link| link.name == joint.child.link);
    link.map(|link| link.inertial.clone()).unwrap_or_default()
}

/// Refuses links with a mass that hang beside the chain: what they weigh would be lost.
fn check_nothing_beside(robot: &urdf_rs::Robot, chain: &[&Joint]) -> Result<(), Fault> {
    let beside = beside(robot, chain);
    let links = robot
        .links
        .iter()
        .filter(|link| beside.contains(&link.name.as_str()));
    let heavy: Vec<String> = links.filter_map(weight_in_words).collect();
    if heavy.is_empty() {
        return Ok(());
    }
    let heavy = heavy.join(", ");
    let message = format!(
        "{heavy} beside the chain to the tip, needed: nothing that weighs; in the URDF give the masses to links of the chain"
    );
    Err(Fault::new(&["tip_link"], message))
}

/// A link and what it weighs; `None` of one without a mass.
fn weight_in_words(link: &Link) -> Option<String> {
    let mass_kg = link.inertial.mass.value;
    (mass_kg != 0.0).then(|| format!("link {} of {mass_kg} kg", link.name))
}

/// Links that hang on the links of the chain, directly or not, without being of it.
fn beside<'a>(robot: &'a urdf_rs::Robot, chain: &[&'a Joint]) -> Vec<&'a str> {
    let child = |joint: &'a Joint| joint.child.link.as_str();
    let mut moved: Vec<&str> = chain.iter().map(|joint| child(joint)).collect();
    let mut next = 0;
    while let Some(&link) = moved.get(next) {
        let hanging = below(link, robot).map(child);
        let new: Vec<&str> = hanging.filter(|child| !moved.contains(child)).collect();
        moved.extend(new);
        next += 1;
    }
    moved.split_off(chain.len())
}

/// The link that is asked for, or the only one that comes into question.
fn named<'a>(
    key: &'static str,
    asked: Option<&str>,
    robot: &'a urdf_rs::Robot,
    is_possible: impl Fn(&&str) -> bool,
) -> Result<&'a str, Fault> {
    let mut links = robot.links.iter().map(|link| link.name.as_str());
    if let Some(asked) = asked {
        let found = links.find(|link| *link == asked);
        return found.ok_or_else(|| Fault::new(&[key], format!("there is no link {asked}")));
    }
    let possible: Vec<&str> = links.filter(is_possible).collect();
    match possible[..] {
        [only] => Ok(only),
        _ => {
            let links = possible.join(", ");
            let message = format!("{key} is needed to choose one of {links}");
            Err(Fault::new(&[key], message))
        }
    }
}

/// The inertia tensor of URDF, in the frame of its own origin.
fn tensor(inertia: &urdf_rs::Inertia) -> Inertia {
    let &urdf_rs::Inertia {
        ixx,
        ixy,
        ixz,
        iyy,
        iyz,
        izz,
    } = inertia;
    Inertia {
        ixx,
        iyy,
        izz,
        ixy,
        ixz,
        iyz,
    }
}
