//! Trajectory of a simulation: the true motion, before any sensor.

use ndarray::Array2;

use crate::motion::Motion;

/// The true motion at the sample instants, `(channel, sample)`, and how long the motors were stuck.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Motor position in rad.
    pub motor_position_rad: Array2<f64>,
    /// Motor velocity in rad/s, exactly 0 while stuck.
    pub motor_velocity_rad_s: Array2<f64>,
    /// Deflection of the gear in rad.
    pub deflection_rad: Array2<f64>,
    /// Link velocity in rad/s.
    pub link_velocity_rad_s: Array2<f64>,
    /// Share of the time that each motor was stuck, exact, from 0 to 1.
    pub stuck_share: Vec<f64>,
}

impl Trajectory {
    /// Room for the motion of `n_axes` over `n_samples`.
    pub(crate) fn zeros(sample_time_s: f64, n_axes: usize, n_samples: usize) -> Self {
        let zeros = || Array2::zeros((n_axes, n_samples));
        Self {
            sample_time_s,
            motor_position_rad: zeros(),
            motor_velocity_rad_s: zeros(),
            deflection_rad: zeros(),
            link_velocity_rad_s: zeros(),
            stuck_share: vec![0.0; n_axes],
        }
    }

    /// Writes the motion at a sample.
    pub(crate) fn set(&mut self, sample: usize, motion: &dyn Motion) {
        let signals = [
            (&mut self.motor_position_rad, motion.motor_position_rad()),
            (
                &mut self.motor_velocity_rad_s,
                motion.motor_velocity_rad_s(),
            ),
            (&mut self.deflection_rad, motion.deflection_rad()),
            (&mut self.link_velocity_rad_s, motion.link_velocity_rad_s()),
        ];
        for (signal, values) in signals {
            for (axis, value) in values.iter().enumerate() {
                signal[[axis, sample]] = *value;
            }
        }
    }

    /// Writes the share of the time that each motor has been stuck.
    pub(crate) fn set_stuck(&mut self, motion: &dyn Motion) {
        self.stuck_share = stuck_share(motion);
    }
}

/// Share of the time that each motor has been stuck, 0 before it has moved on.
pub(crate) fn stuck_share(motion: &dyn Motion) -> Vec<f64> {
    let duration_s = motion.time_s();
    let share = |stuck_s: &f64| {
        if duration_s > 0.0 {
            stuck_s / duration_s
        } else {
            0.0
        }
    };
    motion.stuck_s().iter().map(share).collect()
}
