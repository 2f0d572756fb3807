//! What must not be exceeded: peaks are predicted before a reference is applied, and looked at afterwards.

use std::fmt;
use std::iter::zip;

use frfid_signals::{Record, SignalError, range};
use ndarray::{Array3, ArrayView1, ArrayViewMut1, Axis};

use super::iteration::{Note, Peaks};

/// Limits per axis; `None` where there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeLimits {
    /// Largest motor torque in N m, what holds against gravity included.
    pub max_torque_nm: Option<Vec<f64>>,
    /// Largest velocity in rad/s, of motor and reference.
    pub max_velocity_rad_s: Option<Vec<f64>>,
    /// Largest distance in rad from the place where a run begins, of motor and integrated reference.
    pub max_travel_rad: Option<Vec<f64>>,
    /// Factor above 1 that predicted peaks are multiplied with before they are compared with a limit. Where a peak turns out
    /// larger than predicted, the next predictions get as much more.
    pub margin: f64,
}

impl Default for ShapeLimits {
    fn default() -> Self {
        Self { max_torque_nm: None, max_velocity_rad_s: None, max_travel_rad: None, margin: 1.2 }
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
        one_per_axis("max_torque_nm", self.max_torque_nm.as_deref(), n_axes)?;
        one_per_axis("max_velocity_rad_s", self.max_velocity_rad_s.as_deref(), n_axes)?;
        one_per_axis("max_travel_rad", self.max_travel_rad.as_deref(), n_axes)?;
        if self.margin >= 1.0 && self.margin.is_finite() {
            return Ok(());
        }
        Err(SignalError::Parameter { name: "margin", found: self.margin, needed: "a finite factor, 1 or above" })
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
                if found > limit {
                    notes.push(Note::Exceeded { axis, quantity, found, limit });
                }
            }
        }
        notes
    }
}

/// Checks that there is one positive value per axis, if there are any.
pub(super) fn one_per_axis(name: &'static str, values: Option<&[f64]>, n_axes: usize) -> Result<(), SignalError> {
    let Some(values) = values else { return Ok(()) };
    if values.len() != n_axes {
        return Err(SignalError::Shape { name, found: vec![values.len()], needed: format!("({n_axes})") });
    }
    values.iter().try_for_each(|&value| range::positive(name, value))
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
            signal.axis_iter(Axis(1)).map(|axis| axis.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()))).collect()
        };
        Self { torque_nm: peak(torque), velocity_rad_s: peak(velocity), travel_rad: peak(travel) }
    }

    /// The largest ratio of these peaks to those predicted, of quantities that come near enough to a limit to matter: at least
    /// a fifth of it.
    pub(super) fn surprise(&self, predicted: &Self, limits: &ShapeLimits) -> f64 {
        let mut largest: f64 = 0.0;
        for quantity in Quantity::ALL {
            for (axis, (found, predicted)) in zip(self.of(quantity), predicted.of(quantity)).enumerate() {
                if *found > 0.2 * limits.of(quantity, axis) && *predicted > 0.0 {
                    largest = largest.max(found / predicted);
                }
            }
        }
        largest
    }
}

/// Distance in rad from the first sample, `(experiment, axis, sample)`; from the velocity where the position was not measured.
pub(super) fn travel_of(records: &[Record], velocity: &Array3<f64>, sample_time_s: f64) -> Array3<f64> {
    let mut travel = velocity.clone();
    for (mut travel, record) in zip(travel.axis_iter_mut(Axis(0)), records) {
        if let Some(position) = &record.position_rad {
            for (mut travel, position) in zip(travel.rows_mut(), position.rows()) {
                zip(travel.iter_mut(), position).for_each(|(travel, &at)| *travel = at - position[0]);
            }
        } else {
            travel.rows_mut().into_iter().for_each(|row| integrate(row, sample_time_s));
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
    travel.lanes_mut(Axis(2)).into_iter().for_each(|lane| integrate(lane, sample_time_s));
    travel
}

/// The largest share of a change, at most 1, with which `|from + share change| <= limit` holds in every sample; 0 if `from`
/// is beyond the limit already.
pub(super) fn largest_share(from: ArrayView1<f64>, change: ArrayView1<f64>, limit: f64) -> f64 {
    let of_sample = |(&x, &dx): (&f64, &f64)| {
        // |x + s dx| is largest on the side to which dx points
        let room = limit - x * dx.signum();
        if dx == 0.0 { 1.0 } else { room / dx.abs() }
    };
    zip(from, change).map(of_sample).fold(1.0, f64::min).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{array, aview1};

    #[test]
    fn the_share_stops_exactly_at_the_limit() {
        let (from, change) = ([0.5, -0.5, 0.0], [1.0, -2.0, 0.0]);
        let share = largest_share(aview1(&from), aview1(&change), 1.0);
        assert_eq!(share, 0.25);
        assert_eq!(largest_share(aview1(&from), aview1(&change), 10.0), 1.0);
        assert_eq!(largest_share(aview1(&[2.0]), aview1(&[1.0]), 1.0), 0.0);
        assert_eq!(largest_share(aview1(&[2.0]), aview1(&[-0.5]), 3.0), 1.0, "away from the limit is allowed");
    }

    #[test]
    fn the_travel_is_the_integral_of_a_held_velocity() {
        let travel = integral(&array![[[1.0, 1.0, -1.0, 0.0]]], 0.5);
        assert_eq!(travel, array![[[0.0, 0.5, 1.0, 0.5]]]);
    }

    #[test]
    fn only_peaks_that_come_near_a_limit_teach_the_margin() {
        let peaks = |torque: f64| Peaks { torque_nm: vec![torque], velocity_rad_s: vec![1.0], travel_rad: vec![1.0] };
        let limits = ShapeLimits { max_torque_nm: Some(vec![100.0]), ..ShapeLimits::default() };
        assert_eq!(peaks(10.0).surprise(&peaks(1.0), &limits), 0.0);
        assert_eq!(peaks(60.0).surprise(&peaks(40.0), &limits), 1.5);
        assert!(matches!(
            limits.exceeded(&peaks(101.0))[..],
            [Note::Exceeded { axis: 0, quantity: Quantity::Torque, .. }]
        ));
        assert!(limits.check(2).is_err() && ShapeLimits { margin: 0.5, ..ShapeLimits::default() }.check(1).is_err());
    }
}
