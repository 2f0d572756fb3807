//! Logs of others, recordings that frfid did not make, to an FRF: period, transient and lines are
//! found in the reference.

use std::path::PathBuf;

use frfid_estimate::{
    Campaign, EstimateError, LineDft, PeriodIndex, RunSpectra, count_transient_periods, find_lines,
    find_period,
};
use frfid_files::{Check, Log, LogMap, Loss, ResultFile, read_log};
use frfid_signals::Frf;
use ndarray::{Array2, ArrayView2, s};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::outcome::{Outcome, condition_check, log_hashes};
use crate::run::provenance::{Metadata, metadata};

/// Estimates the FRF from recordings of a periodic excitation, one for each experiment: the columns
/// of U first, then the next realization. All must have the period of the first one; without a
/// reference in the map the input itself is searched.
///
/// # Errors
/// [`ExperimentError`]: recordings that cannot be read, are not periodic or never settle, too few
/// of them for the inputs.
pub(crate) fn estimate_others_logs(
    paths: &[PathBuf],
    map: &LogMap,
    options: &EstimateTable,
) -> Result<Outcome, ExperimentError> {
    let recordings = Recordings::read(paths, map)?;
    let periods = recordings.periods()?;
    let frf = recordings.frf(&periods, options)?;
    recordings.outcome(frf, &periods)
}

/// Recordings of one machine, in the order of their experiments.
struct Recordings<'a> {
    paths: &'a [PathBuf],
    logs: Vec<Log>,
}

/// What is periodic in recordings.
struct Periods {
    /// Samples per period.
    n_samples: usize,
    /// Lines that are excited.
    lines: Vec<usize>,
    /// Whole periods in each recording.
    n_periods: usize,
    /// Periods at the beginning that are still transient and are dropped.
    n_transient: usize,
}

impl Periods {
    /// Number of periods that are used.
    fn n_used(&self) -> usize {
        self.n_periods - self.n_transient
    }
}

impl<'a> Recordings<'a> {
    fn read(paths: &'a [PathBuf], map: &LogMap) -> Result<Self, ExperimentError> {
        let logs = paths.iter().map(|path| Ok(read_log(path, map)?));
        let logs = logs.collect::<Result<Vec<Log>, ExperimentError>>()?;
        if logs.is_empty() {
            return Err(EstimateError::EmptyList("recordings").into());
        }
        Ok(Self { paths, logs })
    }

    /// Finds period and lines in the first recording, the transient in all of them.
    fn periods(&self) -> Result<Periods, ExperimentError> {
        let reference = filled(reference(&self.logs[0]));
        let n_samples = find_period(reference.view()).map_err(self.in_recording(0))?;
        let lines = find_lines(reference.view(), n_samples).map_err(self.in_recording(0))?;
        let n_periods = |log: &Log| log.record.n_samples() / n_samples;
        Ok(Periods {
            n_samples,
            n_periods: self.logs.iter().map(n_periods).min().unwrap_or(0),
            n_transient: self.n_transient(n_samples, &lines)?,
            lines,
        })
    }

    /// Leading periods that are transient in any of the recordings.
    fn n_transient(&self, n_samples: usize, lines: &[usize]) -> Result<usize, ExperimentError> {
        let mut most = 0;
        for (number, log) in self.logs.iter().enumerate() {
            let found = transient(log, n_samples, lines).map_err(self.in_recording(number))?;
            most = most.max(found);
        }
        Ok(most)
    }

    /// A complaint about the recording of that number.
    fn in_recording(&self, number: usize) -> impl Fn(EstimateError) -> ExperimentError {
        move |source| ExperimentError::Recording {
            path: self.paths[number].clone(),
            source,
        }
    }

    /// The FRF from the whole periods after the transient.
    fn frf(&self, periods: &Periods, options: &EstimateTable) -> Result<Frf, ExperimentError> {
        let first = &self.logs[0].record;
        let dft = LineDft::new(periods.n_samples, &periods.lines)?;
        let mut campaign = Campaign::new(dft.frequency_hz(first.sample_time_s)?)?;
        let n_inputs = first.u.nrows();
        for (number, log) in self.logs.iter().enumerate() {
            for period in periods.n_transient..periods.n_periods {
                let place = PeriodIndex {
                    realization: number / n_inputs,
                    experiment: number % n_inputs,
                    period: period - periods.n_transient,
                };
                if let Some(spectra) = spectra(log, period, &dft, options)? {
                    campaign.insert(place, spectra)?;
                }
            }
        }
        campaign.drop_incomplete();
        Ok(campaign.estimate(&options.method().into())?)
    }

    /// The FRF with its checks, and what was lost or odd in the files.
    fn outcome(self, frf: Frf, periods: &Periods) -> Result<Outcome, ExperimentError> {
        let mut warnings = self.in_files(|log| log.losses.iter().map(Loss::to_string).collect());
        let is_lossy = !warnings.is_empty();
        warnings.extend(self.in_files(|log| log.warnings.clone()));
        let checks = vec![
            enough_periods(periods, is_lossy),
            settled(periods),
            condition_check(&frf, &[]),
        ];
        let provenance = provenance(self.paths, periods)?;
        let first = self.logs.into_iter().next().expect("at least one was read");
        let result = ResultFile {
            frf,
            input_names: first.input_names,
            output_names: first.output_names,
            input_units: first.input_units,
            output_units: first.output_units,
            torque_rms_nm: None,
            flagged: None,
            checks,
            provenance,
        };
        Ok(Outcome {
            result,
            warnings,
            is_lossy,
            strength: None,
            load: None,
        })
    }

    /// What there is to say of each log, with the name of its file.
    fn in_files(&self, said: impl Fn(&Log) -> Vec<String>) -> Vec<String> {
        let files = self.paths.iter().zip(&self.logs);
        let texts =
            files.flat_map(|(path, log)| said(log).into_iter().map(move |text| (path, text)));
        texts
            .map(|(path, text)| format!("{}: {text}", path.display()))
            .collect()
    }
}

/// Where the result comes from: the periods that were found, and the hash of every file.
fn provenance(paths: &[PathBuf], periods: &Periods) -> Result<Metadata, ExperimentError> {
    let entries = [
        ("frfid_version", env!("CARGO_PKG_VERSION").to_owned()),
        ("period_samples", periods.n_samples.to_string()),
        ("periods_used", periods.n_used().to_string()),
        ("transient_periods_dropped", periods.n_transient.to_string()),
    ];
    let mut provenance = metadata(entries);
    log_hashes(paths, &mut provenance)?;
    Ok(provenance)
}

fn enough_periods(periods: &Periods, is_lossy: bool) -> Check {
    let Periods {
        n_samples,
        n_transient,
        ..
    } = periods;
    let used = periods.n_used();
    Check {
        name: "periods".into(),
        passed: used >= 2 && !is_lossy,
        found: format!("{used} of {n_samples} samples, after {n_transient} transient"),
        needed: "2 or more whole ones, for the noise to be known".into(),
        advice: "record more periods back to back".into(),
    }
}

fn settled(periods: &Periods) -> Check {
    Check {
        name: "settled".into(),
        passed: periods.n_periods >= 3,
        found: format!("{} periods", periods.n_periods),
        needed: "3 or more, to tell a transient from the steady state".into(),
        advice: "record more periods back to back; until then the first one may be transient"
            .into(),
    }
}

/// Spectra of one period of a recording; `None` where samples of it are lost.
fn spectra(
    log: &Log,
    period: usize,
    dft: &LineDft,
    options: &EstimateTable,
) -> Result<Option<RunSpectra>, ExperimentError> {
    let window = s![.., period * dft.n_samples()..(period + 1) * dft.n_samples()];
    let record = &log.record;
    let r = options.reference_of(record).map(|r| r.slice(window));
    let (u, y) = (record.u.slice(window), record.y.slice(window));
    if is_whole(u) && is_whole(y) && r.is_none_or(is_whole) {
        return Ok(Some(RunSpectra::of(dft, u, y, r)?));
    }
    Ok(None)
}

/// The reference, or the input where none was recorded.
fn reference(log: &Log) -> ArrayView2<'_, f64> {
    log.record.r.as_ref().unwrap_or(&log.record.u).view()
}

/// The signal with zeros where samples are lost: good enough to find a period and lines in, never
/// to estimate from.
fn filled(signal: ArrayView2<f64>) -> Array2<f64> {
    signal.mapv(|value| if value.is_finite() { value } else { 0.0 })
}

fn is_whole(signal: ArrayView2<f64>) -> bool {
    signal.iter().all(|value| value.is_finite())
}

/// Leading periods of the outputs that are still transient.
fn transient(log: &Log, period_samples: usize, lines: &[usize]) -> Result<usize, EstimateError> {
    let y = filled(log.record.y.view());
    let n_periods = y.ncols() / period_samples;
    let periods = y.slice(s![.., ..n_periods * period_samples]).to_owned();
    let shape = (y.nrows(), n_periods, period_samples);
    let mut periods = periods
        .into_shape_with_order(shape)
        .expect("whole periods of each channel, in C order");
    periods.swap_axes(0, 1);
    count_transient_periods(periods.view(), lines)
}
