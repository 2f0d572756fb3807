//! `frfid inspect`: what is in a file, and what would be made of it.

use std::path::PathBuf;

use clap::Args;
use frfid_experiment::{
    EstimateOptions, GuessedMap, Outcome, Steps, estimate_logs, for_each, recordings_among,
};
use frfid_files::LogMap;
use serde_json::{Value, json};

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::log_map::MapOptions;
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
    map: MapOptions,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let stated = arguments.map.log_map()?;
    let files = recordings_among(&arguments.files)?;
    let (looked, estimate) = watched(console, "looking", "files", |progress| {
        let steps = Steps {
            progress,
            before: 0,
            total: files.len(),
        };
        let looked = for_each(&files, 1, steps, |path| Looked::of(path))?;
        let estimate = estimated(&files, &looked, stated.as_ref());
        Ok::<_, Failure>((looked, estimate))
    })?;
    let guessed = looked
        .iter()
        .find_map(Looked::guessed)
        .filter(|_| stated.is_none());
    if options.json {
        console.json(&as_json(&files, &looked, guessed, estimate.as_ref()))?;
        return Ok(Exit::Done);
    }
    for (path, looked) in files.iter().zip(&looked) {
        console.data(&looked.as_text(path))?;
    }
    if let Some(guessed) = guessed {
        console.data(&format!("log map\n{}", indented(&guessed.to_toml())))?;
    }
    if let Some(estimate) = &estimate {
        console.data(&estimate_as_text(estimate))?;
    }
    hint(&files, &looked, guessed.is_some(), console);
    Ok(Exit::Done)
}

/// The estimate that the files would give, or why there would be none; `None` of files that are no logs.
fn estimated(
    files: &[PathBuf],
    looked: &[Looked],
    stated: Option<&LogMap>,
) -> Option<Result<Outcome, String>> {
    let is_ours = looked
        .iter()
        .any(|looked| matches!(looked, Looked::OurLog(_)));
    let guessed = || {
        looked
            .iter()
            .find_map(Looked::guessed)
            .map(|guessed| guessed.map.clone())
    };
    let map = stated.cloned().or_else(guessed).filter(|_| !is_ours);
    let logs = files
        .iter()
        .zip(looked)
        .filter(|(_, looked)| looked.is_log());
    let logs: Vec<PathBuf> = logs.map(|(path, _)| path.clone()).collect();
    let is_possible = !logs.is_empty() && (is_ours || map.is_some());
    let options = EstimateOptions {
        map,
        ..EstimateOptions::default()
    };
    let outcome = || estimate_logs(&logs, &options, &|_, _| true);
    is_possible.then(|| outcome().map_err(|error| Failure::from(error).message))
}

/// The next command.
fn hint(files: &[PathBuf], looked: &[Looked], is_guessed: bool, console: &mut Console) {
    let names: Vec<String> = files
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let names = if names.len() > 3 {
        format!("{} ...", names[0])
    } else {
        names.join(" ")
    };
    match looked.first() {
        Some(Looked::Recording(_)) if is_guessed => {
            console.hint(format_args!(
                "frfid init map {} -o map.toml, then frfid estimate {names} -o frf.json --map map.toml",
                files[0].display()
            ));
        }
        Some(Looked::Recording(_)) => {
            console.hint(format_args!(
                "frfid estimate {names} -o frf.json --u SIGNAL=UNIT --y SIGNAL=UNIT, with signals of the table above"
            ));
        }
        Some(Looked::OurLog(_)) => console.hint(format_args!("frfid estimate {names} -o frf.json")),
        Some(Looked::Plan(_)) => console.hint(format_args!("frfid run {names} -o logs")),
        Some(Looked::Result(_)) => console.hint(format_args!("frfid export {names} -o frf.csv")),
        None => {}
    }
}

fn as_json(
    files: &[PathBuf],
    looked: &[Looked],
    guessed: Option<&GuessedMap>,
    estimate: Option<&Result<Outcome, String>>,
) -> Value {
    let files = files
        .iter()
        .zip(looked)
        .map(|(path, looked)| looked.as_json(path));
    let estimate = estimate.map(|estimate| match estimate {
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
    });
    json!({
        "files": files.collect::<Vec<_>>(),
        "map": guessed.map(|guessed| &guessed.map),
        "map_toml": guessed.map(GuessedMap::to_toml),
        "estimate": estimate,
    })
}
