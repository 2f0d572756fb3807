//! Known message types of robots, for bags that hold no definitions: every variant of a name, the newest first.
//!
//! Fields and their order as the packages define them: `sensor_msgs`, `std_msgs`, `trajectory_msgs`, and
//! `control_msgs` from 2.x to 6.x, whose `JointTrajectoryControllerState` changed without another name.

/// The lines of a field's point for each of these names.
macro_rules! points {
    ($type:literal: $($name:literal)*) => { concat!($($type, " ", $name, "\n"),*) };
}

const HEADER: &str = "std_msgs/Header header\n";
const POINT: &str = "trajectory_msgs/JointTrajectoryPoint";

/// Types that others are made of.
const PARTS: [(&str, &str); 13] = [
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
    (
        "std_msgs/Header",
        "builtin_interfaces/Time stamp\nstring frame_id\n",
    ),
    (
        "std_msgs/MultiArrayDimension",
        "string label\nuint32 size\nuint32 stride\n",
    ),
    (
        "std_msgs/MultiArrayLayout",
        "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n",
    ),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    (
        "geometry_msgs/Quaternion",
        "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    ),
    (
        "geometry_msgs/Transform",
        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
    ),
    (
        "geometry_msgs/Twist",
        "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    ),
    (
        POINT,
        "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\nbuiltin_interfaces/Duration time_from_start\n",
    ),
    (
        "trajectory_msgs/MultiDOFJointTrajectoryPoint",
        "geometry_msgs/Transform[] transforms\ngeometry_msgs/Twist[] velocities\ngeometry_msgs/Twist[] accelerations\n\
         builtin_interfaces/Duration time_from_start\n",
    ),
    (
        "control_msgs/InterfaceValue",
        "string[] interface_names\nfloat64[] values\n",
    ),
    (
        "control_msgs/SingleDOFState",
        "string name\nfloat64 reference\nfloat64 feedback\nfloat64 feedback_dot\nfloat64 error\nfloat64 error_dot\nfloat64 time_step\n\
         float64 output\n",
    ),
];

const STATE_NOW: &str =
    points!("trajectory_msgs/JointTrajectoryPoint": "reference" "feedback" "error" "output");
const STATE_BOTH: &str = points!("trajectory_msgs/JointTrajectoryPoint": "reference" "feedback" "error" "output" "desired" "actual");
const STATE_OLD: &str = points!("trajectory_msgs/JointTrajectoryPoint": "desired" "actual" "error");
const DOF_NOW: &str = points!("trajectory_msgs/MultiDOFJointTrajectoryPoint": "multi_dof_reference" "multi_dof_feedback" "multi_dof_error" "multi_dof_output");
const DOF_BOTH: &str = points!("trajectory_msgs/MultiDOFJointTrajectoryPoint": "multi_dof_reference" "multi_dof_feedback" "multi_dof_error" "multi_dof_output" "multi_dof_desired" "multi_dof_actual");
const DOF_OLD: &str = points!("trajectory_msgs/MultiDOFJointTrajectoryPoint": "multi_dof_desired" "multi_dof_actual" "multi_dof_error");
const NAMES: &str = "string[] joint_names\n";
const DOF_NAMES: &str = "string[] multi_dof_joint_names\n";

/// Fields of a message, in pieces.
type Pieces = &'static [&'static str];

/// The variants of every type by its name.
const TYPES: [(&str, &[Pieces]); 7] = [
    (
        "sensor_msgs/msg/JointState",
        &[&[
            HEADER,
            "string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
        ]],
    ),
    (
        "control_msgs/msg/JointTrajectoryControllerState",
        &[
            &[
                HEADER,
                NAMES,
                STATE_NOW,
                DOF_NAMES,
                DOF_NOW,
                "float64 speed_scaling_factor\n",
            ],
            &[HEADER, NAMES, STATE_NOW, DOF_NAMES, DOF_NOW],
            &[HEADER, NAMES, STATE_BOTH, DOF_NAMES, DOF_BOTH],
            &[HEADER, NAMES, STATE_OLD, DOF_NAMES, DOF_OLD],
            &[HEADER, NAMES, STATE_OLD],
        ],
    ),
    (
        "control_msgs/msg/DynamicJointState",
        &[&[
            HEADER,
            NAMES,
            "control_msgs/InterfaceValue[] interface_values\n",
        ]],
    ),
    (
        "control_msgs/msg/MultiDOFStateStamped",
        &[&[HEADER, "control_msgs/SingleDOFState[] dof_states\n"]],
    ),
    (
        "std_msgs/msg/Float64MultiArray",
        &[&["std_msgs/MultiArrayLayout layout\nfloat64[] data\n"]],
    ),
    ("std_msgs/msg/Float64", &[&["float64 data\n"]]),
    (
        "trajectory_msgs/msg/JointTrajectory",
        &[&[
            HEADER,
            NAMES,
            "trajectory_msgs/JointTrajectoryPoint[] points\n",
        ]],
    ),
];

/// The definitions that a type of this name may have, with all parts; empty for another type.
pub(crate) fn definitions_of(name: &str) -> Vec<String> {
    let parts = PARTS.map(|(name, fields)| format!("================\nMSG: {name}\n{fields}"));
    let known = TYPES.iter().find(|(known, _)| *known == name);
    let variants = known.map_or(&[][..], |(_, variants)| variants).iter();
    variants
        .map(|pieces| pieces.concat() + &parts.concat())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::definition::parse;

    #[test]
    fn every_definition_is_one() {
        for (name, _) in TYPES {
            let texts = definitions_of(name);
            assert!(!texts.is_empty(), "{name}");
            for text in texts {
                parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
            }
        }
        assert!(definitions_of("x/msg/Y").is_empty());
    }
}
