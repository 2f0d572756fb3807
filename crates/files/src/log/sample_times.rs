//! Sample times of a recording without stamps: a column of the file, or a count of samples.

use std::path::Path;

use crate::error::FileError;
use crate::log::map::LogMap;
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
                let (factor, unit) = si_of(path, time)?;
                if unit != "s" {
                    let found = format!("unit {unit}");
                    return Err(FileError::Shape {
                        what: "time in the log map",
                        found,
                        needed: "s, ms, us or ns".into(),
                    });
                }
                Ok(Self::Column(
                    place(&time.source)?,
                    factor * time.scale * 1e9,
                ))
            }
            (None, Some(sample_time_s)) => {
                check_sample_time(sample_time_s)?;
                Ok(Self::Counted(sample_time_s * 1e9))
            }
            (None, None) => Err(FileError::Shape {
                what: "clock of the recording in the log map",
                found: "neither time nor sample_time_s".into(),
                needed: "where its sample times are, or its sample time".into(),
            }),
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
        Ok(match *self {
            Self::Column(column, factor) => (number(column)? * factor).round() as i64,
            Self::Counted(step_ns) => (row as f64 * step_ns).round() as i64,
        })
    }
}
