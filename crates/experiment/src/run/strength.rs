//! Strength of the excitation of a campaign: whether friction was kept from hiding the resonances
//! (SK15 footnote 2).

use frfid_estimate::{AxisStrength, pooled_strength, strength, strength_warnings};
use frfid_files::Check;
use frfid_signals::{Record, RunId, RunKind};
use serde::Serialize;

use crate::experiment::Experiment;

/// Bands per octave.
const PER_OCTAVE: f64 = 3.0;

/// How the axes were driven and moved, over all runs of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Strength {
    /// One entry for each axis.
    pub axes: Vec<AxisStrength>,
    /// What was too weak, in words; empty if nothing was.
    pub warnings: Vec<String>,
}

impl Experiment {
    /// The strength of one run; `None` for a glide, or a run that was stopped before there was
    /// anything to tell.
    pub(crate) fn strength_of(&self, run: RunId, record: &Record) -> Option<Vec<AxisStrength>> {
        let is_excited = run.kind == RunKind::Excitation;
        is_excited
            .then(|| strength(record, &self.plan, &self.bands_hz()).ok())
            .flatten()
    }

    /// The strength of several runs as one; `None` of none, and without a model: of an
    /// input that is no torque nothing is known of friction.
    pub(crate) fn strength(&self, runs: &[Vec<AxisStrength>]) -> Option<Strength> {
        let coulomb_nm = self.robot.as_ref()?.coulomb_nm();
        let axes = pooled_strength(runs, Some(&coulomb_nm))?;
        let names = (1..=axes.len()).map(|axis| format!("axis {axis}"));
        let names: Vec<String> = names.collect();
        let warnings = strength_warnings(&axes, &names, Some(&coulomb_nm));
        Some(Strength { axes, warnings })
    }

    /// Bands of a third of an octave or less over what is excited.
    fn bands_hz(&self) -> Vec<[f64; 2]> {
        let waveform = self.plan.excitation.waveform();
        let [low_hz, mut high_hz] = waveform.band_hz();
        if waveform.is_periodic() {
            high_hz *= 1.000_001; // a line at the upper edge would belong to the next band
        }
        let count = (PER_OCTAVE * (high_hz / low_hz).log2()).ceil().max(1.0);
        let edge = |band: usize| low_hz * (high_hz / low_hz).powf(band as f64 / count);
        (0..count as usize)
            .map(|band| [edge(band), edge(band + 1)])
            .collect()
    }
}

impl Strength {
    /// Whether the measured velocity kept the direction of the constant velocity; `None` without
    /// one.
    pub(crate) fn sign_check(&self) -> Option<Check> {
        self.axes.iter().find_map(|axis| axis.crosses_zero)?;
        let slowest = self.axes.iter().map(|axis| axis.slowest_rad_s);
        let slowest: Vec<String> = slowest.map(|slowest| format!("{slowest:.4}")).collect();
        let slowest = slowest.join(", ");
        Some(Check {
            name: "velocity keeps its sign".into(),
            passed: !self.crosses_zero(),
            found: format!("at the slowest {slowest} rad/s"),
            needed: "the direction of the constant velocity in every sample".into(),
            advice: "raise the constant velocity, or lower the excitation".into(),
        })
    }

    /// Share of the time in which each axis stood.
    pub(crate) fn stuck_shares(&self) -> Vec<Option<f64>> {
        self.axes.iter().map(|axis| axis.stuck_share).collect()
    }

    /// Whether an axis left the direction of its constant velocity.
    #[must_use]
    pub fn crosses_zero(&self) -> bool {
        self.axes.iter().any(|axis| axis.crosses_zero == Some(true))
    }
}
