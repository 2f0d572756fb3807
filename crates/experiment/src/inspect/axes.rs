//! Units of axes that turn or slide, where none is stated.

use frfid_files::{ListedSignal, SignalGroup};

use crate::inspect::family::Family;
use crate::inspect::kind::Kind;

/// What is known of the axes when no unit is stated.
#[derive(Clone, Copy)]
pub(super) struct Axes<'l> {
    /// Whether they slide rather than turn.
    slide: bool,
    /// Type of the messages, without its package.
    type_name: &'l str,
}

impl<'l> Axes<'l> {
    /// What a group and the input in it say of them.
    pub(super) fn of(group: &'l SignalGroup, input: &Family) -> Self {
        let type_name = group.type_name.as_deref().unwrap_or_default();
        Self {
            slide: input.kind == Kind::Force || input.slides(),
            type_name: type_name.rsplit('/').next().unwrap_or(type_name),
        }
    }

    /// The unit of a signal, and where that comes from.
    pub(super) fn unit_of(self, signal: &ListedSignal, kind: Kind) -> (String, String) {
        if let Some(unit) = &signal.unit {
            return (unit.clone(), "as the file says".into());
        }
        let (turning, sliding) = match kind {
            Kind::Torque => ("N m", "N"),
            Kind::Current => ("A", "A"),
            Kind::Force => ("N", "N"),
            Kind::Voltage => ("V", "V"),
            Kind::Velocity => ("rad/s", "m/s"),
            Kind::Acceleration => ("rad/s^2", "m/s^2"),
            Kind::Position => ("rad", "m"),
            Kind::Time => ("s", "s"),
            Kind::Unknown => ("1", "1"),
        };
        let unit = if self.slide { sliding } else { turning };
        (unit.into(), self.why(kind))
    }

    fn why(self, kind: Kind) -> String {
        let axes = if self.slide { "sliding" } else { "turning" };
        match (self.type_name, kind) {
            (_, Kind::Unknown) => "unknown: state it".into(),
            ("JointState" | "JointTrajectoryControllerState", _) => {
                format!("of {axes} joints, by the definition of {}", self.type_name)
            }
            _ => "guessed from its name: check it".into(),
        }
    }
}
