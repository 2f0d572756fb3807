//! From the records of a plan to its result, in memory.

use frfid_experiment::{Experiment, ExperimentError, Peaks, estimate_records};
use frfid_files::ResultFile;
use frfid_signals::{Record, RunId};

/// The FRF with names, units and provenance, amplitudes reached included, and the number of missing
/// periods.
pub fn result_of(
    description: &Experiment,
    records: &[(RunId, Record)],
) -> Result<(ResultFile, usize), ExperimentError> {
    let estimated = estimate_records(&description.plan, &description.config.estimate, records)?;
    let (start, pose) = (
        description.plan.start_rad()?,
        description.config.robot.pose(),
    );
    let peaks = records
        .iter()
        .map(|(_, record)| Peaks::of(record, &start, &pose))
        .reduce(|a, b| a.max(&b));
    Ok((
        description.result(estimated.frf, peaks.as_ref(), Vec::new()),
        estimated.missing.len(),
    ))
}
