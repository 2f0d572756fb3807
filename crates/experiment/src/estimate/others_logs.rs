//! FRFs from recordings that frfid did not make: period, transient and lines are found in the
//! reference.

use std::path::PathBuf;

use frfid_estimate::{
    BlaOptions, Campaign, EstimateError, LineDft, Place, RunSpectra, count_transient_periods,
    find_lines, find_period,
};
use frfid_files::{Log, LogMap, Loss, read_log};
use frfid_signals::Frf;
use ndarray::{Array2, ArrayView2, s};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;

/// What was found in foreign recordings, and the FRF.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// The FRF on the lines found.
    pub frf: Frf,
    /// Samples per period.
    pub period_samples: usize,
    /// Whole periods in each recording.
    pub n_periods: usize,
    /// Periods at the beginning that are still transient and were dropped.
    pub n_transient: usize,
    /// Samples that were lost, with the recording they are of; the periods they hit were dropped.
    pub losses: Vec<(PathBuf, Loss)>,
    /// What else a careful reader should know, with the recording.
    pub warnings: Vec<(PathBuf, String)>,
    /// Where the inputs and outputs come from, and their SI units.
    pub names: Names,
}

/// Names and SI units of inputs and outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Names {
    /// Inputs.
    pub inputs: Vec<String>,
    /// Outputs.
    pub outputs: Vec<String>,
    /// Unit of each input.
    pub input_units: Vec<String>,
    /// Unit of each output.
    pub output_units: Vec<String>,
}

/// Estimates the FRF from recordings of a periodic excitation, one for each experiment: the columns
/// of U first, then the next realization. All must have the period of the first one; without a
/// reference in the map the input itself is searched.
///
/// # Errors
/// [`ExperimentError`]: recordings that cannot be read, are not periodic or never settle, too few
/// of them for the inputs.
pub fn estimate_foreign(
    paths: &[PathBuf],
    map: &LogMap,
    options: &EstimateTable,
) -> Result<Foreign, ExperimentError> {
    let mut logs = paths
        .iter()
        .map(|path| Ok(read_log(path, map)?))
        .collect::<Result<Vec<Log>, ExperimentError>>()?;
    let Some(first) = logs.first() else {
        return Err(EstimateError::EmptyList("recordings").into());
    };
    let (sample_time_s, n_inputs) = (first.record.sample_time_s, first.record.u.nrows());
    let whole = filled(reference(first));
    let of = |path: &PathBuf, source| ExperimentError::Recording {
        path: path.clone(),
        source,
    };
    let period_samples = find_period(whole.view()).map_err(|error| of(&paths[0], error))?;
    let lines = find_lines(whole.view(), period_samples).map_err(|error| of(&paths[0], error))?;
    let mut n_transient = 0;
    for (path, log) in paths.iter().zip(&logs) {
        n_transient = n_transient
            .max(transient(log, period_samples, &lines).map_err(|error| of(path, error))?);
    }
    let dft = LineDft::new(period_samples, &lines)?;
    let mut campaign = Campaign::new(dft.frequency_hz(sample_time_s)?)?;
    let n_periods = logs
        .iter()
        .map(|log| log.record.n_samples() / period_samples)
        .min()
        .unwrap_or(0);
    for (number, log) in logs.iter().enumerate() {
        for period in n_transient..n_periods {
            let window = s![.., period * period_samples..(period + 1) * period_samples];
            let r = log
                .record
                .r
                .as_ref()
                .filter(|_| options.indirect)
                .map(|r| r.slice(window));
            let (u, y) = (log.record.u.slice(window), log.record.y.slice(window));
            if is_whole(u) && is_whole(y) && r.is_none_or(is_whole) {
                let place = Place {
                    realization: number / n_inputs,
                    experiment: number % n_inputs,
                    period: period - n_transient,
                };
                campaign.insert(place, RunSpectra::of(&dft, u, y, r)?)?;
            }
        }
    }
    campaign.drop_incomplete();
    let frf = campaign.estimate(&BlaOptions {
        averaging: options.average.into(),
        ..BlaOptions::default()
    })?;
    let names = Names {
        inputs: std::mem::take(&mut logs[0].input_names),
        outputs: std::mem::take(&mut logs[0].output_names),
        input_units: std::mem::take(&mut logs[0].input_units),
        output_units: std::mem::take(&mut logs[0].output_units),
    };
    let (mut losses, mut warnings) = (Vec::new(), Vec::new());
    for (path, log) in paths.iter().zip(logs) {
        losses.extend(log.losses.into_iter().map(|loss| (path.clone(), loss)));
        warnings.extend(
            log.warnings
                .into_iter()
                .map(|warning| (path.clone(), warning)),
        );
    }
    Ok(Foreign {
        frf,
        period_samples,
        n_periods,
        n_transient,
        losses,
        warnings,
        names,
    })
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
