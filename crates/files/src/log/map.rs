//! Log map: which signal of a recording plays which role, by `topic:field[index or joint]` of an MCAP,
//! or a column of a CSV, an array of an NPZ.

use std::ops::Range;

use frfid_signals::InputKind;
use serde::{Deserialize, Serialize};

use crate::log::csv::dialect::CsvTable;
use crate::log::units::names::without_unit;

/// One signal: where it comes from, its unit, its sign and scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// In an MCAP `topic:field`, for example `/joint_states:velocity[elbow]` or
    /// `/state:reference.positions[2]`; what stands in brackets is a place from 0 or the name of a
    /// joint, looked up in each message. In a CSV the name of the column; in an NPZ the name of an
    /// array (sample), or `name[row]` for one (channel, sample).
    pub source: String,
    /// Unit in the recording: `rad`, `deg`, `rad/s`, `rpm`, `N m`, `A`, ..., `%` with `full_scale`, `counts`
    /// with `counts_per_turn`; the signal is converted to SI once.
    pub unit: String,
    /// What 100 % is, `"5 N m"`, of a signal in `%`, or what 1 is of one in `pu`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub full_scale: Option<String>,
    /// Counts of one turn, of a signal in `counts` or `counts/s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_turn: Option<f64>,
    /// What results call it; its source without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Factor on top of the unit, -1 for a sensor that counts the other way round.
    #[serde(default = "one")]
    pub scale: f64,
}

impl Signal {
    /// As it is in the file, in a unit.
    #[must_use]
    pub fn of(source: &str, unit: &str) -> Self {
        Self {
            source: source.into(),
            unit: unit.into(),
            full_scale: None,
            counts_per_turn: None,
            name: None,
            scale: one(),
        }
    }

    /// What results call it: its name in the map, or its source without a unit in brackets, which would not be
    /// the SI unit beside it.
    pub(crate) fn label(&self) -> String {
        let stated = self.name.clone();
        stated.unwrap_or_else(|| without_unit(&self.source).to_owned())
    }
}

/// All signals of a map, role by role: u, y, r, position, plan_clock, plan_id.
pub(crate) type Signals<'s> = [&'s Signal];

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
    /// The player's own clock, brought back by the recording: a counter of its samples (unit `1`), or the time
    /// since it began a file, whose parts (s and ns) are added up.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plan_clock: Vec<Signal>,
    /// The number of the plan that was played, unit `1`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan_id: Option<Signal>,
    /// Whether `u` was commanded or measured.
    #[serde(default = "measured")]
    pub input_kind: InputKind,
    /// Column or array of the sample times of a CSV or NPZ, unit `s`, `ms`, `us` or `ns`; an MCAP
    /// has its header stamps.
    #[serde(default)]
    pub time: Option<Signal>,
    /// Sample time in s, of a CSV or NPZ without sample times; beside stamps, what these are too
    /// coarse or too late to tell.
    #[serde(default)]
    pub sample_time_s: Option<f64>,
    /// How a CSV is written; found in it without.
    #[serde(default)]
    pub csv: Option<CsvTable>,
    /// From when on the recordings are used, in s after their first sample; from there without it.
    #[serde(default)]
    pub start_s: Option<f64>,
    /// Until when the recordings are used, in s after their first sample; to their end without it.
    #[serde(default)]
    pub end_s: Option<f64>,
    /// Period of the excitation in s; found in the reference without it.
    #[serde(default)]
    pub period_s: Option<f64>,
    /// Excited lines, as multiples of one over the period, rising; found without it.
    #[serde(default)]
    pub lines: Option<Vec<usize>>,
    /// Whether nothing repeats in the recordings: they are then estimated as whole records. Looked for without it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub aperiodic: bool,
    /// Which realization each recording (or run in a recording) is, in their order; by their order
    /// and their phases without it.
    #[serde(default)]
    pub realization_of: Option<Vec<usize>>,
}

fn measured() -> InputKind {
    InputKind::Measured
}

fn has_any(places: &Range<usize>, signals: &[usize]) -> bool {
    signals.iter().any(|signal| places.contains(signal))
}

impl LogMap {
    /// A map of inputs and outputs that says nothing else.
    #[must_use]
    pub fn new(u: Vec<Signal>, y: Vec<Signal>) -> Self {
        Self {
            u,
            y,
            r: Vec::new(),
            position: Vec::new(),
            plan_clock: Vec::new(),
            plan_id: None,
            input_kind: measured(),
            time: None,
            sample_time_s: None,
            csv: None,
            start_s: None,
            end_s: None,
            period_s: None,
            lines: None,
            aperiodic: false,
            realization_of: None,
        }
    }

    /// Every signal, role by role: u, y, r, position, plan_clock, plan_id.
    pub(crate) fn roles(&self) -> [&[Signal]; 6] {
        let plan_id = self.plan_id.as_slice();
        [
            &self.u,
            &self.y,
            &self.r,
            &self.position,
            &self.plan_clock,
            plan_id,
        ]
    }

    /// The roles of signals, by their place among all signals, for people: `u, y`.
    pub(crate) fn roles_of(&self, signals: &[usize]) -> String {
        let played = self.places().map(|places| has_any(&places, signals));
        let mut names = ["u", "y", "r", "position", "plan_clock", "plan_id"].to_vec();
        let mut played = played.into_iter();
        names.retain(|_| played.next() == Some(true));
        names.join(", ")
    }

    /// The places of each role's signals among all signals.
    pub(crate) fn places(&self) -> [Range<usize>; 6] {
        let mut first = 0;
        self.roles().map(|role| {
            let places = first..first + role.len();
            first = places.end;
            places
        })
    }
}
