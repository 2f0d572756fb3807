//! Harmonics of the chirps of a plan.

use frfid_estimate::ChirpHarmonics;
use frfid_signals::{Excitation, Plan};

use crate::error::ExperimentError;

/// What shows the harmonics in the periods of a chirp; `None` of other excitations.
///
/// # Errors
/// [`ExperimentError::Estimate`] for a chirp that is not sound.
pub(super) fn harmonics_of_plan(plan: &Plan) -> Result<Option<ChirpHarmonics>, ExperimentError> {
    let Excitation::Chirp(chirp) = &plan.excitation else {
        return Ok(None);
    };
    let period_samples = plan.period_samples()?;
    let harmonics = ChirpHarmonics::new(chirp, plan.sample_time_s, period_samples)?;
    Ok(Some(harmonics))
}
