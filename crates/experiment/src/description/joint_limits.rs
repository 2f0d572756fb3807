//! Joint limits of `ros2_control` and `MoveIt`: `joint_limits.yaml`, against the joints of a robot.

use frfid_signals::{Limit, Limits};
use yaml_rust2::yaml::Hash;
use yaml_rust2::{ScanError, Yaml};

use crate::description::misspelt::nearest;
use crate::description::radians::documents;

/// Where a limit stands: the key that says whether it counts, that of its value, and what it
/// bounds. A second row of a limit tightens it.
const ROWS: [(&str, &str, Limit); 9] = [
    ("has_effort_limits", "max_effort", Limit::Torque),
    ("has_velocity_limits", "max_velocity", Limit::Velocity),
    (
        "has_acceleration_limits",
        "max_acceleration",
        Limit::Acceleration,
    ),
    (
        "has_deceleration_limits",
        "max_deceleration",
        Limit::Acceleration,
    ),
    ("has_jerk_limits", "max_jerk", Limit::Jerk),
    ("has_position_limits", "min_position", Limit::LowestPosition),
    (
        "has_position_limits",
        "max_position",
        Limit::HighestPosition,
    ),
    ("has_soft_limits", "soft_lower_limit", Limit::LowestPosition),
    (
        "has_soft_limits",
        "soft_upper_limit",
        Limit::HighestPosition,
    ),
];

const NO_TABLE: &str = "found no table joint_limits, needed: one with an entry for each joint, at the top or within \
                        NODE: ros__parameters:";

/// What such a file says of the joints of a robot.
#[derive(Debug, PartialEq)]
pub(crate) struct JointLimits {
    pub(crate) limits: Limits,
    /// Joints of the robot that the file does not know.
    unlimited: Vec<String>,
}

impl JointLimits {
    /// Reads the text of a file: every table `joint_limits`, at the top as `MoveIt` has it or within
    /// a node's `ros__parameters`. A value counts only where its `has_..` is true; NaN is none.
    pub(crate) fn of_yaml(text: &str, joints: &[String]) -> Result<Self, String> {
        let documents = documents(text).map_err(|error| not_yaml(&error))?;
        let tables = Tables::among(&documents)?;
        let unlimited = tables.missing(joints);
        if !unlimited.is_empty() {
            tables.check_names(joints, &unlimited)?;
        }
        let limits = tables.limits(joints)?;
        Ok(Self { limits, unlimited })
    }

    /// That joints are not in the file; nothing where all are.
    pub(crate) fn unlimited_in_words(&self, file: &str) -> Option<String> {
        let joints = self.unlimited.join(", ");
        let words = format!("{file} has no entry for {joints}: it does not limit them");
        (!joints.is_empty()).then_some(words)
    }
}

fn not_yaml(error: &ScanError) -> String {
    format!("not YAML: {error}")
}

/// The tables `joint_limits` of a file.
struct Tables<'a>(Vec<&'a Hash>);

impl<'a> Tables<'a> {
    fn among(documents: &'a [Yaml]) -> Result<Self, String> {
        let mut tables = Self(Vec::new());
        documents.iter().for_each(|node| tables.gather(node));
        match tables.0.is_empty() {
            true => Err(NO_TABLE.into()),
            false => Ok(tables),
        }
    }

    /// Adds the tables beneath a node.
    fn gather(&mut self, node: &'a Yaml) {
        for (key, value) in node.as_hash().into_iter().flatten() {
            match value {
                Yaml::Hash(table) if key.as_str() == Some("joint_limits") => self.0.push(table),
                value => self.gather(value),
            }
        }
    }

    /// Names of the entries.
    fn names(&self) -> impl Iterator<Item = &'a str> {
        let keys = self.0.iter().flat_map(|table| table.keys());
        keys.filter_map(Yaml::as_str)
    }

    /// Joints of the robot without an entry.
    fn missing(&self, joints: &[String]) -> Vec<String> {
        let is_missing = |joint: &&String| !self.names().any(|name| name == *joint);
        joints.iter().filter(is_missing).cloned().collect()
    }

    /// Refuses an entry of no joint of the robot while one of the robot's is missing: it may be that
    /// one, misspelt. Where none is missing the others are those of a gripper or another arm.
    fn check_names(&self, joints: &[String], missing: &[String]) -> Result<(), String> {
        let is_unknown = |name: &&str| joints.iter().all(|joint| joint != name);
        let Some(unknown) = self.names().find(is_unknown) else {
            return Ok(());
        };
        let meant = meant(unknown, missing);
        let joints = joints.join(", ");
        Err(format!(
            "found limits of {unknown}, a joint that the robot does not have; it has {joints}{meant}"
        ))
    }

    /// The limits, a number for each joint of the robot; of several entries of a joint the tighter.
    fn limits(&self, joints: &[String]) -> Result<Limits, String> {
        let mut limits = Limits::default();
        for (axis, joint) in joints.iter().enumerate() {
            for found in self.0.iter().filter_map(|table| entry(table, joint)) {
                let found = of_joint(found).map_err(|what| format!("joint {joint}: {what}"))?;
                for (limit, value) in found {
                    limits = limits.tighter(&on_axis(limit, value, axis, joints.len()));
                }
            }
        }
        Ok(limits)
    }
}

/// The question whether a known joint was meant.
fn meant(unknown: &str, known: &[String]) -> String {
    let nearest = nearest(unknown, known.iter().map(String::as_str));
    nearest.map_or(String::new(), |joint| format!("; did you mean {joint}?"))
}

/// A limit of one axis, the others without.
fn on_axis(limit: Limit, value: f64, axis: usize, n_axes: usize) -> Limits {
    let mut of_axes = vec![limit.unlimited(); n_axes];
    of_axes[axis] = value;
    Limits::from_iter([(limit, of_axes)])
}

/// An entry of a table.
fn entry<'a>(table: &'a Hash, key: &str) -> Option<&'a Yaml> {
    table.get(&Yaml::String(key.to_owned()))
}

/// The limits of a joint that count.
fn of_joint(joint: &Yaml) -> Result<Vec<(Limit, f64)>, String> {
    let mut limits = Vec::new();
    let Some(joint) = joint.as_hash() else {
        return Ok(limits);
    };
    for (has, key, limit) in ROWS {
        if counts(joint, has)? {
            limits.extend(value(joint, key, limit)?.map(|value| (limit, value)));
        }
    }
    Ok(limits)
}

/// The value of a limit; none where it is not set.
fn value(joint: &Hash, key: &str, limit: Limit) -> Result<Option<f64>, String> {
    let Some(value) = entry(joint, key) else {
        return Ok(None);
    };
    let value = number(key, value)?;
    if limit.is_size() && value <= 0.0 {
        return Err(format!("{key} is {value}, needed: a number above 0"));
    }
    Ok((!value.is_nan()).then_some(value))
}

/// Whether the key is there and says yes.
fn counts(joint: &Hash, has: &str) -> Result<bool, String> {
    entry(joint, has).map_or(Ok(false), |value| is_true(has, value))
}

/// Whether a value says yes, in the words of YAML 1.1, which ROS reads.
fn is_true(key: &str, value: &Yaml) -> Result<bool, String> {
    let word = value.as_str().map(str::to_lowercase);
    let of_word = word.and_then(|word| match word.as_str() {
        "true" | "yes" | "on" | "y" => Some(true),
        "false" | "no" | "off" | "n" => Some(false),
        _ => None,
    });
    let found = in_words(value);
    let answer = value.as_bool().or(of_word);
    answer.ok_or_else(|| format!("{key} is {found}, needed: true or false"))
}

/// A number, whole or not.
fn number(key: &str, value: &Yaml) -> Result<f64, String> {
    let found = in_words(value);
    let number = value.as_f64().or(value.as_i64().map(|whole| whole as f64));
    number.ok_or_else(|| format!("{key} is {found}, needed: a number"))
}

/// A value as it is told.
fn in_words(value: &Yaml) -> String {
    match value {
        Yaml::String(text) | Yaml::Real(text) => format!("`{text}`"),
        Yaml::Integer(number) => number.to_string(),
        Yaml::Boolean(value) => value.to_string(),
        Yaml::Array(_) => "a list".to_owned(),
        Yaml::Hash(_) => "a table".to_owned(),
        Yaml::Null | Yaml::Alias(_) | Yaml::BadValue => "empty".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, joints: &[&str]) -> Result<JointLimits, String> {
        let joints: Vec<String> = joints.iter().map(|&joint| joint.to_owned()).collect();
        JointLimits::of_yaml(text, &joints)
    }

    const OF_A_NODE: &str = "\
/**:
  ros__parameters:
    joint_limits:
      a:
        has_position_limits: true
        min_position: -2.9
        max_position: 2.9
        has_velocity_limits: yes
        max_velocity: 2
        has_acceleration_limits: true
        max_acceleration: 5.0
        has_deceleration_limits: true
        max_deceleration: 4.5
        has_jerk_limits: false
        max_jerk: fast
        has_effort_limits: true
        max_effort: .nan
        has_soft_limits: true
        soft_lower_limit: -2.8
        soft_upper_limit: 3.0
      b: {has_velocity_limits: true, max_velocity: 1.0e-1, max_jerk: 3.0}
";

    #[test]
    fn what_counts_is_read_and_the_tighter_of_two_binds() {
        let inf = f64::INFINITY;
        let needed = [
            (Limit::Velocity, vec![2.0, 0.1]),
            (Limit::Acceleration, vec![4.5, inf]),
            (Limit::LowestPosition, vec![-2.8, -inf]),
            (Limit::HighestPosition, vec![2.9, inf]),
        ];
        let read = read(OF_A_NODE, &["a", "b"]).expect("sound");
        assert_eq!(read.limits, Limits::from_iter(needed));
        assert_eq!(read.unlimited_in_words("x.yaml"), None);
    }

    /// The form of MoveIt, with an entry of the gripper, and the degrees of ur_description.
    #[test]
    fn a_table_at_the_top_is_read_with_degrees_and_joints_of_others() {
        let text = "default_velocity_scaling_factor: 0.1\njoint_limits:\n  finger: {}\n  a:\n    \
                    has_velocity_limits: true\n    max_velocity: !degrees  180.0\n";
        let found = read(text, &["a"]).expect("sound");
        let needed = [(Limit::Velocity, vec![std::f64::consts::PI])];
        assert_eq!(found.limits, Limits::from_iter(needed));
        let found = read("joint_limits: {a: {}}", &["a", "b"]).expect("sound");
        let said = found.unlimited_in_words("x.yaml").expect("b");
        assert_eq!(said, "x.yaml has no entry for b: it does not limit them");
    }

    #[test]
    fn what_is_wrong_is_said_in_the_words_of_the_file() {
        let of_joint = |keys: &str| format!("joint_limits: {{elbow: {{{keys}}}}}");
        for (text, needed) in [
            (
                of_joint("has_jerk_limits: true, max_jerk: fast"),
                "joint elbow: max_jerk is `fast`, needed: a number",
            ),
            (
                of_joint("has_jerk_limits: true, max_jerk: -1"),
                "joint elbow: max_jerk is -1, needed: a number above 0",
            ),
            (
                of_joint("has_jerk_limits: 1.5, max_jerk: 1"),
                "joint elbow: has_jerk_limits is `1.5`, needed: true or false",
            ),
            (
                "joint_limits: {elbwo: {}}".into(),
                "it has elbow; did you mean elbow?",
            ),
            (
                "joint_limits: {shoulder: {}}".into(),
                "found limits of shoulder, a joint that the robot does not have; it has elbow",
            ),
            ("joints: {elbow: {}}".into(), "found no table joint_limits"),
            ("a: [".into(), "not YAML: "),
            ("a: 1\na: 2".into(), "not YAML: "),
            (String::new(), "found no table joint_limits"),
        ] {
            let found = read(&text, &["elbow"]).expect_err(&text);
            assert!(found.contains(needed), "{text}: {found}");
        }
    }
}
