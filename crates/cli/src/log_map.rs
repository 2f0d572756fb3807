//! Map of the signals of a recording: which is which, from a TOML file or from options.

use std::path::PathBuf;

use clap::Args;
use frfid_experiment::TomlText;
use frfid_files::{FORMATS, Format, LogMap, Signal};

use crate::exit::Failure;

/// Options for recordings that frfid did not make.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Recordings that frfid did not make")]
pub(crate) struct MapOptions {
    /// Which signal is which, as TOML; or say it with the options below
    #[arg(long, value_name = "MAP.toml", conflicts_with_all = ["u", "y", "r", "position", "time", "sample_time_s"])]
    map: Option<PathBuf>,
    #[arg(long, value_name = "SIGNAL=UNIT", value_parser = signal, requires = "y", help = input_help())]
    u: Vec<Signal>,
    /// An output, in the same way
    #[arg(long, value_name = "SIGNAL=UNIT", value_parser = signal, requires = "u")]
    y: Vec<Signal>,
    /// The reference, one for each input: period and lines are found in it
    #[arg(long, value_name = "SIGNAL=UNIT", value_parser = signal, requires = "u")]
    r: Vec<Signal>,
    /// A position, one for each output
    #[arg(long, value_name = "SIGNAL=UNIT", value_parser = signal, requires = "u")]
    position: Vec<Signal>,
    /// Column or array of the sample times of a CSV, MAT or NPZ
    #[arg(long, value_name = "COLUMN=UNIT", value_parser = signal, requires = "u")]
    time: Option<Signal>,
    /// Sample time in s of a CSV, MAT or NPZ without sample times
    #[arg(long, value_name = "S", requires = "u")]
    sample_time_s: Option<f64>,
    /// Use the recordings from here on, in s after their first sample
    #[arg(long, value_name = "S")]
    start: Option<f64>,
    /// Use the recordings until here, in s after their first sample
    #[arg(long, value_name = "S")]
    end: Option<f64>,
    /// Period of the excitation in s, in place of the one found in the reference
    #[arg(long, value_name = "S")]
    period: Option<f64>,
    /// Excited lines as multiples of 1/period, in place of those found: numbers, FIRST:LAST, FIRST:LAST:STEP
    #[arg(long, value_name = "LINES", value_delimiter = ',', value_parser = lines)]
    lines: Vec<Lines>,
    /// Nothing repeats in the recordings: estimate them as whole records; found out without it
    #[arg(long)]
    aperiodic: bool,
    /// Realization of each recording (or run in one) in their order, in place of the measured one
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    realization_of: Vec<usize>,
}

/// One number of a list of lines, or a range of them.
type Lines = std::iter::StepBy<std::ops::RangeInclusive<usize>>;

impl MapOptions {
    /// The file that says which signal is which.
    pub(crate) fn file(&self) -> Option<&PathBuf> {
        self.map.as_ref()
    }

    /// The map; `None` where nothing is said, for logs of our own.
    ///
    /// # Errors
    /// [`Failure`] with line and caret for a file that is no map.
    pub(crate) fn log_map(&self) -> Result<Option<LogMap>, Failure> {
        let map = match &self.map {
            Some(path) => Some(TomlText::read(path)?.parse()?),
            None => self.map_of_options(),
        };
        if map.is_none() && self.says_more() {
            return Err(Failure::usage(
                "--start, --end, --period, --lines, --aperiodic and --realization-of are for recordings that frfid \
                 did not make; needed: a log map, --map or --u and --y",
            ));
        }
        Ok(map.map(|map| self.with_what_is_known(map)))
    }

    /// The map of the signals that are named one by one; `None` without any.
    fn map_of_options(&self) -> Option<LogMap> {
        (!self.u.is_empty()).then(|| LogMap {
            r: self.r.clone(),
            position: self.position.clone(),
            time: self.time.clone(),
            sample_time_s: self.sample_time_s,
            ..LogMap::new(self.u.clone(), self.y.clone())
        })
    }

    fn says_more(&self) -> bool {
        let numbers = [self.start, self.end, self.period];
        let is_list = !self.lines.is_empty() || !self.realization_of.is_empty();
        is_list || self.aperiodic || numbers.iter().any(Option::is_some)
    }

    /// The map with what is known of the excitation; options outweigh the keys of a file.
    fn with_what_is_known(&self, map: LogMap) -> LogMap {
        let lines: Vec<usize> = self.lines.iter().cloned().flatten().collect();
        let there = |list: Vec<usize>| (!list.is_empty()).then_some(list);
        LogMap {
            start_s: self.start.or(map.start_s),
            end_s: self.end.or(map.end_s),
            period_s: self.period.or(map.period_s),
            lines: there(lines).or(map.lines),
            aperiodic: self.aperiodic || map.aperiodic,
            realization_of: there(self.realization_of.clone()).or(map.realization_of),
            ..map
        }
    }
}

/// Reads `5`, `5:9` or `5:9:2`.
fn lines(text: &str) -> Result<Lines, String> {
    let numbers: Result<Vec<usize>, _> = text.split(':').map(str::parse).collect();
    let (first, last, step) = match numbers.as_deref() {
        Ok(&[line]) => (line, line, 1),
        Ok(&[first, last]) => (first, last, 1),
        Ok(&[first, last, step]) => (first, last, step),
        _ => (1, 0, 0),
    };
    if (1..=last).contains(&first) && last <= MOST_LINES && step > 0 {
        return Ok((first..=last).step_by(step));
    }
    Err("needed: a line from 1 on, FIRST:LAST or FIRST:LAST:STEP, as in 5:159:2".into())
}

/// No period has more lines than this.
const MOST_LINES: usize = 1 << 26;

/// How a signal is named in each format of recordings.
fn input_help() -> String {
    let named = |format: &Format| format!("{}=UNIT in {}", format.source, format.name);
    let named: Vec<String> = FORMATS.iter().map(named).collect();
    format!("An input: {}; once for each channel", named.join(", "))
}

/// Reads `SOURCE=UNIT`; the source may hold equals signs, a unit cannot.
fn signal(text: &str) -> Result<Signal, String> {
    match text.rsplit_once('=') {
        Some((source, unit)) if !source.is_empty() && !unit.is_empty() => {
            Ok(Signal::of(source, unit.trim()))
        }
        _ => Err(
            "needed: SIGNAL=UNIT, as in '/joint_states:effort[elbow]=N m' or 'current=A'".into(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbers_and_ranges() {
        let all = |text| lines(text).map(Iterator::collect::<Vec<_>>);
        assert_eq!(all("7"), Ok(vec![7]));
        assert_eq!(all("5:7"), Ok(vec![5, 6, 7]));
        assert_eq!(all("5:10:2"), Ok(vec![5, 7, 9]));
        for text in ["", "0", "9:5", "1:9:0", "1:2:3:4", "a", "1:99999999999"] {
            assert!(
                all(text).is_err_and(|error| error.starts_with("needed: a line")),
                "{text}"
            );
        }
    }

    #[test]
    fn a_signal_is_its_source_and_its_unit() {
        let read = signal("/a=b:effort[x]=N m").expect("sound");
        assert_eq!(
            (read.source.as_str(), read.unit.as_str()),
            ("/a=b:effort[x]", "N m")
        );
        for text in ["effort", "=A", "current="] {
            let error = signal(text).expect_err(text);
            assert!(error.starts_with("needed: SIGNAL=UNIT"), "{error}");
        }
    }
}
