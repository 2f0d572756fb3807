//! The table of the controller.

use frfid_plant::PiController;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::text::Fault;

/// A sampled PI controller of the motor velocity: the reference is a velocity then.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControllerTable {
    /// Proportional gain in N m s/rad, one for each axis.
    pub gain_nms_per_rad: Vec<f64>,
    /// Integral gain in N m/rad, one for each axis.
    pub integral_gain_nm_per_rad: Vec<f64>,
    /// Whole samples from reading the velocity to the torque's acting.
    #[serde(default)]
    pub delay_samples: usize,
    /// Torque limit in N m, one for each axis; none without it.
    pub max_torque_nm: Option<Vec<f64>>,
    /// Largest change of the torque in N m/s, one for each axis; none without it.
    pub max_torque_rate_nm_per_s: Option<Vec<f64>>,
    /// Gain of a position loop around the velocity loop in 1/s, one for each axis; no position loop
    /// without it.
    pub position_gain_per_s: Option<Vec<f64>>,
}

impl ControllerTable {
    /// Checks every gain and limit for a robot of `n_axes`.
    pub(crate) fn check(&self, sample_time_s: f64, n_axes: usize) -> Result<(), Fault> {
        let checked = self.controller(sample_time_s).check(n_axes);
        checked.map_err(|error| {
            // the keys of the gains are their names with units
            let key = match error.path()[..] {
                ["gain"] => "gain_nms_per_rad",
                ["integral_gain"] => "integral_gain_nm_per_rad",
                ["position_gain"] => "position_gain_per_s",
                [key] => key,
                _ => "",
            };
            Fault::new(&[key], error.to_string())
        })
    }

    /// The controller on the clock of the experiment.
    #[must_use]
    pub fn controller(&self, sample_time_s: f64) -> PiController {
        PiController {
            gain: self.gain_nms_per_rad.clone(),
            integral_gain: self.integral_gain_nm_per_rad.clone(),
            sample_time_s,
            delay_samples: self.delay_samples,
            max_torque_nm: self.max_torque_nm.clone(),
            max_torque_rate_nm_per_s: self.max_torque_rate_nm_per_s.clone(),
            position_gain: self.position_gain_per_s.clone(),
        }
    }
}
