//! PI controller with a low-pass and a notch on its torque, as servo drives have them.

use std::f64::consts::FRAC_1_SQRT_2;

use frfid_signals::SignalError;
use frfid_signals::checks::{not_negative, one_per_axis, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::control::biquad::Biquad;
use crate::control::controller::{Controller, ControllerAxis, LinearController, below_nyquist};
use crate::control::pi::PiController;

/// A PI controller whose torque passes a low-pass and a notch before it is limited.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FilteredPi {
    /// Gains, limits and delay: the table `[controller.pi]`.
    pub pi: PiController,
    /// A low-pass of second order; none without it.
    pub low_pass: Option<TorqueLowPass>,
    /// A notch, to keep clear of a resonance; none without it.
    pub notch: Option<TorqueNotch>,
}

/// A low-pass of second order on the torque: w^2 / (s^2 + 2 D w s + w^2), w = 2 pi corner_hz.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueLowPass {
    /// Corner in Hz, one for each axis, below the Nyquist frequency.
    pub corner_hz: Vec<f64>,
    /// Damping D, one for each axis; 0.707 (Butterworth) without it.
    pub damping: Option<Vec<f64>>,
}

/// A notch on the torque: (s^2 + g B s + w^2) / (s^2 + B s + w^2), w = 2 pi frequency_hz, B = 2 pi
/// width_hz.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TorqueNotch {
    /// Frequency in Hz that is taken out, one for each axis, below the Nyquist frequency.
    pub frequency_hz: Vec<f64>,
    /// Width in Hz between the frequencies at -3 dB (of a complete notch), one for each axis.
    pub width_hz: Vec<f64>,
    /// Gain g that is left at the frequency, one for each axis, 0 (complete, without it) to 1 (no
    /// notch).
    pub gain: Option<Vec<f64>>,
}

impl FilteredPi {
    /// The filters of an axis, in the order of the torque.
    fn filters(&self, axis: usize, sample_time_s: f64) -> Vec<Biquad> {
        let of_axis = |values: &Option<Vec<f64>>, default: f64| {
            values.as_ref().map_or(default, |values| values[axis])
        };
        let low_pass = self.low_pass.as_ref().map(|filter| {
            let damping = of_axis(&filter.damping, FRAC_1_SQRT_2);
            Biquad::low_pass(filter.corner_hz[axis], damping, sample_time_s)
        });
        let notch = self.notch.as_ref().map(|filter| {
            let (hz, gain) = (filter.frequency_hz[axis], of_axis(&filter.gain, 0.0));
            Biquad::notch(hz, filter.width_hz[axis], gain, sample_time_s)
        });
        low_pass.into_iter().chain(notch).collect()
    }
}

impl TorqueLowPass {
    fn check(&self, n_axes: usize, sample_time_s: f64) -> Result<(), SignalError> {
        check_hz("corner_hz", &self.corner_hz, n_axes, sample_time_s)?;
        one_per_axis("damping", self.damping.as_deref(), n_axes, positive)
    }
}

impl TorqueNotch {
    fn check(&self, n_axes: usize, sample_time_s: f64) -> Result<(), SignalError> {
        check_hz("frequency_hz", &self.frequency_hz, n_axes, sample_time_s)?;
        check_hz("width_hz", &self.width_hz, n_axes, sample_time_s)?;
        let gain = self.gain.as_deref();
        one_per_axis("gain", gain, n_axes, not_negative)?;
        let amplified = gain.unwrap_or_default().iter().find(|gain| **gain > 1.0);
        amplified.map_or(Ok(()), |&found| {
            let needed = "0 to 1: a notch takes out";
            Err(SignalError::parameter("gain", found, needed))
        })
    }
}

/// Checks that there is a frequency in Hz for each axis, above 0 and below the Nyquist frequency.
fn check_hz(
    key: &'static str,
    hz: &[f64],
    n_axes: usize,
    sample_time_s: f64,
) -> Result<(), SignalError> {
    one_per_axis(key, Some(hz), n_axes, positive)?;
    below_nyquist(key, hz, sample_time_s)
}

impl Controller for FilteredPi {
    fn check(&self, n_axes: usize, sample_time_s: f64) -> Result<(), SignalError> {
        let of = |table: &str, checked: Result<(), SignalError>| {
            checked.map_err(|error| error.within(table, vec![table.to_owned()]))
        };
        of("pi", self.pi.check(n_axes, sample_time_s))?;
        if let Some(low_pass) = &self.low_pass {
            of("low_pass", low_pass.check(n_axes, sample_time_s))?;
        }
        if let Some(notch) = &self.notch {
            of("notch", notch.check(n_axes, sample_time_s))?;
        }
        Ok(())
    }

    fn axis(&self, axis: usize, sample_time_s: f64, holding_nm: f64) -> Box<dyn ControllerAxis> {
        let filters = self.filters(axis, sample_time_s);
        self.pi
            .filtered_axis(axis, sample_time_s, holding_nm, filters)
    }

    fn linear(&self, axis: usize, sample_time_s: f64) -> LinearController {
        let filters = self.filters(axis, sample_time_s).into_iter();
        let pi = self.pi.linear(axis, sample_time_s);
        filters.fold(pi, |controller, filter| filter.behind(&controller))
    }

    fn position_gain_per_s(&self, axis: usize) -> f64 {
        self.pi.position_gain_per_s(axis)
    }

    fn gain_nms_per_rad(&self) -> &[f64] {
        self.pi.gain_nms_per_rad()
    }
}
