//! Amplitude over frequency, as in SK15 Table 1: values at frequencies, smooth in between.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::number::checks::{at_most_largest, not_negative, positive, require_shape};

/// Amplitude over frequency: constant outside its points, between two points a smoothstep in the
/// logarithm of the frequency, `A = A_i + (A_{i+1} - A_i) x^2 (3 - 2x)`,
/// `x = ln(f/f_i) / ln(f_{i+1}/f_i)`, so that slopes are continuous.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Profile {
    /// Points (frequency in Hz, amplitude), frequencies rising.
    pub points: Vec<(f64, f64)>,
}

impl Profile {
    /// The same amplitude at every frequency.
    #[must_use]
    pub fn constant(amplitude: f64) -> Self {
        Self {
            points: vec![(1.0, amplitude)],
        }
    }

    /// Checks that there is a point, that frequencies are positive and rising and amplitudes not
    /// negative.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] with the first offending value.
    pub fn check(&self) -> Result<(), SignalError> {
        if self.points.is_empty() {
            let (quantity, needed) = (
                "points of the amplitude profile",
                "at least one (Hz, amplitude)",
            );
            return Err(SignalError::derived("points", quantity, 0.0, needed));
        }
        for &(hz, amplitude) in &self.points {
            positive("points", hz)?;
            not_negative("amplitude", amplitude)?;
            at_most_largest("amplitude", amplitude)?;
        }
        match self.points.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            Some(pair) => Err(SignalError::derived(
                "points",
                "frequency of the amplitude profile in Hz",
                pair[1].0,
                "frequencies that rise from point to point",
            )),
            None => Ok(()),
        }
    }

    /// Amplitude at `hz`.
    #[must_use]
    pub fn at(&self, hz: f64) -> f64 {
        let above = self.points.partition_point(|&(point_hz, _)| point_hz <= hz);
        match (
            above.checked_sub(1).map(|below| self.points[below]),
            self.points.get(above),
        ) {
            (Some((low_hz, low)), Some(&(high_hz, high))) => {
                let x = (hz / low_hz).ln() / (high_hz / low_hz).ln();
                low + (high - low) * x * x * (3.0 - 2.0 * x)
            }
            (Some((_, amplitude)), None) | (None, Some(&(_, amplitude))) => amplitude,
            (None, None) => 0.0,
        }
    }

    /// Largest amplitude of the profile.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.points
            .iter()
            .fold(0.0, |peak, &(_, amplitude)| peak.max(amplitude))
    }
}

/// Checks that there is one profile for all inputs or one for each.
pub(crate) fn check_one_or_each(amplitude: &[Profile], n_inputs: usize) -> Result<(), SignalError> {
    let found = amplitude.len();
    let fits = n_inputs > 0 && (found == 1 || found == n_inputs);
    let needed = format_args!(
        "one profile for all, or one for each of the {n_inputs} inputs (at least one)"
    );
    require_shape("amplitude", &[found], fits, needed)
}

/// An amplitude as descriptions write it: a number, or points (Hz, value).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a number, or points [[Hz, value], ...]"
)]
pub enum Amplitude {
    /// The same at every frequency.
    Constant(f64),
    /// Values at frequencies, smooth in between.
    Points(Vec<(f64, f64)>),
}

impl Amplitude {
    /// The profile this stands for.
    #[must_use]
    pub fn profile(&self) -> Profile {
        match self {
            Self::Constant(amplitude) => Profile::constant(*amplitude),
            Self::Points(points) => Profile {
                points: points.clone(),
            },
        }
    }

    /// Checks the profile; errors are those of the field `key`.
    pub(crate) fn check(key: &'static str, amplitude: &Self) -> Result<(), SignalError> {
        let check = amplitude.profile().check();
        check.map_err(|error| SignalError::unfit(key, error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_outside_smooth_inside() {
        let table = Profile {
            points: vec![(36.0, 100.0), (44.0, 50.0)],
        };
        assert_eq!(table.check(), Ok(()));
        assert_eq!(
            (
                table.at(1.0),
                table.at(36.0),
                table.at(44.0),
                table.at(60.0)
            ),
            (100.0, 100.0, 50.0, 50.0)
        );
        assert!((table.at((36.0f64 * 44.0).sqrt()) - 75.0).abs() < 1e-12);
        assert_eq!(Profile::constant(150.0).at(0.1), 150.0);
    }

    #[test]
    fn bad_points_are_named() {
        for (points, key) in [
            (vec![], "points"),
            (vec![(2.0, 1.0), (2.0, 1.0)], "points"),
            (vec![(0.0, 1.0)], "points"),
            (vec![(1.0, -1.0)], "amplitude"),
            (vec![(1.0, f64::NAN)], "amplitude"),
        ] {
            let error = Profile { points }.check().expect_err("a bad profile");
            assert_eq!(error.path(), [key]);
        }
    }
}
