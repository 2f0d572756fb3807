//! Estimates: from the records of a plan, or of somebody else, to an FRF with its checks.

pub(crate) mod digest;
pub(crate) mod estimator;
mod excerpt_bias;
pub(crate) mod find_logs;
pub(crate) mod gather;
/// Glides: what is taken off, what their noise adds, and what remains of the ripple.
pub(crate) mod glides {
    pub(crate) mod glide_baseline;
    pub(crate) mod glide_spectra;
    pub(crate) mod ripple_residual;
}
pub(crate) mod loop_response;
pub(crate) mod majority;
pub(crate) mod names;
pub(crate) mod others;
pub(crate) mod our_logs;
pub(crate) mod outcome;
pub(crate) mod records;
pub(crate) mod unsettled;
pub(crate) mod verdicts;
pub(crate) mod way;

use std::path::PathBuf;

use frfid_files::LogMap;

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::find_logs::recordings_among;
use crate::estimate::others::estimate_others_logs;
use crate::estimate::our_logs::estimate_our_logs;
use crate::estimate::outcome::Outcome;
use crate::run::parallel::Progress;

/// How logs become a result.
#[derive(Debug, Clone, Default)]
pub struct EstimateOptions {
    /// Replaces the `[estimate]` table that travelled with our own logs; the default for those of
    /// others.
    pub estimate: Option<EstimateTable>,
    /// Which signal is which, for recordings that frfid did not make.
    pub map: Option<LogMap>,
    /// Files read at once; 0: one for each core.
    pub jobs: usize,
}

/// Estimates the FRF of the logs in files and folders: our own by what travelled with them, those
/// of others by `options.map`.
///
/// # Errors
/// [`ExperimentError`].
pub fn estimate_logs(
    paths: &[PathBuf],
    options: &EstimateOptions,
    progress: Progress,
) -> Result<Outcome, ExperimentError> {
    let paths = recordings_among(paths)?;
    let estimate = options.estimate.as_ref();
    let checked = estimate.map_or(Ok(()), EstimateTable::check);
    checked.map_err(|fault| fault.without_text("estimate"))?;
    match &options.map {
        Some(map) => estimate_others_logs(&paths, map, &estimate.cloned().unwrap_or_default()),
        None => estimate_our_logs(&paths, estimate, options.jobs, progress),
    }
}
