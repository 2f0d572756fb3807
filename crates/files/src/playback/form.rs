//! Form of a table: separator, decimal mark, unit of angles, side of the gear.

use std::f64::consts::{PI, TAU};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::FileError;

/// How a table is written; by default commas, points, rad, on the joint side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableForm {
    /// Between two columns of a CSV.
    pub separator: Separator,
    /// Before the decimals in a CSV.
    pub decimal: DecimalMark,
    /// Unit of positions, which says those of velocities and accelerations.
    pub angle: AngleUnit,
    /// Turns of the motor for a turn of the joint, of either sign, one for each joint: the table is then on the
    /// motor side. Empty: on the joint side.
    pub gear_ratio: Vec<f64>,
}

/// What stands between two columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Separator {
    /// A comma.
    #[default]
    Comma,
    /// A semicolon, as programs of countries with a decimal comma want it.
    Semicolon,
    /// A tab.
    Tab,
}

/// What stands before the decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DecimalMark {
    /// A point.
    #[default]
    Point,
    /// A comma; the separator must then be another.
    Comma,
}

/// Unit of angles in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AngleUnit {
    /// Positions in rad, velocities in rad/s.
    #[default]
    Rad,
    /// Positions in deg, velocities in deg/s.
    Deg,
    /// Positions in turns, velocities in turn/s.
    Turn,
    /// Positions in turns, velocities in rpm, accelerations in rpm/s.
    Rpm,
}

impl TableForm {
    /// Checks the gear ratios, for so many joints, and that commas are not both marks.
    ///
    /// # Errors
    /// [`FileError::Shape`] with what does not fit.
    pub fn check(&self, n_joints: usize) -> Result<(), FileError> {
        if (self.separator, self.decimal) == (Separator::Comma, DecimalMark::Comma) {
            let needed = "another separator beside a decimal comma: a semicolon or a tab";
            return Err(FileError::shape("separator", "a comma", needed));
        }
        self.check_ratios(n_joints)
    }

    fn check_ratios(&self, n_joints: usize) -> Result<(), FileError> {
        let ratios = &self.gear_ratio;
        let mut all = ratios.iter();
        let are_ratios = all.all(|ratio| ratio.is_finite() && *ratio != 0.0);
        if are_ratios && [0, n_joints].contains(&ratios.len()) {
            return Ok(());
        }
        let needed = format!("one number for each of {n_joints} joints, of either sign, none 0");
        Err(FileError::shape(
            "gear_ratio",
            format!("{ratios:?}"),
            needed,
        ))
    }

    /// The gear ratio of a joint; 1 on the joint side.
    pub(crate) fn ratio(&self, joint: usize) -> f64 {
        self.gear_ratio.get(joint).copied().unwrap_or(1.0)
    }

    /// What stands before the name of a quantity.
    pub(crate) fn side(&self) -> &'static str {
        if self.gear_ratio.is_empty() {
            ""
        } else {
            "motor "
        }
    }
}

impl Separator {
    pub(crate) fn mark(self) -> char {
        match self {
            Self::Comma => ',',
            Self::Semicolon => ';',
            Self::Tab => '\t',
        }
    }
}

impl AngleUnit {
    /// Position, velocity and acceleration: the unit of each, and how many of it are 1 in rad and s.
    pub(crate) fn units(self) -> [(&'static str, f64); 3] {
        let (names, angle, rate) = match self {
            Self::Rad => (["rad", "rad/s", "rad/s^2"], 1.0, 1.0),
            Self::Deg => (["deg", "deg/s", "deg/s^2"], 180.0 / PI, 180.0 / PI),
            Self::Turn => (["turn", "turn/s", "turn/s^2"], 1.0 / TAU, 1.0 / TAU),
            Self::Rpm => (["turn", "rpm", "rpm/s"], 1.0 / TAU, 60.0 / TAU),
        };
        let [position, velocity, acceleration] = names;
        [(position, angle), (velocity, rate), (acceleration, rate)]
    }
}
