//! Distortion of the runs of a plan: spectra on the lines that its multisine leaves out, and the levels they show.

use frfid_estimate::{Campaign, DetectionLines, EqualDraws, OnBoth, PeriodIndex, RunSpectra};
use frfid_signals::{Distortion, Excitation, Frf, Multisine, Plan};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;

/// Looks at the detection lines of a plan.
pub(super) struct DistortionOfRuns {
    pub(super) lines: DetectionLines,
    sample_time_s: f64,
}

impl DistortionOfRuns {
    /// For multisines that leave lines out, where the plant is asked for.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for lines that do not fit the period.
    pub(super) fn of_plan(
        plan: &Plan,
        options: &EstimateTable,
    ) -> Result<Option<Self>, ExperimentError> {
        let Excitation::Multisine(Multisine { grid, .. }) = &plan.excitation else {
            return Ok(None);
        };
        if options.response_but_plant().is_some() {
            return Ok(None);
        }
        let sample_time_s = plan.sample_time_s;
        let lines = DetectionLines::new(grid.n_samples, &grid.excited)?;
        Ok(lines.map(|lines| Self {
            lines,
            sample_time_s,
        }))
    }

    /// The lines, where a period is looked at.
    pub(super) fn lines_for(&self, place: PeriodIndex) -> Option<&DetectionLines> {
        DetectionLines::look_at(place.realization).then_some(&self.lines)
    }

    /// Levels of the periods that are complete; `None` where none is.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for spectra of different shapes.
    pub(super) fn levels(
        &self,
        periods: Vec<(PeriodIndex, RunSpectra)>,
        excited: &Campaign,
        (plant, equal_draws, n_glides): (&Frf, &[EqualDraws], usize),
    ) -> Result<Option<Distortion>, ExperimentError> {
        let mut free = self.lines.campaign(self.sample_time_s)?;
        for (place, run) in periods {
            free.insert(place, run)?;
        }
        free.drop_incomplete();
        if free.is_empty() {
            return Ok(None);
        }
        let spectra = OnBoth {
            excited,
            free: &free,
            equal_draws,
            n_glides,
        };
        Ok(Some(spectra.levels(&self.lines, plant)?))
    }
}
