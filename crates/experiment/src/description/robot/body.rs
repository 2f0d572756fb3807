//! Body of an arm and the joint that carries it: the table `[[body]]`.

use frfid_plant::{Body, BodyJoint, Inertia};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::robot::joint::JointTable;

/// A rigid body and the joint that carries it. Either `locked_position_rad` or a table
/// `[body.joint]` is needed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyTable {
    /// Name of the body, and of its joint in the logs.
    pub name: String,
    /// Origin of the joint in the frame of the body before it, of the base for the first, in m.
    #[serde(default)]
    pub offset_m: [f64; 3],
    /// Orientation of the joint's frame in that frame at position 0: turned about the fixed x, y
    /// and z axes by these angles in rad, one after the other, as `rpy` of URDF.
    #[serde(default)]
    pub rotation_rpy_rad: [f64; 3],
    /// Axis of the joint in its own frame, of any length but 0.
    pub axis: [f64; 3],
    /// Mass in kg.
    pub mass_kg: f64,
    /// Centre of mass in m in the body's frame: that of the joint, turned with it.
    #[serde(default)]
    pub center_of_mass_m: [f64; 3],
    /// Inertia in kg m^2 about the centre of mass in the body's frame.
    #[serde(default)]
    pub inertia_kg_m2: Inertia,
    /// Moments of inertia that never move are left out: principal moments need not obey the
    /// triangle inequality.
    #[serde(default)]
    pub simplified: bool,
    /// The joint does not move: its position in rad.
    pub locked_position_rad: Option<f64>,
    /// The joint moves: its motor and gear.
    pub joint: Option<JointTable>,
}

impl BodyTable {
    /// The body; at position 0 where neither a joint nor a position is given, which is refused
    /// before.
    #[must_use]
    pub fn body(&self) -> Body {
        let locked = BodyJoint::Locked {
            position_rad: self.locked_position_rad.unwrap_or_default(),
        };
        Body {
            name: self.name.clone(),
            offset_m: self.offset_m,
            rotation: rotation(self.rotation_rpy_rad),
            axis: self.axis,
            mass_kg: self.mass_kg,
            center_of_mass_m: self.center_of_mass_m,
            inertia_kg_m2: self.inertia_kg_m2,
            simplified: self.simplified,
            joint: self
                .joint
                .as_ref()
                .map_or(locked, |joint| BodyJoint::Flexible(joint.joint())),
        }
    }
}

/// The matrix R = Rz(yaw) Ry(pitch) Rx(roll), row by row: R times a vector of the turned frame is
/// the vector in the fixed one.
#[must_use]
pub(crate) fn rotation([roll, pitch, yaw]: [f64; 3]) -> [[f64; 3]; 3] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn angles_turn_about_fixed_axes_one_after_the_other() {
        // roll by 90 deg takes z to -y, pitch takes x to -z, yaw takes x to y: the columns are the
        // turned axes
        let column = |angles, axis: usize| rotation(angles).map(|row| row[axis].round());
        assert_eq!(column([FRAC_PI_2, 0.0, 0.0], 2), [0.0, -1.0, 0.0]);
        assert_eq!(column([0.0, FRAC_PI_2, 0.0], 0), [0.0, 0.0, -1.0]);
        assert_eq!(column([0.0, 0.0, FRAC_PI_2], 0), [0.0, 1.0, 0.0]);
        // first roll, then yaw, about the fixed axes: y goes to z by the roll and stays there
        assert_eq!(column([FRAC_PI_2, 0.0, FRAC_PI_2], 1), [0.0, 0.0, 1.0]);
    }
}
