//! Kind of a signal by its unit and by the words of its name.

use frfid_files::{ListedSignal, si_unit};

/// What a signal measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Torque,
    Current,
    Force,
    Voltage,
    Velocity,
    Acceleration,
    Position,
    Time,
    Unknown,
}

/// Kinds by their SI unit.
const OF_UNITS: [(&str, Kind); 11] = [
    ("N m", Kind::Torque),
    ("A", Kind::Current),
    ("N", Kind::Force),
    ("V", Kind::Voltage),
    ("rad/s", Kind::Velocity),
    ("m/s", Kind::Velocity),
    ("rad/s^2", Kind::Acceleration),
    ("m/s^2", Kind::Acceleration),
    ("rad", Kind::Position),
    ("m", Kind::Position),
    ("s", Kind::Time),
];

/// Kinds by words, English and German, and by the letters of the field.
const OF_WORDS: [(Kind, &[&str]); 8] = [
    (
        Kind::Torque,
        &[
            "torque",
            "effort",
            "efforts",
            "moment",
            "tau",
            "trq",
            "drehmoment",
            "momentum",
        ],
    ),
    (Kind::Current, &["current", "curr", "iq", "amps", "strom"]),
    (
        Kind::Acceleration,
        &[
            "acceleration",
            "accelerations",
            "accel",
            "acc",
            "ddq",
            "qdd",
            "beschleunigung",
        ],
    ),
    (
        Kind::Velocity,
        &[
            "velocity",
            "velocities",
            "vel",
            "velo",
            "speed",
            "dq",
            "qd",
            "qdot",
            "omega",
            "gyro",
            "drehzahl",
            "geschwindigkeit",
            "feedrate",
        ],
    ),
    (
        Kind::Position,
        &[
            "position",
            "positions",
            "pos",
            "angle",
            "angles",
            "q",
            "theta",
            "encoder",
            "enc",
            "lage",
            "winkel",
        ],
    ),
    (Kind::Force, &["force", "kraft"]),
    (Kind::Voltage, &["voltage", "volt", "spannung"]),
    (Kind::Time, &["time", "t", "stamp", "timestamp", "zeit"]),
];

/// Words of what was asked for, not measured.
const ASKED: [&str; 17] = [
    "reference",
    "ref",
    "command",
    "commands",
    "cmd",
    "commanded",
    "target",
    "desired",
    "des",
    "setpoint",
    "set",
    "soll",
    "sollwert",
    "goal",
    "d",
    "excitation",
    "add",
];
/// Words of what is derived from others, and of no use in an FRF.
const DERIVED: [&str; 15] = [
    "error",
    "err",
    "errors",
    "fehler",
    "deviation",
    "covariance",
    "temperature",
    "temp",
    "limit",
    "limits",
    "flag",
    "status",
    "mode",
    "stamp",
    "scaling",
];
/// The words of a name in lower case: `ActTorque_2` is act, torque, 2.
pub(super) fn words(source: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last = ' ';
    for letter in way(source).chars() {
        let begins = letter.is_uppercase() && last.is_lowercase()
            || letter.is_numeric() != last.is_numeric();
        if begins || !letter.is_alphanumeric() {
            words.push(String::new());
        }
        if letter.is_alphanumeric() {
            let word = words.last_mut().expect("there is one from the start");
            word.extend(letter.to_lowercase());
        }
        last = letter;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The part of a source that names a signal, without topic, entry and unit.
fn way(source: &str) -> &str {
    let way = source.rsplit_once(':').map_or(source, |(_, way)| way);
    way.split(['[', '(']).next().unwrap_or(way)
}

/// What a signal measures, by its unit, then by the words of its name.
pub(super) fn kind(signal: &ListedSignal) -> Kind {
    match signal.unit.as_deref().and_then(by_unit) {
        _ if signal.is_moment => Kind::Time,
        Some(kind) => kind,
        None => by_words(&words(&signal.source)),
    }
}

fn by_unit(unit: &str) -> Option<Kind> {
    let si = si_unit(unit)?;
    let known = OF_UNITS.iter().find(|(name, _)| *name == si);
    known.map(|(_, kind)| *kind)
}

fn by_words(words: &[String]) -> Kind {
    let is_known = |word: &String, known: &[&str]| known.contains(&word.as_str());
    let mut kinds = OF_WORDS.iter();
    let named = kinds.find(|(_, known)| words.iter().any(|word| is_known(word, known)));
    named.map_or(Kind::Unknown, |(kind, _)| *kind)
}

/// Whether a signal was asked for rather than measured.
pub(super) fn is_asked(signal: &ListedSignal) -> bool {
    let topic = signal
        .source
        .rsplit_once(':')
        .map_or("", |(topic, _)| topic);
    let of_topic = words(topic);
    let mut all = words(&signal.source).into_iter().chain(of_topic);
    // what a controller of ROS 2 puts out is what it asks the drive for
    way(&signal.source).starts_with("output.") || all.any(|word| ASKED.contains(&word.as_str()))
}

/// Whether a signal follows from others or is none.
pub(super) fn is_derived(signal: &ListedSignal) -> bool {
    words(&signal.source)
        .iter()
        .any(|word| DERIVED.contains(&word.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(source: &str) -> ListedSignal {
        ListedSignal {
            source: source.into(),
            unit: None,
            first: Vec::new(),
            is_moment: false,
        }
    }

    #[test]
    fn names_say_what_is_measured() {
        for (source, expected, asked) in [
            ("/joint_states:effort[elbow]", Kind::Torque, false),
            ("/joint_commands:effort[elbow]", Kind::Torque, true),
            ("/state:reference.velocities[0]", Kind::Velocity, true),
            ("actual_qd_0", Kind::Velocity, false),
            ("target_moment_3", Kind::Torque, true),
            ("state.dq[0]", Kind::Velocity, false),
            ("cmd.tau_J_d[0]", Kind::Torque, true),
            ("ActTorque [%]", Kind::Torque, false),
            ("SetVelo", Kind::Velocity, true),
            ("Drehzahl", Kind::Velocity, false),
            ("t", Kind::Time, false),
            ("7", Kind::Unknown, false),
        ] {
            let signal = signal(source);
            assert_eq!(
                (kind(&signal), is_asked(&signal)),
                (expected, asked),
                "{source}"
            );
        }
    }
}
