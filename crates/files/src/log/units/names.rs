//! Units in the names of signals: `current [mA]`, `Time (ms)`, `velocity_rad_per_s`.

use crate::log::map::Signal;
use crate::log::units::to_si;

/// How names end that say their unit.
const ENDINGS: [(&str, &str); 32] = [
    ("_rad_per_s2", "rad/s^2"),
    ("_rad_per_s", "rad/s"),
    ("_rad_s2", "rad/s^2"),
    ("_rad_s", "rad/s"),
    ("_radps", "rad/s"),
    ("_deg_per_s", "deg/s"),
    ("_deg_s", "deg/s"),
    ("_degps", "deg/s"),
    ("_m_per_s2", "m/s^2"),
    ("_m_per_s", "m/s"),
    ("_m_s2", "m/s^2"),
    ("_m_s", "m/s"),
    ("_mm_s", "mm/s"),
    ("_rpm", "rpm"),
    ("_N_m", "N m"),
    ("_Nm", "N m"),
    ("_nm", "N m"),
    ("_mNm", "mNm"),
    ("_rad", "rad"),
    ("_deg", "deg"),
    ("_mA", "mA"),
    ("_A", "A"),
    ("_mV", "mV"),
    ("_V", "V"),
    ("_N", "N"),
    ("_mm", "mm"),
    ("_m", "m"),
    ("_ns", "ns"),
    ("_us", "us"),
    ("_ms", "ms"),
    ("_sec", "s"),
    ("_s", "s"),
];

/// The unit that a name says.
pub(crate) fn unit_in_name(name: &str) -> Option<String> {
    let name = without_place(name);
    let ending = || ENDINGS.iter().find(|(ending, _)| name.ends_with(ending));
    bracketed(name)
        .map(str::to_owned)
        .or_else(|| ending().map(|(_, unit)| (*unit).to_owned()))
}

/// A name without the unit in brackets at its end.
pub(crate) fn without_unit(name: &str) -> &str {
    match bracketed(name) {
        Some(unit) => name[..name.len() - unit.len() - 2].trim_end(),
        None => name,
    }
}

/// A name without the place in brackets at its end: `u[2]`.
fn without_place(name: &str) -> &str {
    let inside = name
        .strip_suffix(']')
        .and_then(|open| open.rsplit_once('['));
    match inside {
        Some((name, place)) if place.parse::<usize>().is_ok() => name,
        _ => name,
    }
}

/// What stands in brackets at the end of a name, if that is a unit; entries of topics are none.
fn bracketed(name: &str) -> Option<&str> {
    let pairs = [('[', ']'), ('(', ')')];
    let inside = |(open, close)| Some(name.strip_suffix(close)?.rsplit_once(open)?.1);
    let unit = pairs.into_iter().find_map(inside)?;
    let is_place = unit.parse::<f64>().is_ok() || name.contains(':');
    (!is_place && is_unit(unit)).then_some(unit)
}

fn is_unit(text: &str) -> bool {
    to_si(text).is_ok() || matches!(text, "%" | "‰" | "pu" | "counts" | "inc" | "cnt")
}

/// Whether two spellings are of one unit.
pub(crate) fn are_alike(one: &str, other: &str) -> bool {
    one == other || matches!((to_si(one), to_si(other)), (Ok(one), Ok(other)) if one == other)
}

/// That the name of a signal says another unit than the log map; `1` takes the numbers as they are.
pub(crate) fn name_says_otherwise(signal: &Signal) -> Option<String> {
    let named = unit_in_name(&signal.source)?;
    let Signal { source, unit, .. } = signal;
    let is_other = unit != "1" && !are_alike(&named, unit);
    is_other.then(|| {
        format!(
            "`{source}` is in `{named}` by its name and in `{unit}` by the map, which was taken"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_stands_in_brackets_or_at_the_end() {
        for (name, unit) in [
            ("ActTorque [%]", Some("%")),
            ("Time (ms)", Some("ms")),
            ("motor_velocity_rad_per_s", Some("rad/s")),
            ("tau_Nm[3]", Some("N m")),
            ("u[1]", None),
            ("/joint_states:effort[A]", None),
            ("state.q[0]", None),
            ("torque", None),
            ("f(x)", None),
        ] {
            assert_eq!(unit_in_name(name).as_deref(), unit, "{name}");
        }
        assert_eq!(without_unit("ActTorque [%]"), "ActTorque");
        assert_eq!(without_unit("u[1]"), "u[1]");
    }

    #[test]
    fn another_unit_than_the_name_says_is_told() {
        let told = |source, unit| name_says_otherwise(&Signal::of(source, unit));
        assert!(told("ActTorque [%]", "N m").is_some_and(|told| told.contains("`%` by its name")));
        assert_eq!(told("current_A", "A"), None);
        assert_eq!(told("speed [1/min]", "rpm"), None);
        assert!(told("speed [1/min]", "rad/s").is_some());
    }
}
