//! Limit of a machine: the quantity that it bounds, its keys, its unit, which values it allows.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A limit that is only touched, but for rounding, is kept.
const ROUNDING: f64 = 1e-9;

/// A row for each limit: its key in files, as in ros2_control; the key of the quantity it bounds,
/// unit included; that quantity in words; its unit; which values it allows.
macro_rules! limits {
    ($($(#[$doc:meta])* $limit:ident: $key:literal, $quantity_key:literal, $quantity:literal, $unit:literal, $allows:ident;)*) => {
        /// What has a limit, on the joint side of the gear.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Limit {
            $($(#[$doc])* $limit,)*
        }

        impl Limit {
            /// Every limit, in the order in which they are reported.
            pub const ALL: &[Self] = &[$(Self::$limit),*];

            const fn row(self) -> ([&'static str; 4], Allows) {
                match self {
                    $(Self::$limit => ([$key, $quantity_key, $quantity, $unit], Allows::$allows),)*
                }
            }
        }
    };
}

/// Which values a limit allows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Allows {
    /// Magnitudes up to it.
    Smaller,
    /// Positions above it.
    Higher,
    /// Positions below it.
    Lower,
}

limits! {
    /// Largest motor torque in N m.
    Torque: "max_effort", "effort_nm", "torque", "N m", Smaller;
    /// Largest rate of the motor torque in N m/s.
    TorqueRate: "max_effort_rate", "effort_rate_nm_per_s", "torque rate", "N m/s", Smaller;
    /// Largest motor velocity in rad/s.
    Velocity: "max_velocity", "velocity_rad_s", "velocity", "rad/s", Smaller;
    /// Largest motor acceleration in rad/s^2, of the predicted motion.
    Acceleration: "max_acceleration", "acceleration_rad_s2", "acceleration", "rad/s^2", Smaller;
    /// Largest motor jerk in rad/s^3, of the predicted motion.
    Jerk: "max_jerk", "jerk_rad_s3", "jerk", "rad/s^3", Smaller;
    /// Largest way from the pose in rad (SK15 allows 4 degrees, 0.0698 rad).
    Travel: "max_travel", "travel_rad", "travel", "rad", Smaller;
    /// Lowest position in rad.
    LowestPosition: "min_position", "lowest_rad", "lowest position", "rad", Higher;
    /// Highest position in rad.
    HighestPosition: "max_position", "highest_rad", "highest position", "rad", Lower;
}

impl Limit {
    /// The key of the limit in `[limits]` and in the tables of joints.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.row().0[0]
    }

    /// The key of the quantity it bounds, in events and among peaks.
    #[must_use]
    pub const fn quantity_key(self) -> &'static str {
        self.row().0[1]
    }

    /// The quantity it bounds, in words.
    #[must_use]
    pub const fn quantity(self) -> &'static str {
        self.row().0[2]
    }

    /// Unit of what it bounds.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.row().0[3]
    }

    /// Whether values must stay above it, not below.
    #[must_use]
    pub fn is_lower(self) -> bool {
        self.row().1 == Allows::Higher
    }

    /// Whether it bounds a size, either way from 0, and not a position.
    #[must_use]
    pub fn is_size(self) -> bool {
        self.row().1 == Allows::Smaller
    }

    /// The value that limits nothing.
    #[must_use]
    pub fn unlimited(self) -> f64 {
        if self.is_lower() {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        }
    }

    /// The tighter of two values.
    pub(crate) fn tighter(self, a: f64, b: f64) -> f64 {
        if self.is_lower() { a.max(b) } else { a.min(b) }
    }

    /// The value farther out of two.
    pub(crate) fn farther(self, a: f64, b: f64) -> f64 {
        if self.is_lower() { a.min(b) } else { a.max(b) }
    }

    /// Whether a value lies beyond a limit by more than rounding.
    #[must_use]
    pub fn is_exceeded(self, found: f64, allowed: f64) -> bool {
        let margin = ROUNDING * allowed.abs();
        if self.is_lower() {
            found < allowed - margin
        } else {
            found > allowed + margin
        }
    }
}

/// By its key.
impl Serialize for Limit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de> Deserialize<'de> for Limit {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        Self::named(&key, Self::key).map_err(D::Error::custom)
    }
}

impl Limit {
    /// The limit of which `name` says this key, or what was found and needed.
    pub(crate) fn named(key: &str, name: fn(Self) -> &'static str) -> Result<Self, String> {
        let mut all = Self::ALL.iter().copied();
        all.find(|limit| name(*limit) == key).ok_or_else(|| {
            let keys = Self::ALL.iter().map(|limit| format!("`{}`", name(*limit)));
            let keys = keys.collect::<Vec<_>>().join(", ");
            format!("unknown limit `{key}`, expected one of {keys}")
        })
    }
}
