//! Limits that no run may exceed: the table `[limits]`, and what is left of it beside the robot's
//! own.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::text::{ConfigError, Source};

/// Limits on the joint side, named as in ros2_control; one number for each axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitsTable {
    /// Largest motor torque in N m.
    pub max_effort: Option<Vec<f64>>,
    /// Largest rate of the motor torque in N m/s.
    pub max_effort_rate: Option<Vec<f64>>,
    /// Largest motor velocity in rad/s.
    pub max_velocity: Option<Vec<f64>>,
    /// Largest motor acceleration in rad/s^2, of the predicted motion.
    pub max_acceleration: Option<Vec<f64>>,
    /// Largest motor jerk in rad/s^3, of the predicted motion.
    pub max_jerk: Option<Vec<f64>>,
    /// Largest way from the pose in rad (SK15 allows 4 degrees, 0.0698 rad).
    pub max_travel: Option<Vec<f64>>,
    /// Lowest position in rad.
    pub min_position: Option<Vec<f64>>,
    /// Highest position in rad.
    pub max_position: Option<Vec<f64>>,
}

impl LimitsTable {
    /// The name of every limit.
    pub const NAMES: [&'static str; 8] = [
        "max_effort",
        "max_effort_rate",
        "max_velocity",
        "max_acceleration",
        "max_jerk",
        "max_travel",
        "min_position",
        "max_position",
    ];

    /// Unit of one of [`LimitsTable::NAMES`].
    #[must_use]
    pub fn unit(name: &str) -> &'static str {
        match name {
            "max_effort" => "N m",
            "max_effort_rate" => "N m/s",
            "max_velocity" => "rad/s",
            "max_acceleration" => "rad/s^2",
            "max_jerk" => "rad/s^3",
            _ => "rad",
        }
    }

    /// The limits of one of [`LimitsTable::NAMES`].
    pub(crate) fn entry(&mut self, name: &str) -> &mut Option<Vec<f64>> {
        match name {
            "max_effort" => &mut self.max_effort,
            "max_effort_rate" => &mut self.max_effort_rate,
            "max_velocity" => &mut self.max_velocity,
            "max_acceleration" => &mut self.max_acceleration,
            "max_jerk" => &mut self.max_jerk,
            "max_travel" => &mut self.max_travel,
            "min_position" => &mut self.min_position,
            _ => &mut self.max_position,
        }
    }

    /// The limits that are given, with their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &Vec<f64>)> {
        let all = [
            &self.max_effort,
            &self.max_effort_rate,
            &self.max_velocity,
            &self.max_acceleration,
            &self.max_jerk,
            &self.max_travel,
            &self.min_position,
            &self.max_position,
        ];
        Self::NAMES
            .into_iter()
            .zip(all)
            .filter_map(|(name, limit)| Some((name, limit.as_ref()?)))
    }

    /// The tighter of two limits, axis by axis.
    #[must_use]
    pub fn tighter(&self, other: &Self) -> Self {
        let mut both = self.clone();
        for (name, others) in other.named() {
            let tighter = |(a, b): (&f64, &f64)| {
                if name == "min_position" {
                    a.max(*b)
                } else {
                    a.min(*b)
                }
            };
            let ours = both.entry(name);
            *ours = Some(match ours.take() {
                Some(ours) => ours.iter().zip(others).map(tighter).collect(),
                None => others.clone(),
            });
        }
        both
    }

    /// One number for each axis, sizes above 0.
    pub(crate) fn check(&self, n_axes: usize, source: &Source) -> Result<(), ConfigError> {
        for (name, limit) in self.named() {
            let is_size = !name.ends_with("_position");
            if limit.len() != n_axes
                || limit
                    .iter()
                    .any(|value| value.is_nan() || (is_size && *value <= 0.0))
            {
                let number = if is_size {
                    "a number above 0"
                } else {
                    "a number"
                };
                let message =
                    format!("{name} is {limit:?}, needed: {number} for each of the {n_axes} axes");
                return Err(source.error(&["limits", name], message));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tighter_limit_binds_axis_by_axis() {
        let table = |effort: Option<[f64; 2]>, lowest: Option<[f64; 2]>| LimitsTable {
            max_effort: effort.map(Vec::from),
            min_position: lowest.map(Vec::from),
            ..LimitsTable::default()
        };
        let experiment = table(Some([100.0, 100.0]), None);
        let robot = table(Some([50.0, f64::INFINITY]), Some([-1.0, f64::NEG_INFINITY]));
        assert_eq!(
            experiment.tighter(&robot),
            table(Some([50.0, 100.0]), Some([-1.0, f64::NEG_INFINITY]))
        );
        assert_eq!(robot.tighter(&experiment), experiment.tighter(&robot));
    }
}
