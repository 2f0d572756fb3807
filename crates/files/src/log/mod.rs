//! Logs that frfid did not make: read through a [`LogMap`], put on one clock, converted to SI.

pub(crate) mod alignment;
pub(crate) mod arrays;
pub(crate) mod bag;
pub(crate) mod clock;
pub(crate) mod csv;
pub(crate) mod decimal;
pub(crate) mod formats;
pub(crate) mod listing;
pub(crate) mod map;
pub(crate) mod mat;
pub(crate) mod packed;
pub(crate) mod plan_clock;
pub(crate) mod recording;
mod roles;
pub(crate) mod sample_times;
pub(crate) mod table;
#[cfg(test)]
mod tests;
pub(crate) mod text;
pub(crate) mod units;

use std::path::Path;

use frfid_signals::Record;
use frfid_signals::format::count;
use ndarray::Array2;

use crate::budget::Budget;
use crate::error::FileError;
use crate::log::alignment::Grid;
use crate::log::alignment::pairing::{Paced, delay_warnings, stamp_warnings, two_clocks};
use crate::log::bag::folder::{self, is_bag_folder};
use crate::log::clock::{Clock, Flaw};
use crate::log::formats::Format;
use crate::log::map::{LogMap, Signal};
use crate::log::plan_clock::PlanClock;
use crate::log::recording::{Recording, Series, of_damaged};
use crate::log::roles::sort_into_roles;
use crate::log::units::names::name_says_otherwise;
use crate::log::units::si_of;
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
    /// Where each reference comes from; empty without.
    pub reference_names: Vec<String>,
    /// SI unit of each reference.
    pub reference_units: Vec<String>,
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
    /// The player's own clock, where the map names it.
    pub plan_clock: Option<PlanClock>,
    /// The number of the plan, sample by sample, where the map names it.
    pub plan_id: Option<Vec<f64>>,
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

/// Reads a recording in one of the [`formats::FORMATS`], or the folder of one by rosbag2.
///
/// Topics are aligned by their stamps; a constant delay between them is reported, not corrected.
/// Nothing is resampled.
///
/// # Errors
/// [`FileError`]: unreadable files, topics, fields, columns or units that are not there, and clocks
/// that are not even.
pub fn read_log(path: &Path, map: &LogMap) -> Result<Log, FileError> {
    check(map)?;
    let source = Source::of(path, map);
    let mut recording = match is_bag_folder(path) {
        true => folder::read(path, &source.signals)?,
        false => Format::read_any(path, map, &source.signals)?,
    };
    let log = source.assemble(&mut recording);
    log.map_err(|error| of_damaged(error, &recording.damages))
}

/// Refuses a map without inputs or outputs, roles of other sizes, and what is no sample time.
fn check(map: &LogMap) -> Result<(), FileError> {
    check_plant(map.u.len(), map.y.len())?;
    map.sample_time_s
        .map_or(Ok(()), header::check_sample_time)?;
    check_size("r", &map.r, map.u.len())?;
    check_size("position", &map.position, map.y.len())?;
    PlanClock::check(&map.plan_clock)
}

fn check_plant(n_inputs: usize, n_outputs: usize) -> Result<(), FileError> {
    if n_inputs > 0 && n_outputs > 0 {
        return Ok(());
    }
    let found = format!("{n_inputs} inputs, {n_outputs} outputs");
    let needed = "at least one signal for u and for y";
    Err(FileError::shape("log map", found, needed))
}

/// Refuses a role with another number of signals; it may have none.
fn check_size(what: &'static str, role: &[Signal], size: usize) -> Result<(), FileError> {
    if role.is_empty() || role.len() == size {
        return Ok(());
    }
    let found = format!("{} signals", role.len());
    Err(FileError::shape(what, found, format!("{size}, or none")))
}

/// A recording and what is mapped of it.
struct Source<'s> {
    path: &'s Path,
    map: &'s LogMap,
    /// All signals of the map, role by role.
    signals: Vec<&'s Signal>,
}

impl<'s> Source<'s> {
    fn of(path: &'s Path, map: &'s LogMap) -> Self {
        Self {
            path,
            map,
            signals: map.roles().into_iter().flatten().collect(),
        }
    }

    /// Puts the signals of all topics on one clock.
    fn assemble(&self, recording: &mut Recording) -> Result<Log, FileError> {
        let clocks = self.clocks(recording)?;
        let topics = self.paced(&recording.series, &clocks);
        let mut warnings = recording.warnings.clone();
        let signals = self.signals.iter();
        warnings.extend(signals.filter_map(|signal| name_says_otherwise(signal)));
        let grid = Grid::of(&topics, &mut warnings).map_err(|flaw| self.flawed("topics", flaw))?;
        warnings.extend(told(&topics));
        let mut values = self.no_values(grid.n_samples)?;
        let mut losses = grid.fill(&topics, &self.signals, &mut values);
        losses.extend(grid.of_file(&recording.damages));
        let two_clocks = two_clocks(&topics);
        let (times_s, clock) = (grid.times_s(&topics[0]), grid.clock_fit(&topics[0]));
        drop(topics);
        recording.series = Vec::new(); // as large as the values: not held beside their copies
        self.check_measured(&values)?;
        self.convert(&mut values)?;
        Ok(Log {
            losses,
            warnings,
            two_clocks,
            times_s,
            ..sort_into_roles(self.map, &values, clock)
        })
    }

    /// The clock of each series, whose rows are put in order.
    fn clocks(&self, recording: &mut Recording) -> Result<Vec<Clock>, FileError> {
        let warnings = &mut recording.warnings;
        let series = recording.series.iter_mut();
        series.map(|series| self.clock(series, warnings)).collect()
    }

    fn clock(&self, series: &mut Series, warnings: &mut Vec<String>) -> Result<Clock, FileError> {
        let clock = Clock::of(series, self.map.sample_time_s, warnings);
        clock.map_err(|flaw| self.flawed(&series.topic, flaw))
    }

    /// The topics with their clocks and roles.
    fn paced<'t>(&self, series: &'t [Series], clocks: &'t [Clock]) -> Vec<Paced<'t>> {
        let topics = series.iter().zip(clocks);
        let paced = topics.map(|(series, clock)| Paced::of(self.map, series, clock));
        paced.collect()
    }

    /// Room for the values of all signals; refuses more than a file may hold.
    fn no_values(&self, n_samples: usize) -> Result<Array2<f64>, FileError> {
        let shape = (self.signals.len(), n_samples);
        let n_bytes = 8 * n_samples.saturating_mul(shape.0) as u64;
        let what = format_args!("{n_samples} samples of {}", count(shape.0, "signal"));
        Budget::allowed(self.path).check(what, n_bytes)?;
        if n_samples.saturating_mul(shape.0) <= header::MOST_VALUES {
            return Ok(Array2::from_elem(shape, f64::NAN));
        }
        Err(self.too_long(n_samples))
    }

    fn too_long(&self, n_samples: usize) -> FileError {
        let found = format!("{n_samples} samples");
        let needed = format!("at most {} values", header::MOST_VALUES);
        self.bad("stamps", found, needed)
    }

    /// Refuses signals without a single number.
    fn check_measured(&self, values: &Array2<f64>) -> Result<(), FileError> {
        for (signal, row) in self.signals.iter().zip(values.rows()) {
            if !row.iter().any(|value| value.is_finite()) {
                return Err(self.not_measured(signal));
            }
        }
        Ok(())
    }

    fn not_measured(&self, signal: &Signal) -> FileError {
        let found = "no number in the whole recording";
        self.bad(&signal.source, found, "a measured signal")
    }

    /// Converts every signal to SI.
    fn convert(&self, values: &mut Array2<f64>) -> Result<(), FileError> {
        for (signal, mut row) in self.signals.iter().zip(values.rows_mut()) {
            row *= self.scale(signal)?;
        }
        Ok(())
    }

    fn scale(&self, signal: &Signal) -> Result<f64, FileError> {
        let (factor, _) = si_of(self.path, signal)?;
        Ok(factor * signal.scale)
    }

    fn flawed(&self, what: &str, (found, needed): Flaw) -> FileError {
        self.bad(what, found, needed)
    }

    fn bad(&self, what: &str, found: impl Into<String>, needed: impl Into<String>) -> FileError {
        FileError::content(self.path, what, found, needed)
    }
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
