//! Table `[multisine]` of a description.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::design::{Design, Target};
use crate::excitation::grid::{GridDesign, GridKind};
use crate::excitation::multisine::{Multisine, Phases};
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Profile;
use crate::excitation::{Excitation, Injection};
use crate::number::checks::amplitude;

/// A random-phase multisine (SK15 section 4): the table `[multisine]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MultisineDesign {
    /// Lower end of the band in Hz.
    pub low_hz: f64,
    /// Upper end of the band in Hz.
    pub high_hz: f64,
    /// Largest spacing of the lines in Hz: the period becomes at least its inverse.
    pub resolution_hz: f64,
    /// Number of logarithmically spaced frequencies before those on the same line merge; every line
    /// without it.
    pub n_lines: Option<usize>,
    /// Lines that may be excited: odd, full or odd-random.
    #[serde(default)]
    pub grid: GridKind,
    /// Largest motor torque in N m, one for each input; for experiments in open loop.
    pub peak_nm: Option<Vec<f64>>,
    /// Largest reference velocity in rad/s, one for each input; for experiments in closed loop.
    pub peak_rad_s: Option<Vec<f64>>,
    /// Largest value in the unit of each channel, where `[channels]` stand in the place of a robot.
    pub peak: Option<Vec<f64>>,
    /// Largest reference velocity as a share of the constant velocity beneath it, instead of
    /// `peak_rad_s`: below 1 the reference never changes its direction (SK15 takes 0.75).
    pub peak_of_velocity: Option<f64>,
    /// Shape of the amplitude over frequency as points [Hz, value]; only ratios count. Flat without
    /// it.
    pub shape: Option<Profile>,
    /// Random phases, or low-crest ones where no averaging over realizations is wanted.
    #[serde(default)]
    pub phases: Phases,
    /// Phases between channels and experiments: orthogonal, sign-flip, independent,
    /// one-at-a-time, all-at-once or zippered.
    #[serde(default)]
    pub mimo: Phasing,
}

impl Design for MultisineDesign {
    fn phasing(&self) -> Phasing {
        self.mimo
    }

    fn excitation(&self, target: &Target) -> Result<Excitation, SignalError> {
        let design = GridDesign {
            low_hz: self.low_hz,
            high_hz: self.high_hz,
            sample_time_s: target.sample_time_s,
            resolution_hz: self.resolution_hz,
            n_lines: self.n_lines,
            kind: self.grid,
            seed: target.seed,
        };
        let peak = self.peak(target)?;
        Ok(Excitation::Multisine(Multisine {
            grid: design.design()?,
            shape: self.shape.clone().unwrap_or_else(|| Profile::constant(1.0)),
            phases: self.phases,
            peak,
        }))
    }

    fn ride(&self, excitation: &mut Excitation, velocity_rad_s: &[f64]) -> Result<(), SignalError> {
        let (Some(share), Excitation::Multisine(Multisine { peak, .. })) =
            (self.peak_of_velocity, excitation)
        else {
            return Ok(());
        };
        *peak = velocity_rad_s
            .iter()
            .map(|velocity| share * velocity.abs())
            .collect();
        if peak.iter().all(|peak| peak.is_finite() && *peak > 0.0) {
            return Ok(());
        }
        let what = format!(
            "{share} of the constant velocities {velocity_rad_s:?} rad/s leaves no peak; needed: a share \
             above 0 and a constant velocity on every axis"
        );
        Err(SignalError::unfit("peak_of_velocity", what))
    }
}

impl MultisineDesign {
    /// Largest value per channel; 1 where it is put in its place when the velocity is known.
    fn peak(&self, target: &Target) -> Result<Vec<f64>, SignalError> {
        let keys = [
            ("peak_nm", &self.peak_nm),
            ("peak_rad_s", &self.peak_rad_s),
            ("peak", &self.peak),
        ];
        if self.peak_of_velocity.is_none() {
            return target.of_injection(keys, |key, &peak| amplitude(key, peak));
        }
        let is_closed = target.injection == Injection::Velocity && !target.is_of_channels;
        if is_closed && keys.iter().all(|(_, peak)| peak.is_none()) {
            return Ok(vec![1.0; target.n_inputs]);
        }
        let what = "a share of the velocity is for experiments in closed loop, and instead of another \
                    peak";
        Err(SignalError::unfit("peak_of_velocity", what))
    }
}
