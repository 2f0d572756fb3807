//! Changes of a robot from sample to sample, torque rate, acceleration and jerk, counted from the
//! steady motion before a run.

use frfid_signals::{Limit, Peaks};

/// The quantities, in the order in which they are kept.
const QUANTITIES: [Limit; 3] = [Limit::TorqueRate, Limit::Acceleration, Limit::Jerk];

/// What the torque that acts and the true motion change by.
#[derive(Debug, Clone)]
pub(crate) struct Changes {
    sample_time_s: f64,
    axes: Vec<AxisChanges>,
}

/// Those of an axis.
#[derive(Debug, Clone, Copy)]
struct AxisChanges {
    torque_nm: f64,
    velocity_rad_s: f64,
    /// Torque rate in N m/s, acceleration in rad/s^2, jerk in rad/s^3, as of the last sample.
    now: [f64; 3],
    /// Their largest sizes.
    largest: [f64; 3],
}

impl Changes {
    /// None yet: torques in N m hold steady velocities in rad/s.
    pub(crate) fn steady(sample_time_s: f64, torque_nm: &[f64], velocity_rad_s: &[f64]) -> Self {
        let of_axes = torque_nm.iter().zip(velocity_rad_s);
        let steady = |(&torque_nm, &velocity_rad_s): (&f64, &f64)| AxisChanges {
            torque_nm,
            velocity_rad_s,
            now: [0.0; 3],
            largest: [0.0; 3],
        };
        Self {
            sample_time_s,
            axes: of_axes.map(steady).collect(),
        }
    }

    /// Takes the torques that act from this sample on and the velocities at it.
    pub(crate) fn step(&mut self, torque_nm: &[f64], velocity_rad_s: &[f64]) {
        let sample_time_s = self.sample_time_s;
        for (axis, (&torque_nm, &velocity_rad_s)) in self
            .axes
            .iter_mut()
            .zip(torque_nm.iter().zip(velocity_rad_s))
        {
            let rate = (torque_nm - axis.torque_nm) / sample_time_s;
            let acceleration = (velocity_rad_s - axis.velocity_rad_s) / sample_time_s;
            let jerk = (acceleration - axis.now[1]) / sample_time_s;
            axis.now = [rate, acceleration, jerk];
            for (largest, now) in axis.largest.iter_mut().zip(axis.now) {
                *largest = largest.max(now.abs());
            }
            (axis.torque_nm, axis.velocity_rad_s) = (torque_nm, velocity_rad_s);
        }
    }

    /// The value of an axis at the last sample; `None` of another quantity.
    pub(crate) fn now(&self, limit: Limit, axis: usize) -> Option<f64> {
        let place = QUANTITIES.iter().position(|of| *of == limit)?;
        Some(self.axes[axis].now[place])
    }

    /// The largest sizes up to the last sample.
    pub(crate) fn largest(&self) -> Peaks {
        let of_axes = |place: usize| self.axes.iter().map(|axis| axis.largest[place]).collect();
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
