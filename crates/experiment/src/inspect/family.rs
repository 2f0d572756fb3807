//! Families of signals: those of one name that differ in their entries only, the joints of a robot.

use frfid_files::{ListedSignal, Listing};

use crate::inspect::kind::{Kind, is_asked, is_derived, kind, words};
use crate::inspect::looked::GroupLook;

/// What drives a plant, the best first.
pub(super) const INPUTS: [Kind; 5] = [
    Kind::Torque,
    Kind::Current,
    Kind::Force,
    Kind::Voltage,
    Kind::Unknown,
];
/// What a plant answers with, the best first.
pub(super) const OUTPUTS: [Kind; 4] = [
    Kind::Velocity,
    Kind::Acceleration,
    Kind::Position,
    Kind::Unknown,
];
/// An input in the letters and words of control.
const INPUT: [&str; 2] = ["u", "input"];
/// An output.
pub(super) const OUTPUT: [&str; 2] = ["y", "output"];
/// A reference.
pub(super) const REFERENCE: [&str; 2] = ["r", "reference"];
/// Parts of the names of joints that slide.
const SLIDING: [&str; 6] = [
    "slide",
    "prismatic",
    "linear",
    "rail",
    "gantry",
    "schlitten",
];

/// Signals of one name that differ in their entries only: the joints of a robot.
pub(super) struct Family<'l> {
    pub(super) group: usize,
    key: String,
    pub(super) kind: Kind,
    pub(super) is_asked: bool,
    pub(super) signals: Vec<&'l ListedSignal>,
}

/// The families of all signals that change.
pub(super) fn families<'l>(listing: &'l Listing, looks: &[GroupLook]) -> Vec<Family<'l>> {
    let mut families: Vec<Family> = Vec::new();
    for (group, (listed, look)) in listing.groups.iter().zip(looks).enumerate() {
        let is_constant = |signal: &ListedSignal| {
            let looks = look
                .signals
                .iter()
                .find(|look| look.source == signal.source);
            looks.is_none_or(|look| look.is_constant)
        };
        let useful = |signal: &&ListedSignal| !is_derived(signal) && !is_constant(signal);
        for signal in listed.signals.iter().filter(useful) {
            let key = key(&signal.source);
            match families
                .iter_mut()
                .find(|family| family.group == group && family.key == key)
            {
                Some(family) => family.signals.push(signal),
                None => families.push(Family {
                    group,
                    key,
                    kind: kind(signal),
                    is_asked: is_asked(signal),
                    signals: vec![signal],
                }),
            }
        }
    }
    families
}

/// A source without what tells entries and axes apart: brackets with what is in them, and digits.
fn key(source: &str) -> String {
    let mut depth = 0_usize;
    let mut key = String::new();
    for letter in source.chars() {
        match letter {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            letter if depth == 0 && !letter.is_numeric() => key.push(letter),
            _ => {}
        }
    }
    key
}

impl Family<'_> {
    /// Whether it may drive the plant.
    pub(super) fn is_input(&self) -> bool {
        INPUTS.contains(&self.kind) && (self.kind != Kind::Unknown || self.is_named(INPUT))
    }

    /// Whether it has as many axes.
    pub(super) fn has_axes_of(&self, other: &Family) -> bool {
        self.signals.len() == other.signals.len()
    }

    /// Whether it is an output beside an input of as many axes.
    pub(super) fn answers(&self, input: &Family) -> bool {
        let is_output = OUTPUTS[..3].contains(&self.kind) && !self.is_asked;
        is_output && self.group == input.group && self.has_axes_of(input)
    }

    /// Whether the names of its joints are of axes that slide.
    pub(super) fn slides(&self) -> bool {
        self.signals.iter().all(|signal| {
            let name = signal.source.to_lowercase();
            SLIDING.iter().any(|word| name.contains(word))
        })
    }

    /// Whether its name has the letter or the word of a role.
    pub(super) fn is_named(&self, role: [&str; 2]) -> bool {
        let words = words(&self.signals[0].source);
        words.iter().any(|word| role.contains(&word.as_str()))
    }
}
