//! From the records of a plan to its result, in memory.

use frfid_experiment::{Estimator, Experiment, ExperimentError, Peaks};
use frfid_files::ResultFile;
use frfid_signals::{Record, RunId, RunKind};

/// The FRF with names, units and provenance, amplitudes reached included, and the number of missing periods.
pub fn result_of(
    description: &Experiment,
    records: &[(RunId, Record)],
) -> Result<(ResultFile, usize), ExperimentError> {
    let mut estimator = Estimator::new(&description.plan, &description.config.estimate)?;
    let glides = records.iter().filter(|(id, _)| id.kind == RunKind::Glide);
    estimator.set_glides(&glides.map(|(_, record)| record.clone()).collect::<Vec<_>>())?;
    let mut spectra = Vec::new();
    for (id, record) in records {
        spectra.extend(estimator.spectra(*id, record, &|_| false)?);
    }
    let (frf, missing) = estimator.estimate(spectra)?;
    let (start, pose) = (description.plan.start_rad()?, description.config.robot.pose());
    let peaks = records.iter().map(|(_, record)| Peaks::of(record, &start, &pose)).reduce(|a, b| a.max(&b));
    Ok((description.result(frf, peaks.as_ref(), Vec::new()), missing.len()))
}
