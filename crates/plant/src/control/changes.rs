//! Changes of a robot from sample to sample, torque rate, acceleration and jerk, counted from the
//! steady motion before a run.

use frfid_signals::{Limit, Peaks};

/// The quantities, in the order in which they are kept.
const QUANTITIES: [Limit; 3] = [Limit::TorqueRate, Limit::Acceleration, Limit::Jerk];

/// What the torque that acts and the true motion change by, one value for each axis.
#[derive(Debug, Clone)]
pub(crate) struct Changes {
    sample_time_s: f64,
    torque_nm: Vec<f64>,
    velocity_rad_s: Vec<f64>,
    /// Torque rate in N m/s, acceleration in rad/s^2, jerk in rad/s^3, as of the last sample.
    now: Vec<[f64; 3]>,
    /// Their largest sizes.
    largest: Vec<[f64; 3]>,
}

impl Changes {
    /// None yet: torques in N m hold steady velocities in rad/s.
    pub(crate) fn steady(sample_time_s: f64, torque_nm: &[f64], velocity_rad_s: &[f64]) -> Self {
        Self {
            sample_time_s,
            torque_nm: torque_nm.to_vec(),
            velocity_rad_s: velocity_rad_s.to_vec(),
            now: vec![[0.0; 3]; torque_nm.len()],
            largest: vec![[0.0; 3]; torque_nm.len()],
        }
    }

    /// Takes the torques that act from this sample on and the velocities at it.
    pub(crate) fn step(&mut self, torque_nm: &[f64], velocity_rad_s: &[f64]) {
        for axis in 0..torque_nm.len() {
            let rate = (torque_nm[axis] - self.torque_nm[axis]) / self.sample_time_s;
            let acceleration =
                (velocity_rad_s[axis] - self.velocity_rad_s[axis]) / self.sample_time_s;
            let jerk = (acceleration - self.now[axis][1]) / self.sample_time_s;
            self.now[axis] = [rate, acceleration, jerk];
            let pairs = self.largest[axis].iter_mut().zip(&self.now[axis]);
            pairs.for_each(|(largest, now)| *largest = largest.max(now.abs()));
        }
        self.torque_nm.copy_from_slice(torque_nm);
        self.velocity_rad_s.copy_from_slice(velocity_rad_s);
    }

    /// The value of an axis at the last sample; `None` of another quantity.
    pub(crate) fn now(&self, limit: Limit, axis: usize) -> Option<f64> {
        let place = QUANTITIES.iter().position(|of| *of == limit)?;
        Some(self.now[axis][place])
    }

    /// The largest sizes up to the last sample.
    pub(crate) fn largest(&self) -> Peaks {
        let of_axes = |place: usize| self.largest.iter().map(|values| values[place]).collect();
        (0..)
            .zip(QUANTITIES)
            .map(|(place, limit)| (limit, of_axes(place)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_counts_from_the_steady_motion() {
        let mut changes = Changes::steady(0.5, &[3.0], &[1.0]);
        changes.step(&[5.0], &[1.0]);
        assert_eq!(changes.now(Limit::TorqueRate, 0), Some(4.0));
        changes.step(&[4.0], &[2.0]);
        let now = [Limit::Acceleration, Limit::Jerk, Limit::Torque].map(|of| changes.now(of, 0));
        assert_eq!(now, [Some(2.0), Some(4.0), None]);
        let largest = changes.largest();
        assert_eq!(largest.get(Limit::TorqueRate), Some(&[4.0][..]));
    }
}
