//! Torque over the motor position of one axis, from a motion in one direction.

use ndarray::ArrayView1;

use crate::error::EstimateError;

/// How far a glide may go back, relative to its way: what noise on the position makes of standing
/// or slow motion.
const BACK: f64 = 1e-3;
/// How far a run may go beyond the glide, relative to its way: the excitation's own wander at the
/// ends.
const BEYOND: f64 = 0.02;

/// Torque on rising places along the way of one axis; readings of equal place are averaged.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TorqueTable {
    /// Sign of the motion: `direction * position` rises.
    direction: f64,
    place_rad: Vec<f64>,
    torque_nm: Vec<f64>,
}

impl TorqueTable {
    /// The table of an axis, its straight line over position taken off.
    ///
    /// # Errors
    /// [`EstimateError::NotMonotone`] if the axis goes back by more than a thousandth of its way.
    pub(super) fn new(
        channel: usize,
        direction: f64,
        position_rad: ArrayView1<f64>,
        torque_nm: ArrayView1<f64>,
    ) -> Result<Self, EstimateError> {
        let places = position_rad.iter().map(|position| direction * position);
        let (place_rad, mut torque_nm, back_rad) = averaged(places, torque_nm);
        let way_rad = place_rad
            .last()
            .zip(place_rad.first())
            .map_or(0.0, |(last, first)| last - first);
        if back_rad > BACK * way_rad || place_rad.len() < 3 {
            return Err(EstimateError::NotMonotone {
                channel,
                back_rad,
                way_rad,
            });
        }
        remove_line(&place_rad, &mut torque_nm);
        Ok(Self {
            direction,
            place_rad,
            torque_nm,
        })
    }

    /// Torque at a position, linear between places, held beyond the ends.
    pub(super) fn at(&self, position_rad: f64) -> f64 {
        let place = self.direction * position_rad;
        let above = self.place_rad.partition_point(|&known| known <= place);
        match (above.checked_sub(1), self.place_rad.get(above)) {
            (Some(below), Some(&high)) => {
                let low = self.place_rad[below];
                let share = (place - low) / (high - low);
                self.torque_nm[below] * (1.0 - share) + self.torque_nm[above] * share
            }
            (None, _) => self.torque_nm[0],
            (Some(last), None) => self.torque_nm[last],
        }
    }

    /// Refuses positions further beyond the table than an excitation wanders.
    pub(super) fn check_range(
        &self,
        channel: usize,
        position_rad: ArrayView1<f64>,
    ) -> Result<(), EstimateError> {
        let ends = [self.place_rad[0], self.place_rad[self.place_rad.len() - 1]];
        let beyond = |position: &f64| {
            (ends[0] - self.direction * position).max(self.direction * position - ends[1])
        };
        let beyond_rad = position_rad.iter().map(beyond).fold(0.0, f64::max);
        let allowed_rad = BEYOND * (ends[1] - ends[0]);
        if beyond_rad <= allowed_rad {
            return Ok(());
        }
        let [a, b] = ends.map(|place| self.direction * place);
        Err(EstimateError::BeyondGlide {
            channel,
            beyond_rad,
            allowed_rad,
            low_rad: a.min(b),
            high_rad: a.max(b),
        })
    }
}

/// Rising places and the mean torque at each, a step back counted to the place before; and how far
/// back the farthest such step goes.
fn averaged(
    places: impl Iterator<Item = f64>,
    torque_nm: ArrayView1<f64>,
) -> (Vec<f64>, Vec<f64>, f64) {
    let (mut place_rad, mut sums): (Vec<f64>, Vec<(f64, f64)>) = (Vec::new(), Vec::new());
    let mut back_rad = 0.0f64;
    for (place, &torque) in places.zip(torque_nm) {
        match (place_rad.last(), sums.last_mut()) {
            (Some(&last), Some(sum)) if place <= last => {
                back_rad = back_rad.max(last - place);
                *sum = (sum.0 + torque, sum.1 + 1.0);
            }
            _ => {
                place_rad.push(place);
                sums.push((torque, 1.0));
            }
        }
    }
    let torque_nm = sums.iter().map(|(sum, count)| sum / count).collect();
    (place_rad, torque_nm, back_rad)
}

/// Takes off the least-squares straight line of `values` over `places`, of which at least two
/// differ.
fn remove_line(places: &[f64], values: &mut [f64]) {
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let (centre, level) = (mean(places), mean(values));
    let spread: f64 = places.iter().map(|place| (place - centre).powi(2)).sum();
    let slope = places
        .iter()
        .zip(values.iter())
        .map(|(place, value)| (place - centre) * value)
        .sum::<f64>()
        / spread;
    for (value, place) in values.iter_mut().zip(places) {
        *value -= level + slope * (place - centre);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array1;

    /// A wave and a straight line over the position, read at counts of `count_rad`, moving at
    /// `direction` through -1 to 1 rad.
    fn table(direction: f64, count_rad: f64) -> TorqueTable {
        let place = Array1::from_shape_fn(2001, |k| k as f64 * 1e-3 - 1.0);
        let torque = place.mapv(|place| 3.0 * (20.0 * direction * place).sin() + 7.0 + 5.0 * place);
        let read = place.mapv(|place| direction * (place / count_rad).round() * count_rad);
        TorqueTable::new(0, direction, read.view(), torque.view()).expect("monotone")
    }

    #[test]
    fn the_wave_is_found_again_in_both_directions_and_the_line_is_gone() {
        // the line fitted to the wave itself is what the tolerance allows for: 3 * 3 / 20 / 2 per
        // rad at most
        for (direction, count_rad) in [(1.0, 1e-3), (-1.0, 1e-3), (1.0, 5e-3)] {
            let table = table(direction, count_rad);
            for k in -90..=90 {
                let position = f64::from(k) * 0.01;
                let error = table.at(position) - 3.0 * (20.0 * position).sin();
                assert!(error.abs() < 0.25, "{position}: {error}");
            }
            assert_eq!(
                table.at(direction * 9.0),
                table.torque_nm[table.torque_nm.len() - 1]
            );
            assert_eq!(table.at(direction * -9.0), table.torque_nm[0]);
        }
    }

    #[test]
    fn turning_back_and_going_too_far_are_refused() {
        let turning = Array1::from_shape_fn(200, |k| (k as f64 * 0.02).sin());
        let back = TorqueTable::new(2, 1.0, turning.view(), turning.view());
        assert!(
            matches!(back, Err(EstimateError::NotMonotone { channel: 2, back_rad, .. }) if back_rad > 1.0)
        );
        let still = Array1::zeros(10);
        assert_eq!(
            TorqueTable::new(0, 1.0, still.view(), still.view()),
            Err(EstimateError::NotMonotone {
                channel: 0,
                back_rad: 0.0,
                way_rad: 0.0
            })
        );
        let table = table(-1.0, 1e-3);
        assert_eq!(
            table.check_range(0, Array1::from_vec(vec![-1.03, 1.03]).view()),
            Ok(())
        );
        let far = table.check_range(0, Array1::from_vec(vec![0.0, 1.1]).view());
        assert!(
            matches!(far, Err(EstimateError::BeyondGlide { beyond_rad, .. }) if (beyond_rad - 0.1).abs() < 1e-9)
        );
    }
}
