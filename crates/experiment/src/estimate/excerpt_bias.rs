//! Bias of a chirp's excerpts in a campaign: spectra of the whole chirps beside those of the
//! excerpts.

use frfid_estimate::{Campaign, Method, PeriodIndex, RunSpectra, WholeRecord, add_excerpt_bias};
use frfid_signals::{Excitation, Frf, Plan};
use ndarray::ArrayView2;

use crate::error::ExperimentError;

/// What shows the bias of the excerpts of a plan's chirp.
pub(crate) struct ExcerptBias {
    pub(crate) whole: WholeRecord,
}

/// Spectra of whole chirps, period by period.
pub(crate) type WholeSpectra = Vec<(PeriodIndex, RunSpectra)>;

impl ExcerptBias {
    /// For excerpts of chirps that are repeated: without repeats there is no region that must hold the bias.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for lines that do not fit the period.
    pub(crate) fn of_plan(plan: &Plan, method: Method) -> Result<Option<Self>, ExperimentError> {
        let Excitation::Chirp(chirp) = &plan.excitation else {
            return Ok(None);
        };
        if method.local_model().is_some() || plan.n_repetitions * plan.n_periods < 2 {
            return Ok(None);
        }
        let period_samples = plan.period_samples()?;
        let whole = WholeRecord::of_band(chirp, plan.sample_time_s, period_samples)?;
        Ok(Some(Self { whole }))
    }

    /// Spectra of the whole chirp in a period.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for samples that are not finite.
    pub(crate) fn spectra(
        &self,
        u: ArrayView2<f64>,
        y: ArrayView2<f64>,
    ) -> Result<RunSpectra, ExperimentError> {
        Ok(RunSpectra::of(&self.whole, u, y, None)?)
    }

    /// Adds the bias to the covariances of the FRF by excerpts.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for spectra of different shapes.
    pub(crate) fn add_to(
        &self,
        frf: &mut Frf,
        spectra: WholeSpectra,
    ) -> Result<(), ExperimentError> {
        let mut campaign: Campaign = self.whole.campaign()?;
        for (place, run) in spectra {
            campaign.insert(place, run)?;
        }
        campaign.drop_incomplete();
        Ok(add_excerpt_bias(frf, &campaign)?)
    }
}
