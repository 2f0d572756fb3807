//! Spectra of the records of a plan, in any order.

use frfid_estimate::{PeriodIndex, RunSpectra, SweepSpectra};

use crate::estimate::estimator::friction::Subtracted;
use crate::estimate::estimator::friction_of_axes::FrictionSigns;
use crate::estimate::excerpt_bias::WholeSpectra;
use crate::estimate::glides::ripple_residual::FreeSpectra;

/// Spectra of records, in any order.
#[derive(Debug, Clone, Default)]
pub struct Spectra {
    /// On the lines of the estimate, period by period.
    pub(super) periods: Vec<(PeriodIndex, RunSpectra)>,
    /// On the detection lines, of some of these periods.
    pub(super) detection: Vec<(PeriodIndex, RunSpectra)>,
    /// On the lines around them that are not excited.
    pub(super) free: Vec<FreeSpectra>,
    /// Of whole chirps, period by period.
    pub(super) whole: WholeSpectra,
    /// Of chirps with the lines of their harmonics, period by period.
    pub(super) sweeps: Vec<(PeriodIndex, SweepSpectra)>,
    /// Friction that was taken off the runs of one axis.
    pub(super) friction: Vec<Subtracted>,
    /// What runs say of the friction of several axes, in the order of the periods.
    pub(super) signs: FrictionSigns,
    /// Variance in s^2 of the time by which the noise of the glides is shifted in each run.
    pub(super) wander_s2: Vec<f64>,
}

impl Spectra {
    /// Number of periods of runs.
    #[must_use]
    pub fn n_periods(&self) -> usize {
        self.periods.len()
    }

    /// Adds those of other records.
    pub fn extend(&mut self, other: Self) {
        self.periods.extend(other.periods);
        self.detection.extend(other.detection);
        self.free.extend(other.free);
        self.whole.extend(other.whole);
        self.sweeps.extend(other.sweeps);
        self.friction.extend(other.friction);
        self.signs.extend(other.signs);
        self.wander_s2.extend(other.wander_s2);
    }
}
