//! Map of the signals of a recording: which is which, from a TOML file or from options.

use std::path::PathBuf;

use clap::Args;
use frfid_experiment::TomlText;
use frfid_files::{FORMATS, Format, LogMap, Signal};
use frfid_signals::InputKind;

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
    /// Column or array of the sample times of a CSV or NPZ
    #[arg(long, value_name = "COLUMN=UNIT", value_parser = signal, requires = "u")]
    time: Option<Signal>,
    /// Sample time in s of a CSV or NPZ without sample times
    #[arg(long, value_name = "S", requires = "u")]
    sample_time_s: Option<f64>,
}

impl MapOptions {
    /// The map; `None` where nothing is said, for logs of our own.
    ///
    /// # Errors
    /// [`Failure`] with line and caret for a file that is no map.
    pub(crate) fn log_map(&self) -> Result<Option<LogMap>, Failure> {
        if let Some(path) = &self.map {
            return Ok(Some(TomlText::read(path)?.parse()?));
        }
        Ok((!self.u.is_empty()).then(|| LogMap {
            u: self.u.clone(),
            y: self.y.clone(),
            r: self.r.clone(),
            position: self.position.clone(),
            input_kind: InputKind::Measured,
            time: self.time.clone(),
            sample_time_s: self.sample_time_s,
        }))
    }
}

/// How a signal is named in each format of recordings.
fn input_help() -> String {
    let named = |format: &Format| format!("{}=UNIT in {}", format.source, format.name);
    let named: Vec<String> = FORMATS.iter().map(named).collect();
    format!("An input: {}; once for each channel", named.join(", "))
}

/// Reads `SOURCE=UNIT`; the source may hold equals signs, a unit cannot.
fn signal(text: &str) -> Result<Signal, String> {
    match text.rsplit_once('=') {
        Some((source, unit)) if !source.is_empty() && !unit.is_empty() => Ok(Signal {
            source: source.into(),
            unit: unit.trim().into(),
            scale: 1.0,
        }),
        _ => Err(
            "needed: SIGNAL=UNIT, as in '/joint_states:effort[elbow]=N m' or 'current=A'".into(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
