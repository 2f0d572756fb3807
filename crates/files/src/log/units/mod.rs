//! Units of recordings, and their SI units.

pub(crate) mod names;

use std::path::Path;

use crate::error::FileError;
use crate::log::map::Signal;

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

/// Other spellings of them.
const SPELLINGS: [(&str, &str); 26] = [
    ("N·m", "N m"),
    ("N*m", "N m"),
    ("N.m", "N m"),
    ("1/min", "rpm"),
    ("U/min", "rpm"),
    ("rev/min", "rpm"),
    ("min^-1", "rpm"),
    ("min-1", "rpm"),
    ("RPM", "rpm"),
    ("°", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("°/s", "deg/s"),
    ("rev", "turn"),
    ("rad/s²", "rad/s^2"),
    ("rad/s2", "rad/s^2"),
    ("°/s²", "deg/s^2"),
    ("m/s²", "m/s^2"),
    ("m/s2", "m/s^2"),
    ("µm", "um"),
    ("μm", "um"),
    ("µs", "us"),
    ("μs", "us"),
    ("sec", "s"),
    ("seconds", "s"),
    ("-", "1"),
];

/// Factor to SI and the SI unit.
pub(crate) type Si = (f64, &'static str);

/// A unit in SI, or the units there are.
pub(crate) fn to_si(unit: &str) -> Result<Si, String> {
    let spelled = SPELLINGS.iter().find(|(other, _)| *other == unit);
    let plain = spelled.map_or(unit, |(_, plain)| plain);
    let known = UNITS.iter().find(|(name, ..)| *name == plain);
    let (_, factor, si) = known.ok_or_else(known_units)?;
    Ok((*factor, si))
}

/// The SI unit of a unit; `None` of one that is not known.
#[must_use]
pub fn si_unit(unit: &str) -> Option<&'static str> {
    to_si(unit).ok().map(|(_, si)| si)
}

fn known_units() -> String {
    let names = UNITS.map(|(name, ..)| name);
    format!(
        "one of {}, % with full_scale, counts with counts_per_turn",
        names.join(", ")
    )
}

/// Parts of a full scale: name, and how many of them it is.
const PARTS: [(&str, f64); 6] = [
    ("%", 100.0),
    ("percent", 100.0),
    ("per cent", 100.0),
    ("‰", 1000.0),
    ("pu", 1.0),
    ("p.u.", 1.0),
];
/// Counts of an encoder.
const COUNTS: [&str; 7] = ["counts", "count", "cnt", "inc", "incr", "ticks", "digits"];

/// The unit of a signal in SI, or what is needed in its place.
pub(crate) fn signal_to_si(signal: &Signal) -> Result<Si, String> {
    let unit = signal.unit.as_str();
    let turns = unit.strip_suffix("/s");
    if let Some((_, parts)) = PARTS.iter().find(|(name, _)| *name == unit) {
        let (full_scale, si) = full_scale(signal.full_scale.as_deref())?;
        return Ok((full_scale / parts, si));
    }
    if COUNTS.contains(&turns.unwrap_or(unit)) {
        let si = turns.map_or("rad", |_| "rad/s");
        return Ok((std::f64::consts::TAU / counts(signal.counts_per_turn)?, si));
    }
    match (&signal.full_scale, signal.counts_per_turn) {
        (None, None) => to_si(unit),
        (Some(_), _) => Err("`%` or `pu`, which full_scale is for".into()),
        (None, Some(_)) => Err("`counts` or `counts/s`, which counts_per_turn is for".into()),
    }
}

/// `5 N m`.
fn full_scale(stated: Option<&str>) -> Result<Si, String> {
    let needed =
        || "full_scale beside it, a number and its unit: full_scale = \"5 N m\"".to_owned();
    let (number, unit) = stated
        .and_then(|text| text.trim().split_once(' '))
        .ok_or_else(needed)?;
    let number: f64 = number.parse().map_err(|_| needed())?;
    let (factor, si) = to_si(unit.trim())?;
    let is_scale = number.is_finite() && number != 0.0;
    is_scale.then_some((number * factor, si)).ok_or_else(needed)
}

fn counts(stated: Option<f64>) -> Result<f64, String> {
    let is_count = |count: &f64| count.is_finite() && *count != 0.0;
    stated
        .filter(is_count)
        .ok_or_else(|| "counts_per_turn beside it: counts_per_turn = 65536".into())
}

/// The same for a signal of a log map; an unknown unit is an error that names the signal.
pub(crate) fn si_of(path: &Path, signal: &Signal) -> Result<Si, FileError> {
    signal_to_si(signal).map_err(|needed| other_unit(path, signal, needed))
}

fn other_unit(path: &Path, signal: &Signal, needed: String) -> FileError {
    let what = format!("unit of {} in the log map", signal.source);
    FileError::content(path, what, format!("`{}`", signal.unit), needed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_counts_need_to_know_of_what() {
        let mut torque = Signal::of("ActTorque [%]", "%");
        assert!(
            signal_to_si(&torque)
                .expect_err("of what")
                .contains("full_scale")
        );
        torque.full_scale = Some("5 Nm".into());
        assert_eq!(signal_to_si(&torque), Ok((0.05, "N m")));
        torque.full_scale = Some("5".into());
        assert!(signal_to_si(&torque).is_err());
        let mut turns = Signal::of("enc", "counts/s");
        assert!(
            signal_to_si(&turns)
                .expect_err("of what")
                .contains("counts_per_turn")
        );
        turns.counts_per_turn = Some(4096.0);
        assert_eq!(
            signal_to_si(&turns),
            Ok((std::f64::consts::TAU / 4096.0, "rad/s"))
        );
        turns.unit = "rad".into();
        assert!(signal_to_si(&turns).is_err());
    }

    #[test]
    fn units_are_converted_once_and_unknown_ones_are_refused_with_the_list() {
        assert_eq!(
            to_si("deg").map(|(factor, si)| (factor * 180.0, si)),
            Ok((std::f64::consts::PI, "rad"))
        );
        assert!((to_si("rpm").expect("known").0 * 60.0 - std::f64::consts::TAU).abs() < 1e-15);
        assert!(to_si("furlong").expect_err("unknown").contains("deg/s"));
        for (other, plain) in SPELLINGS {
            assert_eq!(to_si(other), to_si(plain), "{other}");
            assert!(to_si(plain).is_ok(), "{plain}");
        }
    }
}
