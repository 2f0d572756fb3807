//! What a simulation knows: the true motion, before any sensor.

use ndarray::Array2;

use crate::dynamics::State;

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

    /// Writes the state at a sample.
    pub(crate) fn set<const A: usize>(&mut self, sample: usize, state: &State<f64, A>) {
        for axis in 0..A {
            self.motor_position_rad[[axis, sample]] = state.motor_position[axis];
            self.motor_velocity_rad_s[[axis, sample]] = state.motor_velocity[axis];
            self.deflection_rad[[axis, sample]] = state.deflection[axis];
            self.link_velocity_rad_s[[axis, sample]] = state.link_velocity[axis];
        }
    }

    /// Writes the share of `duration_s` that each motor has been stuck.
    pub(crate) fn set_stuck<const A: usize>(&mut self, stuck_s: [f64; A], duration_s: f64) {
        for (share, stuck_s) in self.stuck_share.iter_mut().zip(stuck_s) {
            *share = if duration_s > 0.0 { stuck_s / duration_s } else { 0.0 };
        }
    }
}
