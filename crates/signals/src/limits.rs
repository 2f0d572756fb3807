//! Limits of a machine, one notion for descriptions, predictions, watches, shaping and events.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::limit::Limit;
use crate::number::format::significant;
use crate::peaks::Peaks;

/// Limits that no run may exceed: the table `[limits]`, one number for each axis; what is not given
/// is not limited.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Limits(BTreeMap<Limit, Vec<f64>>);

/// A limit that is exceeded.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Excess {
    /// Axis, from 0.
    pub axis: usize,
    /// Which limit.
    pub limit: Limit,
    /// The limit.
    pub allowed: f64,
    /// The value reached.
    pub found: f64,
}

/// For people: `axis 1 reached torque 12 N m, max_effort is 10`.
impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (axis, key) = (self.axis + 1, self.limit.key());
        let (quantity, unit) = (self.limit.quantity(), self.limit.unit());
        let [found, allowed] = [self.found, self.allowed].map(|value| significant(value, 4));
        write!(
            f,
            "axis {axis} reached {quantity} {found} {unit}, {key} is {allowed}"
        )
    }
}

impl Limits {
    /// The values of a limit, one for each axis; `None` where it is not given.
    #[must_use]
    pub fn get(&self, limit: Limit) -> Option<&[f64]> {
        self.0.get(&limit).map(Vec::as_slice)
    }

    /// The value on an axis, [`Limit::unlimited`] where there is none.
    #[must_use]
    pub fn of(&self, limit: Limit, axis: usize) -> f64 {
        let values = self.get(limit).and_then(|values| values.get(axis));
        values.copied().unwrap_or(limit.unlimited())
    }

    /// Every limit that is given.
    pub fn iter(&self) -> impl Iterator<Item = (Limit, &[f64])> {
        self.0
            .iter()
            .map(|(limit, values)| (*limit, values.as_slice()))
    }

    /// Gives a limit, one value for each axis.
    pub fn set(&mut self, limit: Limit, values: Vec<f64>) {
        self.0.insert(limit, values);
    }

    /// Takes a limit away.
    pub fn remove(&mut self, limit: Limit) {
        self.0.remove(&limit);
    }

    /// The tighter of two limits, axis by axis.
    #[must_use]
    pub fn tighter(&self, other: &Self) -> Self {
        let mut both = self.clone();
        for (&limit, others) in &other.0 {
            let ours = both.0.entry(limit).or_insert_with(|| others.clone());
            for (ours, theirs) in ours.iter_mut().zip(others) {
                *ours = limit.tighter(*ours, *theirs);
            }
        }
        both
    }

    /// Checks that there is one number for each of `n_axes`, above 0 for a size; infinity limits
    /// nothing.
    ///
    /// # Errors
    /// [`SignalError::Limit`] with the first that does not fit.
    pub fn check(&self, n_axes: usize) -> Result<(), SignalError> {
        for (&limit, found) in &self.0 {
            let fits = |value: &f64| !value.is_nan() && (!limit.is_size() || *value > 0.0);
            if found.len() != n_axes || !found.iter().all(fits) {
                let number = if limit.is_size() {
                    "a number above 0"
                } else {
                    "a number"
                };
                return Err(SignalError::Limit {
                    limit,
                    found: found.clone(),
                    number,
                    n_axes,
                });
            }
        }
        Ok(())
    }

    /// Every limit that `peaks` exceed; one that is only touched is kept.
    #[must_use]
    pub fn exceeded(&self, peaks: &Peaks) -> Vec<Excess> {
        let mut excesses = Vec::new();
        for (limit, allowed) in self.iter() {
            let found = peaks.get(limit).unwrap_or_default();
            for (axis, (&found, &allowed)) in found.iter().zip(allowed).enumerate() {
                if limit.is_exceeded(found, allowed) {
                    excesses.push(Excess {
                        axis,
                        limit,
                        allowed,
                        found,
                    });
                }
            }
        }
        excesses
    }
}

/// A property for each limit, so that editors complete and check their keys.
impl JsonSchema for Limits {
    fn schema_name() -> Cow<'static, str> {
        "Limits".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let of_axes = generator.subschema_for::<Option<Vec<f64>>>();
        let property = |&limit: &Limit| {
            let mut schema = of_axes.clone();
            let bound = if limit.is_size() { "Largest " } else { "" };
            let (quantity, unit) = (limit.quantity(), limit.unit());
            schema.insert(
                "description".into(),
                format!("{bound}{quantity} in {unit}.").into(),
            );
            (limit.key(), schema)
        };
        let properties: BTreeMap<_, _> = Limit::ALL.iter().map(property).collect();
        json_schema!({
            "description": "Limits that no run may exceed, one number for each axis.",
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
        })
    }
}

impl FromIterator<(Limit, Vec<f64>)> for Limits {
    fn from_iter<I: IntoIterator<Item = (Limit, Vec<f64>)>>(limits: I) -> Self {
        Self(limits.into_iter().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn limits(given: &[(Limit, f64)]) -> Limits {
        given
            .iter()
            .map(|&(limit, value)| (limit, vec![value]))
            .collect()
    }

    #[test]
    fn every_limit_is_listed_once_under_its_key() {
        let keys: BTreeSet<&str> = Limit::ALL.iter().map(|limit| limit.key()).collect();
        let quantities: BTreeSet<&str> = Limit::ALL
            .iter()
            .map(|limit| limit.quantity_key())
            .collect();
        assert_eq!(
            (keys.len(), quantities.len()),
            (Limit::ALL.len(), Limit::ALL.len())
        );
        let schema = serde_json::to_value(schemars::schema_for!(Limits)).expect("JSON");
        assert_eq!(
            schema["properties"]["max_jerk"]["description"],
            "Largest jerk in rad/s^3."
        );
    }

    #[test]
    fn the_tighter_limit_binds_whichever_way_it_points() {
        let ours = limits(&[(Limit::Torque, 5.0), (Limit::LowestPosition, -2.0)]);
        let theirs = limits(&[(Limit::LowestPosition, -1.0), (Limit::Travel, 1.0)]);
        let both = limits(&[
            (Limit::Torque, 5.0),
            (Limit::LowestPosition, -1.0),
            (Limit::Travel, 1.0),
        ]);
        assert_eq!(
            (ours.tighter(&theirs), theirs.tighter(&ours)),
            (both.clone(), both)
        );
    }

    #[test]
    fn a_limit_that_is_touched_is_kept() {
        let limits = limits(&[(Limit::Torque, 5.0), (Limit::LowestPosition, -1.0)]);
        let peaks = |torque, lowest| -> Peaks {
            [
                (Limit::Torque, vec![torque]),
                (Limit::LowestPosition, vec![lowest]),
            ]
            .into_iter()
            .collect()
        };
        assert_eq!(limits.exceeded(&peaks(5.0 + 1e-12, -1.0)), []);
        let lower = Excess {
            axis: 0,
            limit: Limit::LowestPosition,
            allowed: -1.0,
            found: -1.1,
        };
        assert_eq!(limits.exceeded(&peaks(4.0, -1.1)), [lower]);
    }

    #[test]
    fn unknown_names_and_numbers_that_limit_nothing_are_refused() {
        let unknown =
            serde_json::from_str::<Limits>(r#"{ "max_effrot": [1.0] }"#).expect_err("unknown");
        assert!(
            unknown.to_string().contains("expected one of `max_effort`"),
            "{unknown}"
        );
        let negative = limits(&[(Limit::Velocity, -1.0)]);
        let (found, number) = (vec![-1.0], "a number above 0");
        let refused = SignalError::Limit {
            limit: Limit::Velocity,
            found,
            number,
            n_axes: 1,
        };
        assert_eq!(
            (
                negative.check(1),
                limits(&[(Limit::LowestPosition, -1.0)]).check(1)
            ),
            (Err(refused), Ok(()))
        );
        assert!(matches!(
            limits(&[(Limit::Torque, 1.0)]).check(2),
            Err(SignalError::Limit { n_axes: 2, .. })
        ));
    }
}
