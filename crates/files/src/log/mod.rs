//! A recording that frfid did not make: a robot's log in MCAP, CSV or NPZ, read through a
//! [`LogMap`].

pub(crate) mod alignment;
pub(crate) mod clock;
pub(crate) mod csv;
pub(crate) mod map;
pub(crate) mod mcap;
pub(crate) mod npz;
#[cfg(test)]
mod tests;

use std::path::Path;

use frfid_signals::Record;
use ndarray::Array2;

use crate::error::FileError;
use crate::log::alignment::{Grid, drop_duplicates};
use crate::log::clock::Clock;
use crate::log::map::{LogMap, Signal, to_si};
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

/// The samples of the signals of one topic (or of a whole CSV) as they were recorded, with their
/// stamps.
#[derive(Debug, Default)]
pub(crate) struct Series {
    pub(crate) topic: String,
    pub(crate) stamps_ns: Vec<i64>,
    /// Which signals, by their place among all signals of the map.
    pub(crate) signals: Vec<usize>,
    /// One row of values per stamp, in the order of `signals`; NaN where a message does not have
    /// the joint.
    pub(crate) rows: Vec<Vec<f64>>,
}

/// What a reader of one format delivers.
#[derive(Debug, Default)]
pub(crate) struct Recording {
    pub(crate) series: Vec<Series>,
    /// Damage to the file, at times in ns where these are known.
    pub(crate) damages: Vec<(Option<i64>, String)>,
    pub(crate) warnings: Vec<String>,
    /// The sample time in s where the user gave it.
    pub(crate) sample_time_s: Option<f64>,
}

/// Reads a recording: `.csv` and `.csv.gz` by columns, `.npz` by arrays, everything else as MCAP by
/// topics.
///
/// Topics are aligned by their stamps; a constant delay between them is told, not corrected.
/// Nothing is resampled.
///
/// # Errors
/// [`FileError`]: unreadable files, topics, fields, columns or units that are not there, and clocks
/// that are not even.
pub fn read_log(path: &Path, map: &LogMap) -> Result<Log, FileError> {
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
    let signals: Vec<&Signal> = map.roles().into_iter().flatten().collect();
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let ends_with = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
    let recording = if ends_with(&[".csv", ".csv.gz", ".txt", ".txt.gz"]) {
        csv::read(path, map, &signals)?
    } else if ends_with(&[".npz"]) {
        npz::read(path, map, &signals)?
    } else {
        mcap::read(path, &signals)?
    };
    assemble(path, map, &signals, recording)
}

/// Puts the signals of all topics on one clock.
fn assemble(
    path: &Path,
    map: &LogMap,
    signals: &[&Signal],
    mut recording: Recording,
) -> Result<Log, FileError> {
    let content = |what: &str, found: String, needed: String| FileError::Content {
        path: path.into(),
        what: what.into(),
        found,
        needed,
    };
    let mut warnings = recording.warnings;
    let mut clocks = Vec::new();
    for series in &mut recording.series {
        drop_duplicates(series, &mut warnings)
            .and_then(|()| Clock::fit(&series.stamps_ns))
            .map(|clock| clocks.push(clock))
            .map_err(|(found, needed)| content(&series.topic, found, needed))?;
    }
    let grid = Grid::of(&recording.series, &clocks, &mut warnings)
        .map_err(|(found, needed)| content("topics", found, needed))?;
    if grid.n_samples.saturating_mul(signals.len()) > header::MOST_VALUES {
        let needed = format!("at most {} values", header::MOST_VALUES);
        return Err(content(
            "stamps",
            format!("{} samples", grid.n_samples),
            needed,
        ));
    }
    let mut values = Array2::from_elem((signals.len(), grid.n_samples), f64::NAN);
    let mut losses = grid.fill(&recording.series, &clocks, signals, &mut values);
    for (signal, row) in signals.iter().zip(values.rows()) {
        if row.iter().all(|value| !value.is_finite()) {
            return Err(content(
                &signal.source,
                "no number in the whole recording".into(),
                "a measured signal".into(),
            ));
        }
    }
    losses.extend(
        recording
            .damages
            .into_iter()
            .map(|(at_ns, reason)| grid.of_file(at_ns, reason)),
    );
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

fn convert(path: &Path, signals: &[&Signal], values: &mut Array2<f64>) -> Result<(), FileError> {
    for (signal, mut row) in signals.iter().zip(values.rows_mut()) {
        let (factor, _) = si_of(path, signal)?;
        let scale = factor * signal.scale;
        row.mapv_inplace(|value| scale * value);
    }
    Ok(())
}

pub(crate) fn si_of(path: &Path, signal: &Signal) -> Result<(f64, &'static str), FileError> {
    to_si(&signal.unit).map_err(|needed| FileError::Content {
        path: path.into(),
        what: format!("unit of {} in the log map", signal.source),
        found: format!("`{}`", signal.unit),
        needed,
    })
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
