//! Sample times of a recording without stamps: a column of the file, or a count of samples.

use std::path::Path;

use crate::error::FileError;
use crate::log::map::{LogMap, Signal};
use crate::log::units::si_of;
use crate::run::header::check_sample_time;

/// Where the sample times of a recording without stamps come from.
pub(crate) enum SampleTimes {
    /// A column, with its factor to ns.
    Column(usize, f64),
    /// The row's number, with the sample time in ns.
    Counted(f64),
}

impl SampleTimes {
    /// By the log map; `place` finds the column of times by its name.
    pub(crate) fn of(
        path: &Path,
        map: &LogMap,
        place: impl FnOnce(&str) -> Result<usize, FileError>,
    ) -> Result<Self, FileError> {
        match (&map.time, map.sample_time_s) {
            (Some(time), _) => {
                let factor = seconds(path, time)?;
                let column = place(&time.source)?;
                Ok(Self::Column(column, factor * time.scale * 1e9))
            }
            (None, Some(sample_time_s)) => {
                check_sample_time(sample_time_s)?;
                Ok(Self::Counted(sample_time_s * 1e9))
            }
            (None, None) => Err(FileError::shape(
                "clock of the recording in the log map",
                "neither time nor sample_time_s",
                "where its sample times are, or its sample time",
            )),
        }
    }

    /// The sample time that the user gave, to its last digit; none where it comes from the sample
    /// times.
    pub(crate) fn sample_time_s(&self, map: &LogMap) -> Option<f64> {
        map.sample_time_s
            .filter(|_| matches!(self, Self::Counted(_)))
    }

    /// The stamp of a row; `number` reads its column.
    pub(crate) fn stamp_ns(
        &self,
        row: usize,
        number: impl Fn(usize) -> Result<f64, FileError>,
    ) -> Result<i64, FileError> {
        let stamp_ns = match *self {
            Self::Column(column, factor) => number(column)? * factor,
            Self::Counted(step_ns) => row as f64 * step_ns,
        };
        Ok(stamp_ns.round() as i64)
    }
}

/// Factor to s of a signal that must be a time.
fn seconds(path: &Path, time: &Signal) -> Result<f64, FileError> {
    match si_of(path, time)? {
        (factor, "s") => Ok(factor),
        (_, unit) => Err(FileError::shape(
            "time in the log map",
            format!("unit {unit}"),
            "s, ms, us or ns",
        )),
    }
}
