//! Channels of a machine without a model: the table `[channels]`, in the place of `[robot]`.

use std::collections::BTreeSet;

use frfid_signals::Injection;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::fault::{Fault, check_entries};

/// Units of velocities: what is given in one of them is a set-point.
const OF_VELOCITIES: [&str; 8] = [
    "rad/s", "deg/s", "turn/s", "rpm", "1/min", "U/min", "m/s", "mm/s",
];

/// What is injected into a machine of which no model is needed: the signal is designed and held
/// against its limits, nothing is predicted or simulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelsTable {
    /// Name of every channel, as it stands in the logs.
    pub names: Vec<String>,
    /// Unit of what is injected, one for all channels or one for each: `N m`, `A`, `%`, `V`, `rpm`,
    /// `rad/s`, ...; a peak, an amplitude and a limit are in it.
    pub input_unit: Units,
    /// Unit of what answers, likewise; rad/s without it.
    pub output_unit: Option<Units>,
    /// Where it enters: `torque`, at the input of the plant, beneath a running velocity loop, too, or
    /// `velocity`, the set-point of a velocity loop. Without it what the unit of the first channel
    /// says.
    pub injection: Option<Injection>,
}

/// One unit for all channels, or one for each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Units {
    /// One for all.
    One(String),
    /// One for each.
    Each(Vec<String>),
}

impl Units {
    /// The unit of every channel.
    #[must_use]
    pub fn of_channels(&self, n_channels: usize) -> Vec<String> {
        match self {
            Self::One(unit) => vec![unit.clone(); n_channels],
            Self::Each(units) => units.clone(),
        }
    }

    /// Refuses another number of units than channels, and one that is empty.
    fn check(&self, key: &str, n_channels: usize) -> Result<(), Fault> {
        let units = self.of_channels(n_channels);
        let fault = |message: String| Fault::new(&[key], message);
        check_entries(key, units.len(), n_channels, "channels").map_err(fault)?;
        if units.iter().any(|unit| unit.trim().is_empty()) {
            return Err(fault(format!(
                "{key} is empty, needed: a unit, as \"A\" or \"N m\""
            )));
        }
        Ok(())
    }
}

/// What a signal in this unit is.
fn injection_in(unit: Option<&String>) -> Injection {
    match unit {
        Some(unit) if OF_VELOCITIES.contains(&unit.trim()) => Injection::Velocity,
        _ => Injection::Torque,
    }
}

impl ChannelsTable {
    /// Unit of what is injected into every channel.
    #[must_use]
    pub fn input_units(&self) -> Vec<String> {
        self.input_unit.of_channels(self.names.len())
    }

    /// Unit of what answers on every channel.
    #[must_use]
    pub fn output_units(&self) -> Vec<String> {
        let stated = self.output_unit.clone();
        let units = stated.unwrap_or_else(|| Units::One("rad/s".to_owned()));
        units.of_channels(self.names.len())
    }

    /// Unit of the plant's input: what is injected, or, beneath a velocity loop, a torque in N m.
    #[must_use]
    pub fn plant_units(&self) -> Vec<String> {
        match self.injection() {
            Injection::Torque => self.input_units(),
            Injection::Velocity => vec!["N m".to_owned(); self.names.len()],
        }
    }

    /// Where it enters.
    #[must_use]
    pub fn injection(&self) -> Injection {
        let units = self.input_units();
        let by_unit = || injection_in(units.first());
        self.injection.unwrap_or_else(by_unit)
    }

    /// Refuses names that are none or stand twice, and units that do not fit.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        self.check_names()?;
        let n_channels = self.names.len();
        self.input_unit.check("input_unit", n_channels)?;
        let mut output = self.output_unit.iter();
        output.try_for_each(|unit| unit.check("output_unit", n_channels))
    }

    fn check_names(&self) -> Result<(), Fault> {
        let names: BTreeSet<&str> = self.names.iter().map(|name| name.trim()).collect();
        let is_sound = !names.is_empty() && !names.contains("") && names.len() == self.names.len();
        let found = &self.names;
        let needed = || format!("names are {found:?}, needed: one for each channel, none twice");
        is_sound
            .then_some(())
            .ok_or_else(|| Fault::new(&["names"], needed()))
    }
}
