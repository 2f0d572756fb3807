//! Cut of a recording to the time that is asked for.

use std::ops::Range;

use frfid_files::{Log, Loss};
use frfid_signals::Record;
use ndarray::{Array2, s};

use crate::error::ExperimentError;

/// The part of a log from `start_s` to `end_s` after its first sample.
///
/// # Errors
/// [`ExperimentError::Logs`] for times between which the recording has no two samples.
pub(in crate::estimate::others) fn cut(
    log: Log,
    start_s: Option<f64>,
    end_s: Option<f64>,
) -> Result<Log, ExperimentError> {
    let n_samples = log.record.n_samples();
    let samples = samples_within(&log, start_s.unwrap_or(0.0), end_s.unwrap_or(f64::INFINITY))?;
    if samples.len() == n_samples {
        return Ok(log);
    }
    let step_s = log.record.sample_time_s;
    let (begin_s, end_s) = (samples.start as f64 * step_s, samples.end as f64 * step_s);
    Ok(Log {
        record: part(log.record, &samples),
        times_s: log.times_s.map(|times_s| from_start(&times_s[samples])),
        losses: shifted(log.losses, begin_s, end_s),
        ..log
    })
}

/// The samples between two times, at least two.
fn samples_within(log: &Log, start_s: f64, end_s: f64) -> Result<Range<usize>, ExperimentError> {
    let (step_s, n_samples) = (log.record.sample_time_s, log.record.n_samples());
    let sample = |time_s: f64| (time_s / step_s).ceil().clamp(0.0, n_samples as f64) as usize;
    let samples = sample(start_s)..sample(end_s);
    if !start_s.is_nan() && !end_s.is_nan() && samples.len() > 1 {
        return Ok(samples);
    }
    Err(ExperimentError::logs(
        "start and end",
        format!("{start_s} s to {end_s} s"),
        format!("times within 0 to {:.6} s", n_samples as f64 * step_s),
        "see --start and --end, start_s and end_s in the map",
    ))
}

/// The record of these samples.
fn part(record: Record, samples: &Range<usize>) -> Record {
    let signal = |signal: Array2<f64>| signal.slice_move(s![.., samples.clone()]);
    Record {
        u: signal(record.u),
        y: signal(record.y),
        r: record.r.map(signal),
        position_rad: record.position_rad.map(signal),
        ..record
    }
}

/// Times from the first on.
fn from_start(times_s: &[f64]) -> Vec<f64> {
    times_s.iter().map(|time_s| time_s - times_s[0]).collect()
}

/// The losses within a part of a recording, by its time.
fn shifted(losses: Vec<Loss>, begin_s: f64, end_s: f64) -> Vec<Loss> {
    let touches =
        |loss: &Loss| loss.from_s == loss.to_s || (loss.to_s > begin_s && loss.from_s < end_s);
    let losses = losses.into_iter().filter(touches);
    let shifted = losses.map(|loss| Loss {
        from_s: (loss.from_s - begin_s).max(0.0),
        to_s: (loss.to_s.min(end_s) - begin_s).max(0.0),
        ..loss
    });
    shifted.collect()
}
