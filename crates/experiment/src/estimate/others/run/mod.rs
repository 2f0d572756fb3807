//! Runs of recordings: the stretches in which the excitation repeats, with their period and lines,
//! found or stated.

pub(in crate::estimate::others) mod measured;
mod sample_clock;
mod settled;

use std::ops::Range;

use frfid_estimate::{EstimateError, Repetition, find_lines, find_repetition};
use frfid_files::LogMap;
use frfid_signals::format::significant;
use ndarray::s;

use crate::estimate::others::recording::Recording;

/// A stretch of a recording in which the excitation repeats.
#[derive(Debug, Clone)]
pub(in crate::estimate::others) struct Run {
    /// Place of the recording among those that are looked at.
    pub(in crate::estimate::others) recording: usize,
    /// Samples of the recording.
    pub(in crate::estimate::others) samples: Range<usize>,
    /// Period in samples, not necessarily whole.
    pub(in crate::estimate::others) period: f64,
    /// Lines that are excited, rising.
    pub(in crate::estimate::others) lines: Vec<usize>,
    /// Whether it is the only one of its recording.
    is_alone: bool,
}

impl Run {
    /// The name of its recording, with its times where there are others in it.
    pub(in crate::estimate::others) fn name(&self, recording: &Recording) -> String {
        if self.is_alone {
            return recording.name.clone();
        }
        let time_s =
            |sample: usize| significant(sample as f64 * recording.log.record.sample_time_s, 6);
        let Range { start, end } = self.samples;
        format!(
            "{} ({} s to {} s)",
            recording.name,
            time_s(start),
            time_s(end)
        )
    }
}

/// The runs of a recording.
///
/// # Errors
/// [`EstimateError`] for a recording in which nothing repeats, or no lines stand out.
pub(in crate::estimate::others) fn runs_of(
    (number, recording): (usize, &Recording),
    map: &LogMap,
) -> Result<Vec<Run>, EstimateError> {
    let sample_time_s = recording.log.record.sample_time_s;
    let stated = map.period_s.map(|period_s| period_s / sample_time_s);
    let reference = recording.reference();
    let Repetition { period, runs, .. } = find_repetition(reference, stated)?;
    let is_alone = runs.len() == 1;
    let run = |samples: Range<usize>| {
        let stretch = reference.slice(s![.., samples.clone()]);
        let lines = match &map.lines {
            Some(lines) => lines.clone(),
            None => find_lines(stretch, period)?,
        };
        Ok(Run {
            recording: number,
            samples,
            period,
            lines,
            is_alone,
        })
    };
    runs.into_iter().map(run).collect()
}
