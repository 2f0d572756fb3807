//! Harmonics of the chirps of a plan, run by run.

use frfid_estimate::{ChirpHarmonics, SweepSpectra};
use frfid_signals::{Excitation, Plan, Record};
use ndarray::s;

use crate::error::ExperimentError;

/// What shows the harmonics in the runs of a plan.
pub(super) struct HarmonicsOfRuns {
    pub(super) planned: ChirpHarmonics,
    lead_in_samples: usize,
    period_samples: usize,
}

impl HarmonicsOfRuns {
    /// Of a chirp; `None` of other excitations.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for a chirp that is not sound.
    pub(super) fn of_plan(plan: &Plan) -> Result<Option<Self>, ExperimentError> {
        let Excitation::Chirp(chirp) = &plan.excitation else {
            return Ok(None);
        };
        let period_samples = plan.period_samples()?;
        Ok(Some(Self {
            planned: ChirpHarmonics::new(chirp, plan.sample_time_s, period_samples)?,
            lead_in_samples: plan.lead_in_samples,
            period_samples,
        }))
    }

    /// Spectra of a period that the record holds to its end.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for samples that are not finite.
    pub(super) fn spectra(
        &self,
        record: &Record,
        period: usize,
    ) -> Result<SweepSpectra, ExperimentError> {
        let start = self.lead_in_samples + period * self.period_samples;
        let window = s![.., start..start + self.period_samples];
        Ok(self
            .planned
            .spectra(record.u.slice(window), record.y.slice(window))?)
    }
}
