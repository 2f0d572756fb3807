//! A recording that frfid did not make: a robot's log in MCAP, CSV or NPZ, read through a [`LogMap`].

use std::path::Path;

use frfid_signals::Record;
use ndarray::Array2;

use crate::clock::{Clock, NOTABLE_JITTER};
use crate::log_map::{LogMap, Signal, to_si};
use crate::loss::{self, Loss};
use crate::{FileError, csv_read, log_mcap, npz_read, structure};

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

/// The samples of the signals of one topic (or of a whole CSV) as they were recorded, with their stamps.
#[derive(Debug, Default)]
pub(crate) struct Series {
    pub(crate) topic: String,
    pub(crate) stamps_ns: Vec<i64>,
    /// Which signals, by their place among all signals of the map.
    pub(crate) signals: Vec<usize>,
    /// One row of values per stamp, in the order of `signals`; NaN where a message does not have the joint.
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

/// Reads a recording: `.csv` and `.csv.gz` by columns, `.npz` by arrays, everything else as MCAP by topics.
///
/// Topics are aligned by their stamps; a constant delay between them is told, not corrected. Nothing is resampled.
///
/// # Errors
/// [`FileError`]: unreadable files, topics, fields, columns or units that are not there, and clocks that are not even.
pub fn read_log(path: &Path, map: &LogMap) -> Result<Log, FileError> {
    if map.u.is_empty() || map.y.is_empty() {
        let found = format!("{} inputs, {} outputs", map.u.len(), map.y.len());
        return Err(FileError::Shape { what: "log map", found, needed: "at least one signal for u and for y".into() });
    }
    for (what, role, size) in [("r", &map.r, map.u.len()), ("position", &map.position, map.y.len())] {
        if !role.is_empty() && role.len() != size {
            let needed = format!("{size}, or none");
            return Err(FileError::Shape { what, found: format!("{} signals", role.len()), needed });
        }
    }
    let signals: Vec<&Signal> = map.roles().into_iter().flatten().collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let ends_with = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
    let recording = if ends_with(&[".csv", ".csv.gz", ".txt", ".txt.gz"]) {
        csv_read::read(path, map, &signals)?
    } else if ends_with(&[".npz"]) {
        npz_read::read(path, map, &signals)?
    } else {
        log_mcap::read(path, &signals)?
    };
    assemble(path, map, &signals, recording)
}

/// Puts the signals of all topics on one clock.
fn assemble(path: &Path, map: &LogMap, signals: &[&Signal], mut recording: Recording) -> Result<Log, FileError> {
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
    if grid.n_samples.saturating_mul(signals.len()) > structure::MOST_VALUES {
        let needed = format!("at most {} values", structure::MOST_VALUES);
        return Err(content("stamps", format!("{} samples", grid.n_samples), needed));
    }
    let mut values = Array2::from_elem((signals.len(), grid.n_samples), f64::NAN);
    let mut losses = grid.fill(&recording.series, &clocks, signals, &mut values);
    for (signal, row) in signals.iter().zip(values.rows()) {
        if row.iter().all(|value| !value.is_finite()) {
            return Err(content(&signal.source, "no number in the whole recording".into(), "a measured signal".into()));
        }
    }
    losses.extend(recording.damages.into_iter().map(|(at_ns, reason)| grid.of_file(at_ns, reason)));
    convert(path, signals, &mut values)?;
    let sample_time_s = recording.sample_time_s.unwrap_or(grid.sample_time_s);
    Ok(sort_into_roles(map, &values, sample_time_s, losses, warnings))
}

/// Refuses stamps that run backwards; drops messages that were recorded twice.
fn drop_duplicates(series: &mut Series, warnings: &mut Vec<String>) -> Result<(), (String, String)> {
    let backwards = series.stamps_ns.windows(2).filter(|pair| pair[1] < pair[0]).count();
    let twice = |k: usize| k > 0 && series.stamps_ns[k] == series.stamps_ns[k - 1];
    let bits = |k: usize| series.rows[k].iter().map(|value| value.to_bits());
    let twins = (0..series.rows.len()).filter(|&k| twice(k)).count();
    let different = (0..series.rows.len()).filter(|&k| twice(k) && !bits(k).eq(bits(k - 1))).count();
    if backwards + different > 0 {
        let found =
            format!("{backwards} stamps before their predecessor, {different} equal ones with different values");
        return Err((found, "rising stamps: several recordings or clocks are mixed".into()));
    }
    if twins > 0 {
        warnings.push(format!("{}: {twins} messages are there twice; one of each was dropped", series.topic));
        let keep: Vec<bool> = (0..series.rows.len()).map(|k| !twice(k)).collect();
        let mut kept = keep.iter();
        series.stamps_ns.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = keep.iter();
        series.rows.retain(|_| *kept.next().unwrap_or(&true));
    }
    Ok(())
}

/// The common clock: sample times of the first topic, over the time that all topics cover.
struct Grid {
    sample_time_s: f64,
    n_samples: usize,
    start_ns: i64,
    /// Grid sample of each topic's own sample 0; negative if it starts before the grid.
    shifts: Vec<i64>,
}

impl Grid {
    fn of(series: &[Series], clocks: &[Clock], warnings: &mut Vec<String>) -> Result<Self, (String, String)> {
        let (Some(first), Some(lead)) = (series.first(), clocks.first()) else {
            return Err(("none".into(), "at least one".into()));
        };
        let step = lead.sample_time_s;
        let mut shifts = Vec::new();
        for (series, clock) in series.iter().zip(clocks) {
            let slip = (clock.sample_time_s / step - 1.0) * clock.n_slots() as f64;
            if slip.abs() > 0.25 {
                let found = format!("{} every {step} s, {} every {} s", first.topic, series.topic, clock.sample_time_s);
                return Err((found, "one rate for all signals; frfid does not resample".into()));
            }
            if clock.jitter > NOTABLE_JITTER {
                warnings.push(format!(
                    "{}: stamps jitter by {:.2} % of the sample time (largest {:.1} %): {:.3} deg of phase error at 10 Hz",
                    series.topic,
                    100.0 * clock.jitter,
                    100.0 * clock.largest_jitter,
                    3600.0 * clock.jitter * step
                ));
            }
            let offset_ns = (series.stamps_ns[0] - first.stamps_ns[0]) as f64 + clock.origin_ns - lead.origin_ns;
            let offset = offset_ns / 1e9 / step;
            let delay = offset - offset.round();
            if delay.abs() > NOTABLE_JITTER {
                warnings.push(format!(
                    "{} is stamped {:.4} ms after {} (a constant delay; not corrected)",
                    series.topic,
                    1e3 * delay * step,
                    first.topic
                ));
            }
            shifts.push(offset.round() as i64);
        }
        let start = shifts.iter().copied().max().unwrap_or(0);
        let ends = shifts.iter().zip(clocks).map(|(shift, clock)| shift.saturating_add(clock.n_slots() as i64));
        let end = ends.min().unwrap_or(0);
        if end <= start {
            return Err(("no time that all topics cover".into(), "recordings of the same run".into()));
        }
        let start_ns = first.stamps_ns[0].saturating_add((start as f64 * step * 1e9).round() as i64);
        let shifts = shifts.into_iter().map(|shift| shift - start).collect();
        Ok(Self { sample_time_s: step, n_samples: (end - start) as usize, start_ns, shifts })
    }

    /// Puts every value in its place; what is missing or no number is told.
    fn fill(&self, series: &[Series], clocks: &[Clock], signals: &[&Signal], values: &mut Array2<f64>) -> Vec<Loss> {
        let mut losses = Vec::new();
        for ((series, clock), shift) in series.iter().zip(clocks).zip(&self.shifts) {
            let mut came = vec![false; self.n_samples];
            for (slot, row) in clock.slots.iter().zip(&series.rows) {
                let sample = usize::try_from(*slot as i64 + shift).ok().filter(|&sample| sample < self.n_samples);
                let Some(sample) = sample else { continue };
                came[sample] = true;
                for (&signal, &value) in series.signals.iter().zip(row) {
                    values[[signal, sample]] = value;
                }
            }
            let gaps = |name: &str, reason, is_lost: &dyn Fn(usize) -> bool| {
                loss::gaps(name, self.n_samples, self.sample_time_s, reason, is_lost)
            };
            losses.extend(gaps(&series.topic, "are missing", &|sample| !came[sample]));
            for &signal in &series.signals {
                let is_lost = |sample: usize| came[sample] && !values[[signal, sample]].is_finite();
                losses.extend(gaps(&signals[signal].source, "are not numbers", &is_lost));
            }
        }
        losses
    }

    fn of_file(&self, at_ns: Option<i64>, reason: String) -> Loss {
        let at_s = at_ns.map_or(0.0, |at| (at as f64 - self.start_ns as f64) / 1e9);
        Loss { topic: "file".into(), from_s: at_s, to_s: at_s, reason }
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
        let rows = values.slice(ndarray::s![taken..taken + role.len(), ..]).to_owned();
        taken += role.len();
        rows
    });
    let there = |signal: Array2<f64>| (signal.nrows() > 0).then_some(signal);
    let names = |role: &[Signal]| role.iter().map(|signal| signal.source.clone()).collect();
    let units = |role: &[Signal]| {
        role.iter().map(|signal| to_si(&signal.unit).map_or(signal.unit.clone(), |(_, si)| si.into())).collect()
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
