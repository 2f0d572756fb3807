//! Random-phase multisines, SK15 (8) and (9): a grid of lines, an amplitude over frequency, and
//! their realizations.

mod design;
mod harmonic_sum;
mod low_crest;
mod realization;
#[cfg(test)]
mod tests;
mod true_peak;

use ndarray::Array3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::grid::LineGrid;
use crate::excitation::profile::Profile;
use crate::excitation::waveform::{Draw, Fact, GoOn, Waveform};
use crate::number::checks::{positive, require_shape};
use crate::number::format::{band, count, significant};

pub use design::MultisineDesign;
pub use realization::Realization;

/// How the phases of the lines are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Phases {
    /// Uniform on the circle, a new draw for each realization: what the best linear approximation
    /// needs.
    #[default]
    Random,
    /// Chosen for a low crest factor, the same in each realization; for designs that do not average
    /// over realizations.
    LowCrest,
}

/// A multisine `s(t) = sum_s A(f_s) sin(2 pi f_s t + phi_s)` on the excited lines of a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Multisine {
    /// Period and lines.
    pub grid: LineGrid,
    /// Shape of the amplitude over frequency; only ratios count, the peak is set by the
    /// realization.
    pub shape: Profile,
    /// Choice of phases.
    pub phases: Phases,
    /// Largest value that each channel may reach, in the unit of the injected quantity; as many as
    /// inputs.
    pub peak: Vec<f64>,
}

impl Multisine {
    /// The same amplitude on every line of a grid, with random phases.
    #[must_use]
    pub fn flat(grid: LineGrid, peak: Vec<f64>) -> Self {
        Self {
            grid,
            shape: Profile::constant(1.0),
            phases: Phases::Random,
            peak,
        }
    }
}

impl Waveform for Multisine {
    fn name(&self) -> &'static str {
        "multisine"
    }

    fn is_periodic(&self) -> bool {
        true
    }

    fn check_for(&self, n_inputs: usize) -> Result<(), SignalError> {
        self.grid.check()?;
        self.shape.check()?;
        let fits = n_inputs > 0 && self.peak.len() == n_inputs;
        let needed = format_args!("one peak for each of the {n_inputs} inputs, at least one");
        require_shape("peak", &[self.peak.len()], fits, needed)?;
        self.peak
            .iter()
            .try_for_each(|&peak| positive("peak", peak))
    }

    fn period_samples(&self, _sample_time_s: f64) -> Result<usize, SignalError> {
        Ok(self.grid.n_samples)
    }

    fn period(
        &self,
        _sample_time_s: f64,
        _n_inputs: usize,
        draw: &Draw,
        go_on: GoOn,
    ) -> Result<Array3<f64>, SignalError> {
        self.signal_while(draw, go_on)
    }

    fn band_hz(&self) -> [f64; 2] {
        let period_s = self.grid.period_s();
        let at = |line: Option<&usize>| line.map_or(0.0, |line| *line as f64 / period_s);
        [at(self.grid.excited.first()), at(self.grid.excited.last())]
    }

    fn peaks(&self) -> Vec<f64> {
        self.peak.clone()
    }

    /// One period.
    fn default_lead_in_s(&self) -> f64 {
        self.grid.period_s()
    }

    fn excited_s(&self, _sample_time_s: f64) -> f64 {
        self.grid.period_s()
    }

    fn seconds_in(&self, _band_hz: [f64; 2], _sample_time_s: f64) -> Option<[f64; 2]> {
        None
    }

    fn described(&self, _sample_time_s: f64) -> Vec<(&'static str, String)> {
        let (band, period_s) = (band(self.band_hz()), self.grid.period_s());
        let lines = count(self.grid.excited.len(), "line");
        vec![
            (self.name(), format!("{lines}, {band}")),
            ("period T", format!("{} s", significant(period_s, 6))),
            (
                "line spacing f0",
                format!("{} Hz", significant(1.0 / period_s, 4)),
            ),
        ]
    }

    fn facts(&self) -> Vec<(&'static str, Fact)> {
        vec![
            ("fundamental_hz", Fact::Value(1.0 / self.grid.period_s())),
            ("n_lines", Fact::Count(self.grid.excited.len())),
        ]
    }
}
