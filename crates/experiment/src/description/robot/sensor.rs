//! The table of sensors and torque resolution.

use frfid_plant::{Sensor, Velocity};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Sensors and torque resolution of an axis, on the joint side of the gear; whatever is not given
/// is ideal.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SensorTable {
    /// The velocity is the difference of the last two positions over the sample time, not the true
    /// velocity.
    pub velocity_by_differencing: bool,
    /// Position increment in rad: one encoder count on the joint side.
    pub position_increment_rad: Option<f64>,
    /// Rms of the white noise on the position in rad.
    pub position_noise_rad: Option<f64>,
    /// Rms of the white noise on the velocity in rad/s, before it is filtered.
    pub velocity_noise_rad_s: Option<f64>,
    /// Corner in Hz of a low-pass of first order on the velocity reading.
    pub velocity_filter_hz: Option<f64>,
    /// Resolution of the motor torque in N m.
    pub torque_quantum_nm: Option<f64>,
    /// Rms of the white noise on the torque reading in N m; with it the recorded input is a
    /// measurement.
    pub torque_noise_nm: Option<f64>,
}

impl SensorTable {
    /// The sensor of an axis.
    #[must_use]
    pub fn sensor(&self) -> Sensor {
        Sensor {
            velocity: if self.velocity_by_differencing {
                Velocity::Differenced
            } else {
                Velocity::True
            },
            position_increment_rad: self.position_increment_rad,
            position_noise_rad: self.position_noise_rad,
            velocity_noise_rad_s: self.velocity_noise_rad_s,
            velocity_filter_hz: self.velocity_filter_hz,
            torque_quantum_nm: self.torque_quantum_nm,
            torque_noise_nm: self.torque_noise_nm,
        }
    }
}
