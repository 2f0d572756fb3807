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
use ndarray::{Array2, ArrayView1};

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
        return Err(FileError::Shape {
            what: "log map",
            found,
            needed: "at least one signal for u and for y".into(),
        });
    }
    for (what, role, size) in [
        ("r", &map.r, map.u.len()),
        ("position", &map.position, map.y.len()),
    ] {
        if !role.is_empty() && role.len() != size {
            let needed = format!("{size}, or none");
            return Err(FileError::Shape {
                what,
                found: format!("{} signals", role.len()),
                needed,
            });
        }
    }
    Ok(())
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
        .map_err(|(found, needed)| content(path, "topics", found, needed))?;
    if grid.n_samples.saturating_mul(signals.len()) > header::MOST_VALUES {
        let found = format!("{} samples", grid.n_samples);
        let needed = format!("at most {} values", header::MOST_VALUES);
        return Err(content(path, "stamps", found, needed));
    }
    let mut values = Array2::from_elem((signals.len(), grid.n_samples), f64::NAN);
    let mut losses = grid.fill(&recording.series, &clocks, signals, &mut values);
    let damages = recording.damages.into_iter();
    losses.extend(damages.map(|(at_ns, reason)| grid.of_file(at_ns, reason)));
    check_measured(path, signals, &values)?;
    convert(path, signals, &mut values)?;
    let sample_time_s = recording.sample_time_s.unwrap_or(grid.sample_time_s);
    Ok(sort_into_roles(
        map,
        &values,
        sample_time_s,
        losses,
        warnings,
    ))
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
            .map_err(|(found, needed)| content(path, &series.topic, found, needed))
    };
    series.iter_mut().map(clock).collect()
}

/// Refuses signals without a single number.
fn check_measured(path: &Path, signals: &[&Signal], values: &Array2<f64>) -> Result<(), FileError> {
    let is_measured = |row: ArrayView1<f64>| row.iter().any(|value| value.is_finite());
    let dead = signals
        .iter()
        .zip(values.rows())
        .find(|(_, row)| !is_measured(*row));
    dead.map_or(Ok(()), |(signal, _)| {
        let found = "no number in the whole recording".into();
        Err(content(
            path,
            &signal.source,
            found,
            "a measured signal".into(),
        ))
    })
}

fn content(path: &Path, what: &str, found: String, needed: String) -> FileError {
    FileError::Content {
        path: path.into(),
        what: what.into(),
        found,
        needed,
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

fn sort_into_roles(
    map: &LogMap,
    values: &Array2<f64>,
    sample_time_s: f64,
    losses: Vec<Loss>,
    warnings: Vec<String>,
) -> Log {
    let mut taken = 0;
    let [u, y, r, position] = map.roles().map(|role| {
        let rows = values
            .slice(ndarray::s![taken..taken + role.len(), ..])
            .to_owned();
        taken += role.len();
        rows
    });
    let there = |signal: Array2<f64>| (signal.nrows() > 0).then_some(signal);
    let names = |role: &[Signal]| role.iter().map(|signal| signal.source.clone()).collect();
    let units = |role: &[Signal]| {
        role.iter()
            .map(|signal| to_si(&signal.unit).map_or(signal.unit.clone(), |(_, si)| si.into()))
            .collect()
    };
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
        losses,
        warnings,
    }
}
