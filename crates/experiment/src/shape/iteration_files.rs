//! Files of one iteration of a shaping: FRFs, errors, and where they come from.

use std::fmt::Write;
use std::path::Path;

use frfid_estimate as estimate;
use frfid_files::{
    Check, FileError, Overwrite, ResultFile, sha256_file, write_bytes, write_result,
};
use frfid_signals::{Frf, Record, RunId};

use crate::error::ExperimentError;
use crate::estimate::estimator::Estimator;
use crate::estimate::outcome::{condition_check, log_hashes};
use crate::experiment::Experiment;
use crate::run::load::Load;
use crate::run::provenance::Metadata;

/// FRF from motor torque to motor velocity.
const U_TO_Y: &str = "u_to_y.json";
/// Response from the reference to the motor torque.
const RESPONSE: &str = "response.json";
/// Error per frequency and axis.
const ERRORS: &str = "errors.csv";
/// The files of an iteration besides its runs.
pub(crate) const NAMES: [&str; 3] = [U_TO_Y, RESPONSE, ERRORS];
/// FRF of the best iteration, in the folder of the shaping.
pub(crate) const BEST: &str = "frf.json";

/// Folder of an iteration.
pub(crate) fn iteration_name(number: usize) -> String {
    format!("iteration_{number:02}")
}

/// Writes the files of iterations.
pub(crate) struct IterationFiles<'a> {
    experiment: &'a Experiment,
    /// Provenance of the experiment.
    pub metadata: Metadata,
    estimator: Estimator,
}

impl<'a> IterationFiles<'a> {
    /// For the iterations of an experiment.
    pub(crate) fn new(experiment: &'a Experiment) -> Result<Self, ExperimentError> {
        let estimator = Estimator::new(&experiment.plan, &experiment.config.estimate)?;
        Ok(Self {
            experiment,
            metadata: experiment.provenance(),
            estimator,
        })
    }

    /// The FRF from motor torque to motor velocity, by excerpts of the chirp.
    pub(crate) fn frf(&self, records: &[Record]) -> Result<Frf, ExperimentError> {
        self.estimator.frf_of_experiments(records)
    }

    /// The load of all runs of an iteration, which began at the pose.
    fn load_of(&self, iteration: &estimate::Iteration) -> Option<Load> {
        let pose_rad = &self.experiment.pose_rad;
        let start_rad = vec![0.0; pose_rad.len()];
        let load = |record| Load::of(record, &start_rad, pose_rad);
        Load::largest(iteration.records.iter().map(load))
    }

    /// Whether U of an iteration can be inverted well.
    pub(crate) fn condition_check(&self, frf: &Frf, iteration: &estimate::Iteration) -> Check {
        let torques = self.load_of(iteration).map(|load| load.torque_rms_nm);
        condition_check(frf, &torques.unwrap_or_default())
    }

    /// Writes FRFs and errors beside the runs in `folder`; returns the hash of every file.
    pub(crate) fn write(
        &self,
        iteration: &estimate::Iteration,
        frf: Option<Frf>,
        folder: &Path,
    ) -> Result<Metadata, ExperimentError> {
        let mut names: Vec<String> = run_names(iteration).collect();
        if let Some(frf) = frf {
            let checks = vec![self.condition_check(&frf, iteration)];
            let result = self.result(frf, iteration, folder, checks)?;
            write_result(&folder.join(U_TO_Y), Overwrite::Replace, &result)?;
            names.push(U_TO_Y.into());
        }
        if let Some(estimate) = &iteration.estimate {
            self.write_response(estimate, folder)?;
            names.extend([RESPONSE.into(), ERRORS.into()]);
        }
        hashed(folder, names)
    }

    /// Writes the response from the reference and the errors over frequency.
    fn write_response(
        &self,
        estimate: &estimate::Estimate,
        folder: &Path,
    ) -> Result<(), FileError> {
        let response = self.response(estimate.r_to_u.clone());
        write_result(&folder.join(RESPONSE), Overwrite::Replace, &response)?;
        let errors = errors_csv(estimate);
        write_bytes(&folder.join(ERRORS), Overwrite::Replace, errors.as_bytes())
    }

    /// The FRF of an iteration with the runs in `folder` as a result.
    pub(crate) fn result(
        &self,
        frf: Frf,
        iteration: &estimate::Iteration,
        folder: &Path,
        checks: Vec<Check>,
    ) -> Result<ResultFile, ExperimentError> {
        let load = self.load_of(iteration);
        let mut result = ResultFile {
            checks,
            ..self.experiment.result(frf, load.as_ref())
        };
        let provenance = &mut result.provenance;
        provenance.insert("iteration".into(), iteration.number.to_string());
        let runs = run_names(iteration).map(|name| folder.join(name));
        log_hashes(&runs.collect::<Vec<_>>(), provenance)?;
        Ok(result)
    }

    /// The response from the reference to the motor torque as a result.
    fn response(&self, frf: Frf) -> ResultFile {
        let joints = self.experiment.joint_names.clone();
        let named = |quantity: &str| {
            let names = joints.iter().map(|joint| format!("{joint} {quantity}"));
            names.collect()
        };
        ResultFile {
            input_names: named("reference"),
            output_names: named("torque"),
            input_units: vec!["rad/s".into(); joints.len()],
            output_units: vec!["N m".into(); joints.len()],
            provenance: self.metadata.clone(),
            ..ResultFile::torque_to_velocity(frf, &joints)
        }
    }
}

fn run_id(realization: usize, experiment: usize) -> RunId {
    RunId::excitation(realization, experiment, 0)
}

/// The hash of every file of these names.
fn hashed(folder: &Path, names: Vec<String>) -> Result<Metadata, ExperimentError> {
    names
        .into_iter()
        .map(|name| {
            let hash = sha256_file(&folder.join(&name))?;
            Ok((name, hash))
        })
        .collect()
}

/// Files of the runs of an iteration.
fn run_names(iteration: &estimate::Iteration) -> impl Iterator<Item = String> {
    let runs = 0..iteration.records.len();
    runs.map(|experiment| format!("{}.mcap", run_id(iteration.number, experiment)))
}

/// The relative error of each axis and the condition number of U over frequency.
fn errors_csv(estimate: &estimate::Estimate) -> String {
    let errors = &estimate.error_per_frequency;
    let axes = (1..=errors.ncols()).map(|axis| format!("error_axis_{axis},"));
    let mut text = format!("frequency_hz,{}condition\n", axes.collect::<String>());
    let frequency_hz = estimate.r_to_u.frequency_hz.iter();
    let lines = frequency_hz.zip(errors.rows()).zip(&estimate.condition);
    for ((hz, errors), condition) in lines {
        let errors: String = errors.iter().map(|error| format!("{error},")).collect();
        writeln!(text, "{hz},{errors}{condition}").expect("a text can always be written");
    }
    text
}
