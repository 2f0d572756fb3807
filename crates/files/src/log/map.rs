//! Which signal of a foreign recording plays which role: `topic:field[index or joint]` of an MCAP,
//! or a column of a CSV, an array of an NPZ.

use frfid_signals::InputKind;
use serde::{Deserialize, Serialize};

/// One signal: where it comes from, its unit, its sign and scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// In an MCAP `topic:field`, for example `/joint_states:velocity[elbow]` or
    /// `/state:reference.positions[2]`; what stands in brackets is a place from 0 or the name of a
    /// joint, looked up in each message. In a CSV the name of the column; in an NPZ the name of an
    /// array (sample), or `name[row]` for one (channel, sample).
    pub source: String,
    /// Unit in the recording: `rad`, `deg`, `rad/s`, `rpm`, `N m`, `A`, ...; the signal is
    /// converted to SI once.
    pub unit: String,
    /// Factor on top of the unit, -1 for a sensor that counts the other way round.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

/// Which signals are input, output, reference and position, channel by channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogMap {
    /// Plant input.
    pub u: Vec<Signal>,
    /// Plant output.
    pub y: Vec<Signal>,
    /// Reference; empty where there is none.
    #[serde(default)]
    pub r: Vec<Signal>,
    /// Position; empty where there is none.
    #[serde(default)]
    pub position: Vec<Signal>,
    /// Whether `u` was commanded or measured.
    #[serde(default = "measured")]
    pub input_kind: InputKind,
    /// Column or array of the sample times of a CSV or NPZ, unit `s`, `ms`, `us` or `ns`; an MCAP
    /// has its header stamps.
    #[serde(default)]
    pub time: Option<Signal>,
    /// Sample time in s of a CSV or NPZ without sample times.
    #[serde(default)]
    pub sample_time_s: Option<f64>,
}

fn measured() -> InputKind {
    InputKind::Measured
}

impl LogMap {
    /// Every signal, role by role: u, y, r, position.
    pub(crate) fn roles(&self) -> [&[Signal]; 4] {
        [&self.u, &self.y, &self.r, &self.position]
    }
}

/// Units of recordings: name, factor to SI, SI unit.
const UNITS: [(&str, f64, &str); 30] = [
    ("rad", 1.0, "rad"),
    ("deg", std::f64::consts::PI / 180.0, "rad"),
    ("turn", std::f64::consts::TAU, "rad"),
    ("rad/s", 1.0, "rad/s"),
    ("deg/s", std::f64::consts::PI / 180.0, "rad/s"),
    ("rpm", std::f64::consts::PI / 30.0, "rad/s"),
    ("rad/s^2", 1.0, "rad/s^2"),
    ("deg/s^2", std::f64::consts::PI / 180.0, "rad/s^2"),
    ("N m", 1.0, "N m"),
    ("Nm", 1.0, "N m"),
    ("mNm", 1e-3, "N m"),
    ("kNm", 1e3, "N m"),
    ("m", 1.0, "m"),
    ("mm", 1e-3, "m"),
    ("um", 1e-6, "m"),
    ("m/s", 1.0, "m/s"),
    ("mm/s", 1e-3, "m/s"),
    ("m/s^2", 1.0, "m/s^2"),
    ("g", 9.80665, "m/s^2"),
    ("N", 1.0, "N"),
    ("kN", 1e3, "N"),
    ("A", 1.0, "A"),
    ("mA", 1e-3, "A"),
    ("V", 1.0, "V"),
    ("mV", 1e-3, "V"),
    ("1", 1.0, "1"),
    ("s", 1.0, "s"),
    ("ms", 1e-3, "s"),
    ("us", 1e-6, "s"),
    ("ns", 1e-9, "s"),
];

/// Factor to SI and the SI unit, or the units there are.
pub(crate) fn to_si(unit: &str) -> Result<(f64, &'static str), String> {
    let known = UNITS
        .iter()
        .find(|(name, ..)| *name == unit)
        .map(|&(_, factor, si)| (factor, si));
    known.ok_or_else(|| format!("one of {}", UNITS.map(|(name, ..)| name).join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_converted_once_and_unknown_ones_are_refused_with_the_list() {
        assert_eq!(
            to_si("deg").map(|(factor, si)| (factor * 180.0, si)),
            Ok((std::f64::consts::PI, "rad"))
        );
        assert!((to_si("rpm").expect("known").0 * 60.0 - std::f64::consts::TAU).abs() < 1e-15);
        assert!(to_si("degree").expect_err("unknown").contains("deg/s"));
    }
}
