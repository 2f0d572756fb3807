//! Logs that frfid did not make: read through a [`LogMap`], put on one clock, converted to SI.

pub(crate) mod alignment;
pub(crate) mod clock;
pub(crate) mod csv;
pub(crate) mod formats;
pub(crate) mod map;
pub(crate) mod mcap;
pub(crate) mod npy;
pub(crate) mod npz;
pub(crate) mod recording;
pub(crate) mod sample_times;
#[cfg(test)]
mod tests;
pub(crate) mod units;

use std::path::Path;

use frfid_signals::Record;
use ndarray::Array2;

use crate::error::FileError;
use crate::log::alignment::{Grid, drop_duplicates};
use crate::log::clock::Clock;
use crate::log::formats::Format;
use crate::log::map::{LogMap, Signal};
use crate::log::recording::{Recording, Series};
use crate::log::units::{si_of, to_si};
use crate::loss::Loss;
use crate::run::header;

/// A foreign recording, in SI units on one sample clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// The signals; lost samples are NaN and listed in `losses`.
    pub record: Record,
    /// Where each input comes from.
    pub input_names: Vec<String>,
    /// Where each output comes from.
    pub output_names: Vec<String>,
    /// SI unit of each input.
    pub input_units: Vec<String>,
    /// SI unit of each output.
    pub output_units: Vec<String>,
    /// Samples that are missing or not numbers.
    pub losses: Vec<Loss>,
    /// What else a careful reader should know: jitter, delays, dropped duplicates.
    pub warnings: Vec<String>,
}

/// Reads a recording in one of the [`formats::FORMATS`].
///
/// Topics are aligned by their stamps; a constant delay between them is reported, not corrected.
/// Nothing is resampled.
///
/// # Errors
/// [`FileError`]: unreadable files, topics, fields, columns or units that are not there, and clocks
/// that are not even.
pub fn read_log(path: &Path, map: &LogMap) -> Result<Log, FileError> {
    check(map)?;
    let signals: Vec<&Signal> = map.roles().into_iter().flatten().collect();
    let recording = (Format::of(path)?.read)(path, map, &signals)?;
    assemble(path, map, &signals, recording)
}

/// Refuses a map without inputs or outputs, and roles of other sizes.
fn check(map: &LogMap) -> Result<(), FileError> {
    if map.u.is_empty() || map.y.is_empty() {
        let found = format!("{} inputs, {} outputs", map.u.len(), map.y.len());
        let needed = "at least one signal for u and for y";
        return Err(FileError::shape("log map", found, needed));
    }
    check_size("r", &map.r, map.u.len())?;
    check_size("position", &map.position, map.y.len())
}

/// Refuses a role with another number of signals; it may have none.
fn check_size(what: &'static str, role: &[Signal], size: usize) -> Result<(), FileError> {
    if role.is_empty() || role.len() == size {
        return Ok(());
    }
    let found = format!("{} signals", role.len());
    Err(FileError::shape(what, found, format!("{size}, or none")))
}

/// Puts the signals of all topics on one clock.
fn assemble(
    path: &Path,
    map: &LogMap,
    signals: &[&Signal],
    mut recording: Recording,
) -> Result<Log, FileError> {
    let mut warnings = recording.warnings;
    let clocks = clocks(path, &mut recording.series, &mut warnings)?;
    let grid = Grid::of(&recording.series, &clocks, &mut warnings)
        .map_err(|(found, needed)| FileError::content(path, "topics", found, needed))?;
    check_amount(path, grid.n_samples, signals.len())?;
    let mut values = Array2::from_elem((signals.len(), grid.n_samples), f64::NAN);
    let mut losses = grid.fill(&recording.series, &clocks, signals, &mut values);
    let damages = recording.damages.into_iter();
    losses.extend(damages.map(|(at_ns, reason)| grid.of_file(at_ns, reason)));
    check_measured(path, signals, &values)?;
    convert(path, signals, &mut values)?;
    let sample_time_s = recording.sample_time_s.unwrap_or(grid.sample_time_s);
    Ok(Log {
        losses,
        warnings,
        ..sort_into_roles(map, &values, sample_time_s)
    })
}

/// Refuses more values than a file may hold.
fn check_amount(path: &Path, n_samples: usize, n_signals: usize) -> Result<(), FileError> {
    if n_samples.saturating_mul(n_signals) <= header::MOST_VALUES {
        return Ok(());
    }
    let found = format!("{n_samples} samples");
    let needed = format!("at most {} values", header::MOST_VALUES);
    Err(FileError::content(path, "stamps", found, needed))
}

/// The clock of each series.
fn clocks(
    path: &Path,
    series: &mut [Series],
    warnings: &mut Vec<String>,
) -> Result<Vec<Clock>, FileError> {
    let clock = |series: &mut Series| {
        drop_duplicates(series, warnings)
            .and_then(|()| Clock::fit(&series.stamps_ns))
            .map_err(|(found, needed)| FileError::content(path, &series.topic, found, needed))
    };
    series.iter_mut().map(clock).collect()
}

/// Refuses signals without a single number.
fn check_measured(path: &Path, signals: &[&Signal], values: &Array2<f64>) -> Result<(), FileError> {
    let mut rows = signals.iter().zip(values.rows());
    match rows.find(|(_, row)| !row.iter().any(|value| value.is_finite())) {
        None => Ok(()),
        Some((signal, _)) => Err(FileError::content(
            path,
            &signal.source,
            "no number in the whole recording",
            "a measured signal",
        )),
    }
}

fn convert(path: &Path, signals: &[&Signal], values: &mut Array2<f64>) -> Result<(), FileError> {
    for (signal, mut row) in signals.iter().zip(values.rows_mut()) {
        let (factor, _) = si_of(path, signal)?;
        let scale = factor * signal.scale;
        row.mapv_inplace(|value| scale * value);
    }
    Ok(())
}

/// The log of these values, row by row in the order of the map's roles.
fn sort_into_roles(map: &LogMap, values: &Array2<f64>, sample_time_s: f64) -> Log {
    let mut taken = 0;
    let [u, y, r, position] = map.roles().map(|role| {
        let rows = taken..taken + role.len();
        taken = rows.end;
        values.slice(ndarray::s![rows, ..]).to_owned()
    });
    let there = |signal: Array2<f64>| (signal.nrows() > 0).then_some(signal);
    Log {
        input_names: names(&map.u),
        output_names: names(&map.y),
        input_units: units(&map.u),
        output_units: units(&map.y),
        record: Record {
            sample_time_s,
            u,
            y,
            r: there(r),
            position_rad: there(position),
            input_kind: map.input_kind,
            events: Vec::new(),
        },
        losses: Vec::new(),
        warnings: Vec::new(),
    }
}

fn names(role: &[Signal]) -> Vec<String> {
    role.iter().map(|signal| signal.source.clone()).collect()
}

/// SI units; a unit that is not known stays as it is.
fn units(role: &[Signal]) -> Vec<String> {
    let unit = |signal: &Signal| match to_si(&signal.unit) {
        Ok((_, si)) => si.to_owned(),
        Err(_) => signal.unit.clone(),
    };
    role.iter().map(unit).collect()
}
