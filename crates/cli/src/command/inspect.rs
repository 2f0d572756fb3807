//! `frfid inspect`: what is in a file, and what would be made of it.

use std::path::PathBuf;

use clap::Args;
use frfid_experiment::{
    EstimateOptions, ExperimentError, GuessedMap, Outcome, Progress, Steps, estimate_logs,
    for_each, recordings_among, silent,
};
use frfid_files::LogMap;
use serde_json::{Value, json};

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check_all};
use crate::interrupt;
use crate::log_map::MapOptions;
use crate::memory::MemoryOption;
use crate::options::{Options, existing_path};
use crate::progress::watched;
use crate::text::looked::{Looked, estimate_as_text};
use crate::text::table::indented;

/// Look into logs, plans and results: what is in them, a guessed log map, what an estimate would say
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid inspect robot.mcap
  frfid inspect bench.csv --map bench.toml      with the map that you wrote
  frfid inspect logs
  frfid inspect frf.json")]
pub(crate) struct Arguments {
    /// Recordings of any format, folders of them, plans, results
    #[arg(value_name = "FILES", required = true, value_parser = existing_path())]
    files: Vec<PathBuf>,
    #[command(flatten)]
    memory: MemoryOption,
    #[command(flatten)]
    map: MapOptions,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    arguments.memory.apply();
    check_all(&arguments.files, Needed::Any)?;
    let stated = arguments.map.log_map()?;
    let files = recordings_among(&arguments.files)?;
    interrupt::ends_reading();
    let found = watched(console, "looking", "files", |progress| {
        Found::of(files, stated, progress)
    })?;
    interrupt::check()?;
    if options.json {
        console.json(&found.as_json())?;
        return Ok(Exit::Done);
    }
    console.data(&found.as_text())?;
    if let Some(next) = found.next() {
        console.hint(next);
    }
    Ok(Exit::Done)
}

/// What was found in all files.
struct Found {
    files: Vec<PathBuf>,
    looked: Vec<Looked>,
    /// The map that was given.
    stated: Option<LogMap>,
    /// What an estimate would find, or why it would refuse; `None` of files that are no logs.
    estimate: Option<Result<Outcome, String>>,
}

impl Found {
    fn of(
        files: Vec<PathBuf>,
        stated: Option<LogMap>,
        progress: Progress,
    ) -> Result<Self, ExperimentError> {
        let steps = Steps {
            progress,
            before: 0,
            total: files.len(),
        };
        let looked = for_each(&files, 1, steps, |path, _| Looked::of(path))?;
        let mut found = Self {
            files,
            looked,
            stated,
            estimate: None,
        };
        found.estimate = found.estimated();
        Ok(found)
    }

    /// The map that was guessed from the first recording; `None` where one was given.
    fn guessed(&self) -> Option<&GuessedMap> {
        let is_open = self.stated.is_none();
        self.looked
            .iter()
            .find_map(Looked::guessed)
            .filter(|_| is_open)
    }

    fn has_ours(&self) -> bool {
        self.looked
            .iter()
            .any(|looked| matches!(looked, Looked::OurLog(_)))
    }

    fn logs(&self) -> Vec<PathBuf> {
        let mut logs = self.files.clone();
        let mut looked = self.looked.iter();
        logs.retain(|_| looked.next().is_some_and(Looked::is_log));
        logs
    }

    fn estimated(&self) -> Option<Result<Outcome, String>> {
        let (logs, is_ours) = (self.logs(), self.has_ours());
        let guessed = || self.guessed().map(|guessed| guessed.map.clone());
        let options = EstimateOptions {
            map: self.stated.clone().or_else(guessed).filter(|_| !is_ours),
            ..EstimateOptions::default()
        };
        let is_possible = !logs.is_empty() && (is_ours || options.map.is_some());
        let outcome = || estimate_logs(&logs, &options, &silent);
        is_possible.then(|| outcome().map_err(|error| Failure::from(error).message))
    }

    fn as_text(&self) -> String {
        let files = self.files.iter().zip(&self.looked);
        let mut text: String = files.map(|(path, looked)| looked.as_text(path)).collect();
        if let Some(guessed) = self.guessed() {
            text += &format!("log map\n{}", indented(&guessed.to_toml()));
        }
        text + &self
            .estimate
            .as_ref()
            .map(estimate_as_text)
            .unwrap_or_default()
    }

    /// The next command.
    fn next(&self) -> Option<String> {
        let names = names(&self.files);
        let first = self.files.first()?.display();
        Some(match self.looked.first()? {
            Looked::Recording(_) if self.guessed().is_some() => format!(
                "frfid init map {first} -o map.toml, then frfid estimate {names} -o frf.json --map map.toml"
            ),
            Looked::Recording(_) if self.stated.is_some() => {
                format!("frfid estimate {names} -o frf.json, with the same map")
            }
            Looked::Recording(inspection) if inspection.has_no_signal() => return None,
            Looked::Recording(_) => format!(
                "frfid estimate {names} -o frf.json --u SIGNAL=UNIT --y SIGNAL=UNIT, with signals of the table above"
            ),
            Looked::OurLog(_) => format!("frfid estimate {names} -o frf.json"),
            Looked::Plan(_) => format!("frfid run {first} -o logs"),
            Looked::Result(_) => format!("frfid report {names} -o frf.html"),
        })
    }

    fn as_json(&self) -> Value {
        let files = self.files.iter().zip(&self.looked);
        let files = files.map(|(path, looked)| looked.as_json(path));
        json!({
            "files": files.collect::<Vec<_>>(),
            "map": self.guessed().map(|guessed| &guessed.map),
            "map_toml": self.guessed().map(GuessedMap::to_toml),
            "estimate": self.estimate.as_ref().map(estimate_as_json),
        })
    }
}

/// The files, or the first of many.
fn names(files: &[PathBuf]) -> String {
    let named = |path: &PathBuf| path.display().to_string();
    match files {
        [first, _, _, _, ..] => named(first) + " ...",
        few => few.iter().map(named).collect::<Vec<_>>().join(" "),
    }
}

fn estimate_as_json(estimate: &Result<Outcome, String>) -> Value {
    match estimate {
        Ok(Outcome {
            result, warnings, ..
        }) => json!({
            "n_frequencies": result.frf.n_frequencies(),
            "low_hz": result.frf.frequency_hz.first(),
            "high_hz": result.frf.frequency_hz.last(),
            "verdicts": result.verdicts,
            "checks": result.checks,
            "provenance": result.provenance,
            "warnings": warnings,
        }),
        Err(message) => json!({"refused": message}),
    }
}
