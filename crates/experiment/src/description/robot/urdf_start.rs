//! Starting description of an arm from URDF: its joints, and marked guesses of what URDF does not say.

use std::cmp::Reverse;
use std::path::Path;

use frfid_signals::format::{count, significant};
use toml::Value;
use urdf_rs::{Joint, JointType, Link};

use crate::description::fault::Fault;
use crate::description::robot::urdf::{UrdfTable, read_robot};
use crate::description::robot::urdf_limits::{range_rad, size};
use crate::description::text::ConfigError;

/// Taken where URDF states no effort, in N m.
const EFFORT_NM: f64 = 100.0;
/// Room to either side of the pose that runs need, in rad.
const ROOM_RAD: f64 = 0.1;

/// What drives usually are, as shares of their largest torque: key, share, what that means.
const GUESSES: [(&str, f64, &str); 5] = [
    (
        "motor_inertia_kg_m2",
        0.01,
        "the motor alone would reach 100 rad/s^2",
    ),
    (
        "stiffness_nm_per_rad",
        1.0 / 0.003,
        "the gear would yield by 3 mrad",
    ),
    ("damping_nms_per_rad", 0.1, "of the gear"),
    ("coulomb_nm", 0.05, "5 % of the torque"),
    ("viscous_nms_per_rad", 0.01, "1 % of the torque at 1 rad/s"),
];

/// Numbers that are the same for every joint.
const ALIKE: [(&str, &str); 3] = [
    ("[POSITION]", "5.0"),
    ("[TRAVEL]", "0.135"),
    ("[LIMIT]", "0.0698"),
];

/// What stands above the robot.
const HEAD: &str = "\
# NAME: N_JOINTS that move. Bodies and limits are those of the URDF.
# GUESSED, as a URDF says nothing of it: motors, gears and friction, each from the largest torque of its joint,
# the pose, controller and excitation. Put in what is known of the robot; what is left decides how far to trust
# predictions, not what is measured.

seed = 1
sample_time_s = 0.001

[robot]
pose_rad = [POSE] # guessed: where the arm is measured

[robot.urdf]
";

/// The experiment that follows the robot; lists in it have a name in the place of their numbers.
const EXPERIMENT: &str = include_str!("urdf_start.toml");

/// A description to start from, of the arm in a URDF file: the chain with most moving joints, or
/// that between the links that are named. What a URDF does not say is guessed and marked; `file`
/// is what the description calls the URDF, as seen from where it will stand.
///
/// # Errors
/// [`ConfigError`]: the file cannot be read or is no URDF, or has no chain of joints that turn.
pub fn description_of_urdf(
    path: &Path,
    file: &str,
    base_link: Option<&str>,
    tip_link: Option<&str>,
) -> Result<String, ConfigError> {
    let table = UrdfTable {
        file: file.to_owned(),
        base_link: base_link.map(str::to_owned),
        tip_link: tip_link.map(str::to_owned),
        ..UrdfTable::default()
    };
    let text = text(table, &read_robot(path)?);
    text.map_err(|fault| fault.without_text(&path.display().to_string()))
}

/// The text of the description.
fn text(mut table: UrdfTable, robot: &urdf_rs::Robot) -> Result<String, Fault> {
    if table.tip_link.is_none() {
        table.tip_link = Some(farthest(&table, robot)?);
    }
    let joints = moving(&table.chain(robot)?)?;
    let tables: String = joints.iter().map(|joint| table_of(joint)).collect();
    Ok(head(&table, &robot.name, &joints) + &tables + &experiment(&joints))
}

/// The joints of a chain that move.
fn moving<'a>(chain: &[&'a Joint]) -> Result<Vec<&'a Joint>, Fault> {
    let moving = chain.iter().copied().filter(|joint| is_moving(joint));
    let moving: Vec<&Joint> = moving.collect();
    if moving.is_empty() {
        return Err(no_chain());
    }
    Ok(moving)
}

fn no_chain() -> Fault {
    let needed = "found no chain of joints that turn, needed: revolute, continuous and fixed joints from a base to a tip";
    Fault::new(&[], needed)
}

/// The link to which most moving joints lead, of several the first of those farthest out.
fn farthest(table: &UrdfTable, robot: &urdf_rs::Robot) -> Result<String, Fault> {
    table.base(robot)?;
    let reach = |link: &&Link| Reverse(reach(table, robot, &link.name));
    let farthest = robot.links.iter().min_by_key(reach).ok_or_else(no_chain)?;
    Ok(farthest.name.clone())
}

/// How many joints lead to a link, those that move first; `None`, which is least, where no chain
/// that can be simulated does.
fn reach(table: &UrdfTable, robot: &urdf_rs::Robot, link: &str) -> Option<(usize, usize)> {
    let mut table = table.clone();
    table.tip_link = Some(link.to_owned());
    let chain = table.chain(robot).ok()?;
    let moving = chain.iter().filter(|joint| is_moving(joint)).count();
    let is_sound = chain.iter().all(|joint| is_simulated(joint));
    is_sound.then_some((moving, chain.len()))
}

fn is_moving(joint: &Joint) -> bool {
    matches!(
        joint.joint_type,
        JointType::Revolute | JointType::Continuous
    )
}

fn is_simulated(joint: &Joint) -> bool {
    joint.mimic.is_none() && (is_moving(joint) || joint.joint_type == JointType::Fixed)
}

/// What is guessed, and the tables `[robot]` and `[robot.urdf]`.
fn head(table: &UrdfTable, name: &str, joints: &[&Joint]) -> String {
    let name = name.replace(char::is_control, " ");
    let pose = of_joints(joints, |joint| significant(pose_rad(joint), 4));
    HEAD.replace("N_JOINTS", &count(joints.len(), "joint"))
        .replace("NAME", &name)
        .replace("[POSE]", &pose)
        + &links(table)
}

/// The file and the ends of the chain.
fn links(table: &UrdfTable) -> String {
    line("file", Some(&table.file))
        + &line("base_link", table.base_link.as_ref())
        + &line("tip_link", table.tip_link.as_ref())
}

/// A key with its text, nothing without one.
fn line(key: &str, text: Option<&String>) -> String {
    text.map_or(String::new(), |text| format!("{key} = {}\n", quoted(text)))
}

/// A text of TOML.
fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

/// A list with a value for each joint.
fn of_joints(joints: &[&Joint], value: impl Fn(&Joint) -> String) -> String {
    let values: Vec<String> = joints.iter().map(|joint| value(joint)).collect();
    format!("[{}]", values.join(", "))
}

/// Position 0 where the joint has room about it, else the middle of its range.
fn pose_rad(joint: &Joint) -> f64 {
    match range_rad(joint) {
        [Some(low), Some(high)] if low > -ROOM_RAD || high < ROOM_RAD => 0.5 * (low + high),
        _ => 0.0,
    }
}

/// The torque from which everything is guessed.
fn effort_nm(joint: &Joint) -> f64 {
    size(joint.limit.effort).unwrap_or(EFFORT_NM)
}

/// The table of a joint.
fn table_of(joint: &Joint) -> String {
    let (name, limits) = (key(&joint.name), limits_in_words(joint));
    let guesses = GUESSES
        .map(|guess| guessed(guess, effort_nm(joint)))
        .concat();
    format!(
        "\n[robot.urdf.joint.{name}] # {limits}\n\
         gear_ratio = 100.0 # guessed; only what is counted in turns of the motor needs it\n{guesses}"
    )
}

/// A guess in a line.
fn guessed((key, share, meaning): (&str, f64, &str), effort_nm: f64) -> String {
    let value = significant(share * effort_nm, 3);
    format!("{key} = {value} # guessed: {meaning}\n")
}

/// A key of TOML, in quotes where it needs them.
fn key(name: &str) -> String {
    let is_bare = |letter: char| letter.is_ascii_alphanumeric() || "_-".contains(letter);
    if !name.is_empty() && name.chars().all(is_bare) {
        name.to_owned()
    } else {
        quoted(name)
    }
}

/// The limits of a joint, and whether they say its torque.
fn limits_in_words(joint: &Joint) -> String {
    let limit = &joint.limit;
    let velocity = size(limit.velocity).map(|velocity| format!("{velocity} rad/s"));
    let effort = size(limit.effort).map(|effort| format!("{effort} N m"));
    let unknown = format!("no torque, {EFFORT_NM} N m are taken");
    let known = [
        range_in_words(joint),
        velocity,
        Some(effort.unwrap_or(unknown)),
    ];
    known.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn range_in_words(joint: &Joint) -> Option<String> {
    let [low, high] = range_rad(joint).map(|end| end.map(|end| significant(end, 4)));
    Some(format!("{} to {} rad", low?, high?))
}

/// Controller, excitation and limits.
fn experiment(joints: &[&Joint]) -> String {
    let gain = |per_s: f64| of_joints(joints, |joint| significant(per_s * effort_nm(joint), 3));
    let text = EXPERIMENT.replace("[INTEGRAL]", &gain(8.0));
    let text = text.replace("[GAIN]", &gain(1.0));
    let all = |text: String, (name, value): (&str, &str)| {
        text.replace(name, &of_joints(joints, |_| value.to_owned()))
    };
    ALIKE.into_iter().fold(text, all)
}
