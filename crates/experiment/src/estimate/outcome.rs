//! The result of an estimate, with its checks and where it came from, ready to be written.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use frfid_files::{Check, LogMap, Loss, ResultFile, sha256_file};
use frfid_signals::Frf;

use crate::description::estimate::EstimateTable;
use crate::design::predict::Peaks;
use crate::error::ExperimentError;
use crate::estimate::others_logs::estimate_foreign;
use crate::estimate::our_logs::{OwnLogs, estimate_own, find_logs};
use crate::estimate::strength::Strength;
use crate::experiment::Experiment;
use crate::run::parallel::Progress;

/// Largest condition number of U that passes the check.
const GOOD_CONDITION: f64 = 20.0;

/// How logs become a result.
#[derive(Debug, Clone, Default)]
pub struct EstimateOptions {
    /// Replaces the `[estimate]` table that travelled with our own logs; the default for foreign
    /// ones.
    pub estimate: Option<EstimateTable>,
    /// Which signal is which, for recordings that frfid did not make.
    pub map: Option<LogMap>,
    /// Files read at once; 0: one for each core.
    pub jobs: usize,
}

/// What was estimated, and what a careful reader should know besides.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// FRF, checks and provenance.
    pub result: ResultFile,
    /// Warnings, in words; empty if nothing was lost and nothing was odd.
    pub warnings: Vec<String>,
    /// Whether data was lost: then the estimate holds, but of less than was recorded.
    pub is_lossy: bool,
    /// How the axes were driven and moved; `None` for foreign recordings.
    pub strength: Option<Strength>,
}

/// Estimates the FRF of the logs in files and folders: our own by what travelled with them, foreign
/// ones by `options.map`.
///
/// # Errors
/// [`ExperimentError`].
pub fn estimate_logs(
    paths: &[PathBuf],
    options: &EstimateOptions,
    progress: Progress,
) -> Result<Estimate, ExperimentError> {
    let paths = find_logs(paths)?;
    match &options.map {
        Some(map) => foreign(&paths, map, options),
        None => {
            let logs = estimate_own(&paths, options.estimate.as_ref(), options.jobs, progress)?;
            own(&paths, logs)
        }
    }
}

fn own(paths: &[PathBuf], logs: OwnLogs) -> Result<Estimate, ExperimentError> {
    let OwnLogs {
        estimated,
        experiment,
        n_files,
        unreadable,
        losses,
        peaks,
        strength,
    } = logs;
    let n_runs = experiment.plan.n_runs();
    let mut warnings: Vec<String> = unreadable
        .iter()
        .map(|(path, error)| format!("{}: not used: {error}", path.display()))
        .collect();
    warnings.extend(in_words(&losses));
    if !estimated.missing.is_empty() {
        warnings.push(format!(
            "{} periods are not in the estimate, because not all of their experiments are whole",
            estimated.missing.len()
        ));
    }
    let flawed: BTreeSet<&PathBuf> = losses.iter().map(|(path, _)| path).collect();
    let complete = Check {
        name: "runs".into(),
        passed: n_files == n_runs && losses.is_empty() && estimated.missing.is_empty(),
        found: format!("{n_files}, {} with losses", flawed.len()),
        needed: format!("{n_runs} whole ones"),
        advice: "do the missing runs (frfid run goes on where it stopped) and estimate again"
            .into(),
    };
    let is_lossy = !complete.passed;
    warnings.extend(
        strength
            .iter()
            .flat_map(|strength| strength.warnings.iter().cloned()),
    );
    let mut checks = vec![
        complete,
        condition_check(&estimated.frf, efforts(peaks.as_ref())),
    ];
    checks.extend(strength.as_ref().and_then(Strength::sign_check));
    let disturbed = estimated.disturbed_hz();
    warnings.extend(ripple_warning(&disturbed, estimated.frf.n_frequencies()));
    let mut result = experiment.result(estimated.frf, peaks.as_ref(), checks);
    if !disturbed.is_empty() {
        result
            .provenance
            .insert("ripple_above_noise_hz".into(), format!("{disturbed:.3?}"));
    }
    log_hashes(paths, &mut result.provenance)?;
    Ok(Estimate {
        result,
        warnings,
        is_lossy,
        strength,
    })
}

/// Says at which lines the ripple is not cured.
fn ripple_warning(disturbed_hz: &[f64], n_lines: usize) -> Option<String> {
    let (first, last) = (disturbed_hz.first()?, disturbed_hz.last()?);
    Some(format!(
        "what remains of the torque ripple exceeds the noise at {} of {n_lines} lines, the first at {first:.3} Hz and the last at \
         {last:.3} Hz: there the noise variance says too little, trust the total variance",
        disturbed_hz.len()
    ))
}

impl Experiment {
    /// An FRF of this experiment as a result: names and units of the joints, and where it came
    /// from, the amplitudes reached included.
    #[must_use]
    pub fn result(&self, frf: Frf, peaks: Option<&Peaks>, checks: Vec<Check>) -> ResultFile {
        let joints = self.config.robot.joint_names();
        let mut provenance = self.provenance();
        provenance.insert("experiment_toml".into(), self.to_toml());
        if let Some(peaks) = peaks {
            for (key, values) in [
                ("effort_peak_nm", &peaks.effort_nm),
                ("effort_rms_nm", &peaks.effort_rms_nm),
                ("velocity_peak_rad_s", &peaks.velocity_rad_s),
            ] {
                provenance.insert(key.into(), format!("{values:?}"));
            }
        }
        ResultFile {
            input_names: joints
                .iter()
                .map(|joint| format!("{joint} torque"))
                .collect(),
            output_names: joints
                .iter()
                .map(|joint| format!("{joint} velocity"))
                .collect(),
            input_units: vec!["N m".into(); frf.n_inputs()],
            output_units: vec!["rad/s".into(); frf.n_outputs()],
            frf,
            checks,
            provenance,
        }
    }
}

fn foreign(
    paths: &[PathBuf],
    map: &LogMap,
    options: &EstimateOptions,
) -> Result<Estimate, ExperimentError> {
    let found = estimate_foreign(paths, map, &options.estimate.clone().unwrap_or_default())?;
    let mut warnings = in_words(&found.losses);
    warnings.extend(
        found
            .warnings
            .iter()
            .map(|(path, warning)| format!("{}: {warning}", path.display())),
    );
    let used = found.n_periods - found.n_transient;
    let periods = Check {
        name: "periods".into(),
        passed: used >= 2 && found.losses.is_empty(),
        found: format!(
            "{used} of {} samples, after {} transient",
            found.period_samples, found.n_transient
        ),
        needed: "2 or more whole ones, for the noise to be known".into(),
        advice: "record more periods back to back".into(),
    };
    let settled = Check {
        name: "settled".into(),
        passed: found.n_periods >= 3,
        found: format!("{} periods", found.n_periods),
        needed: "3 or more, to tell a transient from the steady state".into(),
        advice: "record more periods back to back; until then the first one may be transient"
            .into(),
    };
    let mut provenance = BTreeMap::from([
        (
            "frfid_version".to_owned(),
            env!("CARGO_PKG_VERSION").to_owned(),
        ),
        (
            "period_samples".to_owned(),
            found.period_samples.to_string(),
        ),
        ("periods_used".to_owned(), used.to_string()),
        (
            "transient_periods_dropped".to_owned(),
            found.n_transient.to_string(),
        ),
    ]);
    log_hashes(paths, &mut provenance)?;
    let is_lossy = !found.losses.is_empty();
    let result = ResultFile {
        checks: vec![periods, settled, condition_check(&found.frf, &[])],
        frf: found.frf,
        input_names: found.names.inputs,
        output_names: found.names.outputs,
        input_units: found.names.input_units,
        output_units: found.names.output_units,
        provenance,
    };
    Ok(Estimate {
        result,
        warnings,
        is_lossy,
        strength: None,
    })
}

/// What was lost, in words, the first few of each file.
fn in_words(losses: &[(PathBuf, Loss)]) -> Vec<String> {
    losses
        .iter()
        .map(|(path, loss)| format!("{}: {loss}", path.display()))
        .collect()
}

/// Rms of the torque of every axis in N m, where it is known.
fn efforts(peaks: Option<&Peaks>) -> &[f64] {
    peaks.map_or(&[], |peaks| &peaks.effort_rms_nm)
}

/// Whether U could be inverted well. Torques of `effort_rms_nm` side by side make the condition
/// number as large as their spread and cost nothing: what counts is what it is beyond that.
pub(crate) fn condition_check(frf: &Frf, effort_rms_nm: &[f64]) -> Check {
    let worst = frf.condition.iter().flatten().copied().fold(1.0, f64::max);
    let (low, high) = effort_rms_nm
        .iter()
        .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), &rms| {
            (low.min(rms), high.max(rms))
        });
    let spread = if low > 0.0 && low < high {
        high / low
    } else {
        1.0
    };
    let share = if spread > 2.0 {
        format!(", {spread:.1} of it from the spread of the torques")
    } else {
        String::new()
    };
    Check {
        name: "condition number of U".into(),
        passed: worst <= GOOD_CONDITION * spread,
        found: format!("{worst:.2} at worst{share}"),
        needed: format!("{:.0} or less", GOOD_CONDITION * spread),
        advice:
            "excite the inputs more differently from experiment to experiment, and equally strongly"
                .into(),
    }
}

/// The hash of every log, so that a result can be traced to its data.
fn log_hashes(
    paths: &[PathBuf],
    provenance: &mut BTreeMap<String, String>,
) -> Result<(), ExperimentError> {
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        provenance.insert(format!("sha256 of {name}"), sha256_file(path)?);
    }
    Ok(())
}
