//! Sample times of a recording without stamps: a column of the file, or a count of samples.

use std::path::Path;

use crate::error::FileError;
use crate::log::decimal::scaled_integer;
use crate::log::map::{LogMap, Signal};
use crate::log::units::si_of;

/// Where the sample times of a recording without stamps come from.
pub(crate) enum SampleTimes {
    /// A column of times.
    Column(TimeColumn),
    /// The row's number, with the sample time in ns.
    Counted(f64),
}

/// Column of times.
#[derive(Clone, Copy)]
pub(crate) struct TimeColumn {
    pub(crate) place: usize,
    /// Factor to ns.
    factor: f64,
    /// The same as a power of ten, if the log map does not scale it.
    power: Option<i32>,
}

impl SampleTimes {
    /// By the log map; `place` finds the column of times by its name.
    pub(crate) fn of(
        path: &Path,
        map: &LogMap,
        place: impl FnOnce(&str) -> Result<usize, FileError>,
    ) -> Result<Self, FileError> {
        if let Some(time) = &map.time {
            let place = place(&time.source)?;
            return TimeColumn::of(path, time, place).map(Self::Column);
        }
        let step_ns = map.sample_time_s.map(|sample_time_s| sample_time_s * 1e9);
        step_ns.map(Self::Counted).ok_or_else(no_clock)
    }
}

fn no_clock() -> FileError {
    FileError::shape(
        "clock of the recording in the log map",
        "neither time nor sample_time_s",
        "where its sample times are, or its sample time",
    )
}

impl TimeColumn {
    fn of(path: &Path, time: &Signal, place: usize) -> Result<Self, FileError> {
        Ok(Self {
            place,
            factor: seconds(path, time)? * time.scale * 1e9,
            power: power_to_ns(time),
        })
    }

    /// The stamp of a time that was written in decimal digits, all of which count; `None` if it is
    /// no finite number.
    pub(crate) fn stamp_of_text(&self, text: &str) -> Option<i64> {
        let exactly = self.power.and_then(|power| scaled_integer(text, power));
        exactly.or_else(|| self.stamp_of_number(text.parse().ok()?))
    }

    /// The stamp of a time; `None` if it is no finite number.
    pub(crate) fn stamp_of_number(&self, number: f64) -> Option<i64> {
        let stamp_ns = number * self.factor;
        stamp_ns.is_finite().then(|| stamp_ns.round() as i64)
    }

    /// The stamp of a time that was kept as an integer.
    pub(crate) fn stamp_of_integer(&self, number: i64) -> Option<i64> {
        let factor = |power: i32| 10_i64.checked_pow(power as u32);
        match self.power.and_then(factor) {
            Some(factor) => number.checked_mul(factor),
            None => self.stamp_of_number(number as f64),
        }
    }
}

/// The stamp of a sample that was counted.
pub(crate) fn nth_stamp_ns(number: usize, step_ns: f64) -> i64 {
    (number as f64 * step_ns).round() as i64
}

/// Power of ten from the unit of a time to ns, if nothing else scales it.
fn power_to_ns(time: &Signal) -> Option<i32> {
    match time.unit.as_str() {
        _ if time.scale != 1.0 => None,
        "s" => Some(9),
        "ms" => Some(6),
        "us" => Some(3),
        "ns" => Some(0),
        _ => None,
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
