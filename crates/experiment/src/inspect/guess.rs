//! Guess of a log map: which signal plays which role, by kind, by what was asked for, and by number.

use frfid_files::{Listing, LogMap, Signal, SignalGroup};
use frfid_signals::InputKind;
use serde::Serialize;

use crate::inspect::axes::Axes;
use crate::inspect::family::{Family, INPUTS, OUTPUT, OUTPUTS, REFERENCE, families};
use crate::inspect::kind::Kind;
use crate::inspect::looked::GroupLook;
use crate::inspect::times::times;

/// Sides of an axis that are measured at most: motor and load.
const SIDES: usize = 2;

/// A log map that was guessed, and why its units are what they are.
#[derive(Debug, Clone, Serialize)]
pub struct GuessedMap {
    /// The map.
    pub map: LogMap,
    /// Where each unit comes from, by the source of its signal.
    pub units_from: Vec<(String, String)>,
    /// Whether the recording has sample times; without them `sample_time_s` is to be stated.
    pub has_clock: bool,
}

/// What a plant is made of.
struct Roles<'f, 'l> {
    u: &'f Family<'l>,
    y: Vec<&'f Family<'l>>,
    r: Option<&'f Family<'l>>,
    position: Vec<&'f Family<'l>>,
}

impl GuessedMap {
    /// The map of a recording; `None` without an input or an output.
    pub(super) fn of(listing: &Listing, looks: &[GroupLook]) -> Option<Self> {
        let families = families(listing, looks);
        let roles = Roles::of(&families)?;
        let group = &listing.groups[roles.u.group];
        let mut guess = Self {
            map: LogMap::new(Vec::new(), Vec::new()),
            units_from: Vec::new(),
            has_clock: group.type_name.is_some() || times(group).is_some(),
        };
        let axes = Axes::of(group, roles.u);
        guess.map.u = guess.signals(&[roles.u], axes);
        guess.map.y = guess.signals(&roles.y, axes);
        guess.map.r = guess.signals(roles.r.as_slice(), axes);
        guess.map.position = guess.signals(&roles.position, axes);
        if roles.u.is_asked {
            guess.map.input_kind = InputKind::Commanded;
        }
        guess.add_time(group);
        guess.add_plan(group);
        Some(guess)
    }

    /// What frfid's own exports call the player's count and the number of the plan.
    fn add_plan(&mut self, group: &SignalGroup) {
        let named = |name: &str| {
            let is_there = group.signals.iter().any(|signal| signal.source == name);
            is_there.then(|| Signal::of(name, "1"))
        };
        self.map.plan_id = named("plan_id");
        if self.map.plan_id.is_some() {
            self.map.plan_clock.extend(named("k"));
            let counts = ["k", "plan_id"].map(|name| (name.to_owned(), "a count".to_owned()));
            self.units_from.extend(counts);
        }
    }

    /// The sample times of a table or of arrays; bags have stamps.
    fn add_time(&mut self, group: &SignalGroup) {
        let Some((time, is_stated)) = times(group) else {
            return;
        };
        let why = if is_stated {
            "as the file says"
        } else {
            "guessed from its steps"
        };
        self.units_from.push((time.source.clone(), why.into()));
        self.map.time = Some(time);
    }

    /// The signals of families with their units.
    fn signals(&mut self, families: &[&Family], axes: Axes) -> Vec<Signal> {
        let mut signals = Vec::new();
        for family in families {
            for signal in &family.signals {
                let (unit, why) = axes.unit_of(signal, family.kind);
                self.units_from.push((signal.source.clone(), why));
                signals.push(Signal::of(&signal.source, &unit));
            }
        }
        signals
    }
}

impl<'f, 'l> Roles<'f, 'l> {
    fn of(families: &'f [Family<'l>]) -> Option<Self> {
        let u = input(families)?;
        let y = outputs(families, u);
        let is_other = |family: &&Family| !std::ptr::eq(*family, u) && family.has_axes_of(u);
        let others: Vec<&Family> = families.iter().filter(is_other).collect();
        Some(Self {
            u,
            r: reference(&others, u),
            position: positions(&others, &y)?,
            y,
        })
    }
}

/// The positions of all outputs, or none.
fn positions<'f, 'l>(others: &[&'f Family<'l>], y: &[&Family]) -> Option<Vec<&'f Family<'l>>> {
    let output = y.first()?;
    let measured = |family: &&&Family| family.kind == Kind::Position && !family.is_asked;
    let beside = others
        .iter()
        .filter(measured)
        .filter(|family| family.group == output.group);
    let positions: Vec<&Family> = beside.copied().take(y.len()).collect();
    let are_all = output.kind != Kind::Position && n_signals(&positions) == n_signals(y);
    Some(if are_all { positions } else { Vec::new() })
}

fn n_signals(families: &[&Family]) -> usize {
    families.iter().map(|family| family.signals.len()).sum()
}

/// What was asked for: the reference of a velocity by that name, then of the kind of the input, then of any kind but
/// positions, then these.
fn reference<'f, 'l>(others: &[&'f Family<'l>], u: &Family) -> Option<&'f Family<'l>> {
    let asked = others
        .iter()
        .copied()
        .filter(|family| family.is_asked || family.is_named(REFERENCE));
    asked.min_by_key(|family| {
        let is_velocity = family.kind == Kind::Velocity && family.is_named(REFERENCE);
        let is_like_input = family.kind == u.kind;
        let is_position = family.kind == Kind::Position;
        (!is_velocity, !is_like_input, is_position)
    })
}

/// What drives the plant: measured rather than asked for, beside outputs of as many axes if there is such.
fn input<'f, 'l>(families: &'f [Family<'l>]) -> Option<&'f Family<'l>> {
    let candidates = families.iter().filter(|family| family.is_input());
    candidates.min_by_key(|family| {
        let is_alone = !families.iter().any(|other| other.answers(family));
        let place = INPUTS.iter().position(|kind| *kind == family.kind);
        (is_alone, family.is_asked, place)
    })
}

/// What the plant answers with: of the best kind, a side of the axes each, or the only one there is.
fn outputs<'f, 'l>(families: &'f [Family<'l>], u: &Family) -> Vec<&'f Family<'l>> {
    let of_kind = |kind: &Kind| {
        let candidates = families.iter().filter(|family| {
            family.kind == *kind
                && !family.is_asked
                && !std::ptr::eq(*family, u)
                && (*kind != Kind::Unknown || family.is_named(OUTPUT))
        });
        let candidates: Vec<&Family> = candidates.collect();
        let beside = candidates
            .iter()
            .copied()
            .filter(|family| family.answers(u));
        let sides: Vec<&Family> = beside.take(SIDES).collect();
        if sides.is_empty() {
            candidates.into_iter().take(1).collect()
        } else {
            sides
        }
    };
    OUTPUTS
        .iter()
        .map(of_kind)
        .find(|found| !found.is_empty())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::looked::SignalLook;
    use frfid_files::ListedSignal;

    fn guessed(groups: &[(&str, &[&str])]) -> Option<[Vec<String>; 4]> {
        let group = |(type_name, sources): &(&str, &[&str])| SignalGroup {
            type_name: (!type_name.is_empty()).then(|| (*type_name).to_owned()),
            signals: sources.iter().map(|source| signal(source)).collect(),
            ..SignalGroup::default()
        };
        let listing = Listing {
            format: "CSV",
            groups: groups.iter().map(group).collect(),
            told: Vec::new(),
        };
        let looks: Vec<GroupLook> = listing.groups.iter().map(look).collect();
        let map = GuessedMap::of(&listing, &looks)?.map;
        Some(
            [map.u, map.y, map.r, map.position]
                .map(|role| role.into_iter().map(|signal| signal.source).collect()),
        )
    }

    fn signal(source: &str) -> ListedSignal {
        ListedSignal {
            source: source.into(),
            unit: None,
            first: vec![0.0, 1.0],
            is_moment: false,
        }
    }

    fn look(group: &SignalGroup) -> GroupLook {
        let look = |signal: &ListedSignal| SignalLook {
            source: signal.source.clone(),
            lowest: Some(0.0),
            highest: Some(1.0),
            is_constant: false,
            odd: Vec::new(),
        };
        GroupLook {
            signals: group.signals.iter().map(look).collect(),
            ..GroupLook::default()
        }
    }

    #[test]
    fn roles_are_played_by_kind_and_number() {
        let bench = guessed(&[(
            "",
            &[
                "time_s",
                "current_reference_A",
                "current_A",
                "motor_velocity_rad_per_s",
                "load_velocity_rad_per_s",
                "motor_position_rad",
                "load_position_rad",
            ],
        )]);
        let bench = bench.expect("an input and outputs");
        assert_eq!(bench[0], ["current_A"]);
        assert_eq!(
            bench[1],
            ["motor_velocity_rad_per_s", "load_velocity_rad_per_s"]
        );
        assert_eq!(bench[2], ["current_reference_A"]);
        assert_eq!(bench[3], ["motor_position_rad", "load_position_rad"]);
    }

    #[test]
    fn joints_stay_together_and_commands_are_references() {
        let robot = guessed(&[
            (
                "std_msgs/msg/Float64MultiArray",
                &["/command:data[0]", "/command:data[1]"],
            ),
            (
                "sensor_msgs/msg/JointState",
                &[
                    "/js:position[a]",
                    "/js:position[b]",
                    "/js:velocity[a]",
                    "/js:velocity[b]",
                    "/js:effort[a]",
                    "/js:effort[b]",
                ],
            ),
        ]);
        let robot = robot.expect("an input and outputs");
        assert_eq!(robot[0], ["/js:effort[a]", "/js:effort[b]"]);
        assert_eq!(robot[1], ["/js:velocity[a]", "/js:velocity[b]"]);
        assert_eq!(robot[2], ["/command:data[0]", "/command:data[1]"]);
        assert_eq!(robot[3], ["/js:position[a]", "/js:position[b]"]);
    }

    #[test]
    fn letters_of_control_will_do_and_nothing_is_made_up() {
        let plain = guessed(&[("", &["u", "y", "r"])]).expect("u and y");
        assert_eq!(
            plain[..3],
            [
                vec!["u".to_owned()],
                vec!["y".to_owned()],
                vec!["r".to_owned()]
            ]
        );
        assert!(guessed(&[("", &["a", "b"])]).is_none());
        assert!(guessed(&[("", &["velocity"])]).is_none());
    }
}
