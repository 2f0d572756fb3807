//! Torque ripple of motor and gear: periodic in the motor position (SK15 section 2, challenge E).

use frfid_signals::SignalError;
use frfid_signals::checks::{finite, not_negative};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scalar::Scalar;

/// One harmonic of the ripple: `amplitude_nm sin(cycles_per_turn q + phase_rad)` is taken from the
/// motor torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ripple {
    /// Cycles per turn of `q`, the motor position on the joint side; behind a gear of ratio n, n
    /// times the cycles per turn of the motor shaft.
    pub cycles_per_turn: f64,
    /// Amplitude in N m on the joint side.
    pub amplitude_nm: f64,
    /// Phase in rad at position 0.
    #[serde(default)]
    pub phase_rad: f64,
}

impl Ripple {
    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] naming the first one that is not finite or out of range.
    pub fn check(&self) -> Result<(), SignalError> {
        not_negative("cycles_per_turn", self.cycles_per_turn)?;
        not_negative("amplitude_nm", self.amplitude_nm)?;
        finite("phase_rad", self.phase_rad)
    }
}

/// A harmonic in the numbers of one joint, or of several side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wave<L> {
    cycles_per_turn: L,
    pub(crate) amplitude_nm: L,
    phase_rad: L,
}

impl<L: Scalar> Wave<L> {
    /// A harmonic of each joint, zeros of one that has none.
    pub(crate) fn of(mut number: impl FnMut(fn(&Ripple) -> f64) -> L) -> Self {
        Self {
            cycles_per_turn: number(|ripple| ripple.cycles_per_turn),
            amplitude_nm: number(|ripple| ripple.amplitude_nm),
            phase_rad: number(|ripple| ripple.phase_rad),
        }
    }

    /// Angle in rad of the sine at a motor position in rad on the joint side.
    #[inline(always)]
    pub(crate) fn angle(&self, position_rad: L) -> L {
        self.cycles_per_turn * position_rad + self.phase_rad
    }
}
