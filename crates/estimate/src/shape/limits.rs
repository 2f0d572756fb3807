//! What must not be exceeded: peaks are predicted before a reference is applied, and looked at
//! afterwards.

use std::fmt;
use std::iter::zip;

use frfid_signals::{Record, SignalError, checks};
use ndarray::{Array3, ArrayViewMut1, Axis};

use crate::shape::iteration::{Note, Peaks};

/// A limit that is only touched, but for rounding, is kept.
const ROUNDING: f64 = 1e-9;

/// Limits per axis; `None` where there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeLimits {
    /// Largest motor torque in N m, what holds against gravity included.
    pub max_torque_nm: Option<Vec<f64>>,
    /// Largest velocity in rad/s, of motor and reference.
    pub max_velocity_rad_s: Option<Vec<f64>>,
    /// Largest distance in rad from the place where a run begins, of motor and integrated
    /// reference.
    pub max_travel_rad: Option<Vec<f64>>,
    /// Factor above 1 by which a quantity may change more than predicted without exceeding its
    /// limit, as long as nothing is known of how good the predictions are; later it follows what is
    /// observed. Friction makes a machine move less than in proportion at first and more later.
    pub margin: f64,
}

impl Default for ShapeLimits {
    fn default() -> Self {
        Self {
            max_torque_nm: None,
            max_velocity_rad_s: None,
            max_travel_rad: None,
            margin: 2.0,
        }
    }
}

/// What has a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Motor torque in N m.
    Torque,
    /// Velocity in rad/s.
    Velocity,
    /// Distance from the start in rad.
    Travel,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Torque => "torque in N m",
            Self::Velocity => "velocity in rad/s",
            Self::Travel => "travel in rad",
        })
    }
}

/// Factor on an observed ratio of growth to prediction: the next ratio may be that much larger.
const LEARNT_MARGIN: f64 = 1.25;

/// Factors on predicted changes, per quantity in the order of [`Quantity::ALL`], and axis.
pub(super) type Margins = [Vec<f64>; 3];

impl Quantity {
    /// All of them.
    pub(super) const ALL: [Self; 3] = [Self::Torque, Self::Velocity, Self::Travel];
}

impl ShapeLimits {
    /// Checks every limit for `n_axes` axes.
    ///
    /// # Errors
    /// [`SignalError`] for another number of axes, a limit that is not above 0, a margin below 1.
    pub fn check(&self, n_axes: usize) -> Result<(), SignalError> {
        checks::one_per_axis(
            "max_torque_nm",
            self.max_torque_nm.as_deref(),
            n_axes,
            checks::positive,
        )?;
        checks::one_per_axis(
            "max_velocity_rad_s",
            self.max_velocity_rad_s.as_deref(),
            n_axes,
            checks::positive,
        )?;
        checks::one_per_axis(
            "max_travel_rad",
            self.max_travel_rad.as_deref(),
            n_axes,
            checks::positive,
        )?;
        if self.margin >= 1.0 && self.margin.is_finite() {
            return Ok(());
        }
        Err(SignalError::Parameter {
            name: "margin",
            found: self.margin,
            needed: "a finite factor, 1 or above",
        })
    }

    /// The limit of a quantity on an axis; infinite if there is none.
    #[must_use]
    pub fn of(&self, quantity: Quantity, axis: usize) -> f64 {
        let limits = match quantity {
            Quantity::Torque => &self.max_torque_nm,
            Quantity::Velocity => &self.max_velocity_rad_s,
            Quantity::Travel => &self.max_travel_rad,
        };
        limits.as_ref().map_or(f64::INFINITY, |limits| limits[axis])
    }

    /// Every peak above its limit.
    pub(super) fn exceeded(&self, peaks: &Peaks) -> Vec<Note> {
        let mut notes = Vec::new();
        for quantity in Quantity::ALL {
            for (axis, &found) in peaks.of(quantity).iter().enumerate() {
                let limit = self.of(quantity, axis);
                if found > limit * (1.0 + ROUNDING) {
                    notes.push(Note::Exceeded {
                        axis,
                        quantity,
                        found,
                        limit,
                    });
                }
            }
        }
        notes
    }
}

impl Peaks {
    /// The peaks of a quantity, one per axis.
    #[must_use]
    pub fn of(&self, quantity: Quantity) -> &[f64] {
        match quantity {
            Quantity::Torque => &self.torque_nm,
            Quantity::Velocity => &self.velocity_rad_s,
            Quantity::Travel => &self.travel_rad,
        }
    }

    /// The peaks of three signals `(experiment, axis, sample)`.
    pub(super) fn of_signals([torque, velocity, travel]: [&Array3<f64>; 3]) -> Self {
        let peak = |signal: &Array3<f64>| {
            signal
                .axis_iter(Axis(1))
                .map(|axis| axis.iter().fold(0.0, |peak: f64, x| peak.max(x.abs())))
                .collect()
        };
        Self {
            torque_nm: peak(torque),
            velocity_rad_s: peak(velocity),
            travel_rad: peak(travel),
        }
    }

    /// Learns margins from how much more these peaks grew than predicted; nothing where they grew
    /// by less than a twentieth of the limit.
    pub(super) fn teach(
        &self,
        margins: &mut Margins,
        before: &Self,
        predicted: &Self,
        limits: &ShapeLimits,
    ) {
        for (margins, quantity) in zip(margins, Quantity::ALL) {
            let (found, before, predicted) = (
                self.of(quantity),
                before.of(quantity),
                predicted.of(quantity),
            );
            for (axis, margin) in margins.iter_mut().enumerate() {
                let (grown, least) = (found[axis] - before[axis], 0.05 * limits.of(quantity, axis));
                if grown > least {
                    *margin = LEARNT_MARGIN
                        * (grown / (predicted[axis] - before[axis]).max(least)).max(1.0);
                }
            }
        }
    }
}

/// Distance in rad from the first sample, `(experiment, axis, sample)`; from the velocity where the
/// position was not measured.
pub(super) fn travel_of(
    records: &[Record],
    velocity: &Array3<f64>,
    sample_time_s: f64,
) -> Array3<f64> {
    let mut travel = velocity.clone();
    for (mut travel, record) in zip(travel.axis_iter_mut(Axis(0)), records) {
        if let Some(position) = &record.position_rad {
            for (mut travel, position) in zip(travel.rows_mut(), position.rows()) {
                zip(travel.iter_mut(), position)
                    .for_each(|(travel, &at)| *travel = at - position[0]);
            }
        } else {
            travel
                .rows_mut()
                .into_iter()
                .for_each(|row| integrate(row, sample_time_s));
        }
    }
    travel
}

/// The integral from 0, in place.
pub(super) fn integrate(mut signal: ArrayViewMut1<f64>, sample_time_s: f64) {
    let mut sum = 0.0;
    for value in &mut signal {
        let velocity = *value;
        *value = sum;
        sum += sample_time_s * velocity;
    }
}

/// The integral of every signal, `(experiment, axis, sample)`.
pub(super) fn integral(velocity: &Array3<f64>, sample_time_s: f64) -> Array3<f64> {
    let mut travel = velocity.clone();
    travel
        .lanes_mut(Axis(2))
        .into_iter()
        .for_each(|lane| integrate(lane, sample_time_s));
    travel
}

/// The largest share of a change, at most 1, with which `|from + margin share change| <= limit`
/// holds in one sample; 0 if `from` is beyond the limit already and the change leads further.
pub(super) fn share_of_sample(from: f64, change: f64, margin: f64, limit: f64) -> f64 {
    // |from + share change| is largest on the side to which the change points
    let room = limit - from * change.signum();
    if change == 0.0 {
        1.0
    } else {
        (room / (margin * change.abs())).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn the_share_stops_exactly_at_the_limit() {
        assert_eq!(share_of_sample(0.5, 1.0, 1.0, 1.0), 0.5);
        assert_eq!(share_of_sample(-0.5, -2.0, 1.0, 1.0), 0.25);
        assert_eq!(share_of_sample(-0.5, -2.0, 2.0, 1.0), 0.125);
        assert_eq!(share_of_sample(0.5, 1.0, 1.0, 10.0), 1.0);
        assert_eq!(share_of_sample(0.5, 1.0, 1.0, f64::INFINITY), 1.0);
        assert_eq!(share_of_sample(2.0, 1.0, 1.0, 1.0), 0.0);
        assert_eq!(
            share_of_sample(2.0, -0.5, 2.0, 2.5),
            1.0,
            "away from the limit is allowed"
        );
    }

    #[test]
    fn the_travel_is_the_integral_of_a_held_velocity() {
        let travel = integral(&array![[[1.0, 1.0, -1.0, 0.0]]], 0.5);
        assert_eq!(travel, array![[[0.0, 0.5, 1.0, 0.5]]]);
    }

    #[test]
    fn margins_follow_growth_that_matters() {
        let peaks = |torque: f64| Peaks {
            torque_nm: vec![torque],
            velocity_rad_s: vec![1.0],
            travel_rad: vec![1.0],
        };
        let limits = ShapeLimits {
            max_torque_nm: Some(vec![100.0]),
            ..ShapeLimits::default()
        };
        let learnt = |found, predicted| {
            let mut margins = [vec![2.0], vec![2.0], vec![2.0]];
            peaks(found).teach(&mut margins, &peaks(20.0), &peaks(predicted), &limits);
            assert_eq!((margins[1][0], margins[2][0]), (2.0, 2.0));
            margins[0][0]
        };
        assert_eq!(
            (learnt(24.0, 20.1), learnt(38.0, 40.0)),
            (2.0, LEARNT_MARGIN)
        );
        assert_eq!(
            (learnt(50.0, 40.0), learnt(40.0, 20.0)),
            (1.5 * LEARNT_MARGIN, 4.0 * LEARNT_MARGIN)
        );
        assert!(matches!(
            limits.exceeded(&peaks(101.0))[..],
            [Note::Exceeded {
                axis: 0,
                quantity: Quantity::Torque,
                ..
            }]
        ));
        assert!(
            limits.check(2).is_err()
                && ShapeLimits {
                    margin: 0.5,
                    ..ShapeLimits::default()
                }
                .check(1)
                .is_err()
        );
    }
}
