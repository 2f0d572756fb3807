//! Limits of URDF, beside those of a joint's table.

use urdf_rs::{Joint, JointType};

use crate::description::robot::joint::JointTable;

/// The table with the limits of URDF where it has none. URDF writes 0 for an effort or a velocity
/// that is not known.
pub(super) fn with_limits(table: &JointTable, joint: &Joint) -> JointTable {
    let limit = &joint.limit;
    let [min_position, max_position] = range_rad(joint);
    JointTable {
        min_position: table.min_position.or(min_position),
        max_position: table.max_position.or(max_position),
        max_velocity: table.max_velocity.or(size(limit.velocity)),
        max_acceleration: table.max_acceleration.or(size(limit.acceleration)),
        max_jerk: table.max_jerk.or(size(limit.jerk)),
        max_effort: table.max_effort.or(size(limit.effort)),
        ..table.clone()
    }
}

/// Lowest and highest position; URDF writes an empty range for a joint without one.
pub(super) fn range_rad(joint: &Joint) -> [Option<f64>; 2] {
    let limit = &joint.limit;
    let has_range = joint.joint_type == JointType::Revolute && limit.lower < limit.upper;
    [limit.lower, limit.upper].map(|value| Some(value).filter(|v| has_range && v.is_finite()))
}

/// A size that URDF knows.
pub(super) fn size(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite() && *value > 0.0)
}
