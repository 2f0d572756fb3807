//! Local models of a campaign ([`crate::frf::local`]): every frequency from many lines around it, so that
//! one experiment can do for all inputs, and whole records of a sweep for its excerpts.

use crate::error::EstimateError;
use crate::frf::estimate::FrfEstimate;
use crate::frf::local::{LocalModel, LocalOptions, estimate_campaign};
use crate::frf::{FrfMethod, FrfOptions};
use crate::spectra::campaign::Campaign;

/// The estimate by models of this kind, through the reference where there is one.
pub(crate) struct LocalModels(pub(crate) LocalModel);

impl FrfMethod for LocalModels {
    fn needs_reference(&self) -> bool {
        false
    }

    fn takes_reference(&self) -> bool {
        true
    }

    fn frf(&self, campaign: &Campaign, options: &FrfOptions) -> Result<FrfEstimate, EstimateError> {
        let options = LocalOptions {
            model: self.0,
            half_width: options.half_width,
            max_condition: options.max_condition,
        };
        Ok(estimate_campaign(campaign, campaign.at_hz(), &options)?.estimate)
    }
}
