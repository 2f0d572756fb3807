//! Logs that frfid did not make: read through a [`LogMap`], put on one clock, converted to SI.

pub(crate) mod alignment;
pub(crate) mod clock;
pub(crate) mod csv;
pub(crate) mod decimal;
pub(crate) mod formats;
pub(crate) mod lines;
pub(crate) mod map;
pub(crate) mod mcap;
pub(crate) mod npy;
pub(crate) mod npz;
pub(crate) mod recording;
pub(crate) mod sample_times;
pub(crate) mod table;
#[cfg(test)]
mod tests;
pub(crate) mod text;
pub(crate) mod units;

use std::path::Path;

use frfid_signals::Record;
use ndarray::Array2;

use crate::error::FileError;
use crate::log::alignment::Grid;
use crate::log::alignment::pairing::{Paced, delay_warnings, stamp_warnings, two_clocks};
use crate::log::clock::Clock;
use crate::log::formats::Format;
use crate::log::map::{LogMap, Signal};
use crate::log::recording::{Recording, Series, of_damaged};
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
    /// Time of every sample in s after the first, as the topic of the first input is stamped; on the
    /// even grid where samples are lost or their stamps out of order. `None` where the stamps are
    /// even to 0.01 of a sample or rounded from such.
    pub times_s: Option<Vec<f64>>,
    /// That inputs and outputs are on two clocks, in a sentence: the phase cannot be trusted.
    pub two_clocks: Option<String>,
    /// The sample clock.
    pub clock: ClockFit,
    /// Length of the recording in s: samples times sample time.
    pub duration_s: f64,
}

/// The sample clock that was fitted to the stamps of the first input's topic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockFit {
    /// Sample time in s.
    pub sample_time_s: f64,
    /// What the stamps are rounded to, in s; `None` where rounding does not show.
    pub resolution_s: Option<f64>,
    /// Deviation of the stamps from the even clock, rms in parts of the sample time.
    pub jitter: f64,
    /// Samples of the grid that have no row.
    pub n_lost: usize,
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
    let mut recording = (Format::of(path)?.read)(path, map, &signals)?;
    assemble(path, map, &signals, &mut recording)
        .map_err(|error| of_damaged(error, &recording.damages))
}

/// Refuses a map without inputs or outputs, roles of other sizes, and what is no sample time.
fn check(map: &LogMap) -> Result<(), FileError> {
    if map.u.is_empty() || map.y.is_empty() {
        let found = format!("{} inputs, {} outputs", map.u.len(), map.y.len());
        let needed = "at least one signal for u and for y";
        return Err(FileError::shape("log map", found, needed));
    }
    map.sample_time_s
        .map_or(Ok(()), header::check_sample_time)?;
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
    recording: &mut Recording,
) -> Result<Log, FileError> {
    let clocks = clocks(path, map, recording)?;
    let series = &recording.series;
    let roles = series.iter().map(|series| map.roles_of(&series.signals));
    let roles: Vec<String> = roles.collect();
    let topics = paced(series, &clocks, &roles);
    let mut warnings = recording.warnings.clone();
    let grid = Grid::of(&topics, &mut warnings)
        .map_err(|(found, needed)| FileError::content(path, "topics", found, needed))?;
    check_amount(path, grid.n_samples, signals.len())?;
    let mut values = Array2::from_elem((signals.len(), grid.n_samples), f64::NAN);
    let mut losses = grid.fill(&topics, signals, &mut values);
    losses.extend(grid.of_file(&recording.damages));
    check_measured(path, signals, &values)?;
    convert(path, signals, &mut values)?;
    let log = sort_into_roles(map, &values, grid.clock_fit(&topics[0]));
    warnings.extend(told(&topics));
    Ok(Log {
        losses,
        warnings,
        two_clocks: two_clocks(&topics),
        times_s: grid.times_s(&topics[0]),
        ..log
    })
}

/// The topics with their clocks and roles.
fn paced<'t>(series: &'t [Series], clocks: &'t [Clock], roles: &'t [String]) -> Vec<Paced<'t>> {
    let parts = series.iter().zip(clocks).zip(roles);
    let paced = parts.map(|((series, clock), roles)| Paced {
        series,
        clock,
        roles,
    });
    paced.collect()
}

/// What a careful reader should know of the stamps of all topics; between two clocks a delay says
/// nothing.
fn told(topics: &[Paced]) -> Vec<String> {
    let mut told: Vec<_> = topics.iter().flat_map(stamp_warnings).collect();
    if two_clocks(topics).is_none() {
        told.extend(delay_warnings(topics));
    }
    told
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

/// The clock of each series, whose rows are put in order.
fn clocks(path: &Path, map: &LogMap, recording: &mut Recording) -> Result<Vec<Clock>, FileError> {
    let warnings = &mut recording.warnings;
    let clock = |series: &mut Series| {
        Clock::of(series, map.sample_time_s, warnings)
            .map_err(|(found, needed)| FileError::content(path, &series.topic, found, needed))
    };
    recording.series.iter_mut().map(clock).collect()
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
fn sort_into_roles(map: &LogMap, values: &Array2<f64>, clock: ClockFit) -> Log {
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
            sample_time_s: clock.sample_time_s,
            u,
            y,
            r: there(r),
            position_rad: there(position),
            input_kind: map.input_kind,
            events: Vec::new(),
        },
        losses: Vec::new(),
        warnings: Vec::new(),
        times_s: None,
        two_clocks: None,
        duration_s: values.ncols() as f64 * clock.sample_time_s,
        clock,
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
