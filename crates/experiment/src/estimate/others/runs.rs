//! Runs of recordings: the stretches in which the excitation repeats, with their period and lines,
//! found or stated.

use std::ops::Range;

use frfid_estimate::{EstimateError, Repetition, find_lines, find_repetition};
use frfid_files::LogMap;
use ndarray::s;

use crate::estimate::others::recording::Recording;

/// A stretch of a recording in which the excitation repeats.
#[derive(Debug, Clone)]
pub(super) struct Run {
    /// Place of the recording among those that are looked at.
    pub(super) recording: usize,
    /// Samples of the recording.
    pub(super) samples: Range<usize>,
    /// Period in samples, not necessarily whole.
    pub(super) period: f64,
    /// Lines that are excited, rising.
    pub(super) lines: Vec<usize>,
}

/// The runs of a recording.
///
/// # Errors
/// [`EstimateError`] for a recording in which nothing repeats, or no lines stand out.
pub(super) fn runs_of(
    (number, recording): (usize, &Recording),
    map: &LogMap,
) -> Result<Vec<Run>, EstimateError> {
    let sample_time_s = recording.log.record.sample_time_s;
    let stated = map.period_s.map(|period_s| period_s / sample_time_s);
    let reference = recording.reference();
    let Repetition { period, runs, .. } = find_repetition(reference, stated)?;
    let run = |samples: Range<usize>| {
        let stretch = reference.slice(s![.., samples.clone()]);
        let lines = match &map.lines {
            Some(lines) => lines.clone(),
            None => find_lines(stretch, period.round() as usize)?,
        };
        Ok(Run {
            recording: number,
            samples,
            period,
            lines,
        })
    };
    runs.into_iter().map(run).collect()
}
