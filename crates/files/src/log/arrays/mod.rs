//! Recordings in files of arrays: one array for each signal, or a channel of one, and one for the sample times.

pub(crate) mod npy;
pub(crate) mod npz;

use std::cmp::Reverse;
use std::path::Path;

use crate::error::FileError;
use crate::log::listing::{ListedSignal, Listing, N_FIRST, SignalGroup};
use crate::log::map::{LogMap, Signal, Signals};
use crate::log::recording::{Recording, Series};
use crate::log::sample_times::{SampleTimes, TimeColumn, nth_stamp_ns};
use crate::log::units::names::unit_in_name;

/// Arrays by the sources of a log map.
pub(crate) trait Arrays {
    /// The samples of a source.
    fn numbers(&self, source: &str) -> Result<Vec<f64>, FileError>;

    /// The same as integers; `None` of an array of others.
    fn integers(&self, source: &str) -> Option<Vec<i64>>;
}

/// The mapped arrays of a recording.
pub(crate) fn read(
    path: &Path,
    map: &LogMap,
    signals: &Signals,
    arrays: &dyn Arrays,
) -> Result<Recording, FileError> {
    let column = |signal: &&Signal| arrays.numbers(&signal.source);
    let columns = signals.iter().map(column).collect::<Result<Vec<_>, _>>()?;
    let first = Length::of(&signals[0].source, &columns[0]);
    for (signal, column) in signals.iter().zip(&columns) {
        Length::of(&signal.source, column).check(path, &first)?;
    }
    let stamps_ns = stamps(path, map, &first, arrays)?;
    Ok(Recording {
        series: vec![Series {
            topic: "samples".into(),
            is_recorders: false,
            stamps_ns,
            signals: (0..signals.len()).collect(),
            columns,
        }],
        ..Default::default()
    })
}

/// Matrices of more channels are no signals.
pub(crate) const MOST_CHANNELS: usize = 64;

/// Arrays in groups of one length, the largest group first.
pub(crate) fn listing(
    format: &'static str,
    channels: impl Iterator<Item = (String, Vec<f64>)>,
) -> Listing {
    let mut groups: Vec<SignalGroup> = Vec::new();
    for (source, samples) in channels {
        let n_rows = samples.len();
        let unit = unit_in_name(&source);
        let first = samples.into_iter().take(N_FIRST).collect();
        let signal = ListedSignal::of(source, unit, first);
        match groups.iter_mut().find(|group| group.n_rows == Some(n_rows)) {
            Some(group) => group.signals.push(signal),
            None => groups.push(SignalGroup {
                name: format!("arrays of {n_rows}"),
                n_rows: Some(n_rows),
                signals: vec![signal],
                ..SignalGroup::default()
            }),
        }
    }
    groups.sort_by_key(|group| Reverse(group.signals.len() * group.n_rows.unwrap_or(0)));
    Listing {
        format,
        groups,
        told: Vec::new(),
    }
}

/// The sample times, as many as the first signal has samples.
fn stamps(
    path: &Path,
    map: &LogMap,
    first: &Length,
    arrays: &dyn Arrays,
) -> Result<Vec<i64>, FileError> {
    match SampleTimes::of(path, map, |_| Ok(0))? {
        SampleTimes::Counted(step_ns) => Ok(counted(first.n_samples, step_ns)),
        SampleTimes::Column(column) => {
            let source = map.time.as_ref().map_or("", |time| &time.source);
            let stamps = stamps_of(path, source, column, arrays)?;
            Length::of(source, &stamps).check(path, first)?;
            Ok(stamps)
        }
    }
}

fn counted(n_samples: usize, step_ns: f64) -> Vec<i64> {
    let stamp = |number| nth_stamp_ns(number, step_ns);
    (0..n_samples).map(stamp).collect()
}

/// The sample times of an array; integers keep their last digit.
fn stamps_of(
    path: &Path,
    source: &str,
    column: TimeColumn,
    arrays: &dyn Arrays,
) -> Result<Vec<i64>, FileError> {
    let numbers = arrays.numbers(source)?.into_iter();
    let stamps: Option<Vec<i64>> = match arrays.integers(source) {
        Some(integers) => {
            let integers = integers.into_iter();
            integers.map(|time| column.stamp_of_integer(time)).collect()
        }
        None => numbers.map(|time| column.stamp_of_number(time)).collect(),
    };
    stamps.ok_or_else(|| no_time(path, source))
}

fn no_time(path: &Path, source: &str) -> FileError {
    let found = "a time that is no number".to_owned();
    bad_array(path, source, found, "a time for every sample")
}

pub(crate) fn bad_array(
    path: &Path,
    name: &str,
    found: String,
    needed: impl Into<String>,
) -> FileError {
    FileError::content(path, format!("array {name}"), found, needed)
}

/// A signal and how many samples it has.
struct Length<'s> {
    source: &'s str,
    n_samples: usize,
}

impl<'s> Length<'s> {
    fn of<T>(source: &'s str, samples: &[T]) -> Self {
        Self {
            source,
            n_samples: samples.len(),
        }
    }

    /// Refuses a signal that is not as long as the first one.
    fn check(&self, path: &Path, first: &Length) -> Result<(), FileError> {
        if self.n_samples == first.n_samples {
            return Ok(());
        }
        Err(self.other_than(path, first))
    }

    fn other_than(&self, path: &Path, first: &Length) -> FileError {
        let found = format!("{} samples", self.n_samples);
        let needed = format!("{}, as in {}", first.n_samples, first.source);
        bad_array(path, self.source, found, needed)
    }
}

/// `name` and `channel` of `name[channel]`; the whole source is a name where the channel is no number.
pub(crate) fn name_and_channel(source: &str) -> (&str, Option<usize>) {
    let parts = source
        .strip_suffix(']')
        .and_then(|inside| inside.split_once('['));
    let channel = parts.and_then(|(_, channel)| channel.parse().ok());
    match parts {
        Some((name, _)) if channel.is_some() => (name, channel),
        _ => (source, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_a_number_and_nothing_else() {
        assert_eq!(name_and_channel("u[2]"), ("u", Some(2)));
        for whole in ["u", "u[", "u[x]", "u[-1]"] {
            assert_eq!(name_and_channel(whole), (whole, None));
        }
    }
}
