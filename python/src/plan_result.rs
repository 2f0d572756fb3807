//! From the records of a plan to its result, in memory.

use frfid_experiment::{Estimator, Experiment, ExperimentError, Peaks};
use frfid_files::ResultFile;
use frfid_signals::{Record, RunId, RunKind};

use crate::frf::Frf;

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
    let mut result = Frf::from(frf).result;
    let joints = description.config.robot.joint_names();
    result.input_names = joints.iter().map(|joint| format!("{joint} torque")).collect();
    result.output_names = joints.iter().map(|joint| format!("{joint} velocity")).collect();
    result.input_units.fill("N m".to_owned());
    result.output_units.fill("rad/s".to_owned());
    result.provenance = description.provenance();
    if let Some(peaks) = records.iter().map(|(_, record)| Peaks::of(record)).reduce(|a, b| a.max(&b)) {
        for (key, values) in [
            ("effort_peak_nm", peaks.effort_nm),
            ("effort_rms_nm", peaks.effort_rms_nm),
            ("velocity_peak_rad_s", peaks.velocity_rad_s),
        ] {
            result.provenance.insert(key.into(), format!("{values:?}"));
        }
    }
    Ok((result, missing.len()))
}
