//! `frfid init`: a description of an experiment, or the log map of a recording, to start from.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use frfid_experiment::{GuessedMap, TEMPLATES, Template, inspect_recording};
use frfid_files::write_bytes;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, existing_path};

/// Write a description of an experiment, or the log map of a recording, to start from
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid init multisine -o experiment.toml
  frfid init chirp                          to look at it first
  frfid init map robot.mcap -o map.toml     which signal is which, guessed")]
pub(crate) struct Arguments {
    /// Which kind of description
    #[arg(value_parser = kinds())]
    kind: Kind,
    /// The recording, for a map
    #[arg(value_name = "RECORDING", value_parser = existing_path(), required_if_eq("kind", "map"))]
    recording: Option<PathBuf>,
    /// The file to write; stdout without it
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// What is written.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Experiment(&'static Template),
    Map,
}

fn kinds() -> impl TypedValueParser<Value = Kind> {
    let kinds = TEMPLATES.map(|template| PossibleValue::new(template.kind).help(template.purpose));
    let map = PossibleValue::new("map")
        .help("which signal of RECORDING is which, guessed from names and types");
    let kinds = PossibleValuesParser::new(kinds.into_iter().chain([map]));
    kinds.map(|kind| Template::named(&kind).map_or(Kind::Map, Kind::Experiment))
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let recording = arguments.recording.as_deref();
    let (text, next) = match (arguments.kind, recording) {
        (Kind::Experiment(_), Some(recording)) => return Err(no_recording_needed(recording)),
        (Kind::Experiment(template), None) => (template.text(), "frfid check".to_owned()),
        (Kind::Map, recording) => {
            let recording = recording.unwrap_or(Path::new(""));
            let next = format!("frfid estimate {} -o frf.json --map", recording.display());
            (guessed(recording)?.to_toml(), next)
        }
    };
    match &arguments.output {
        None => console.data(&text)?,
        Some(path) => {
            write_bytes(path, options.overwrite(), text.as_bytes())?;
            console.wrote(path);
            console.hint(format_args!("{next} {}", path.display()));
        }
    }
    Ok(Exit::Done)
}

fn no_recording_needed(recording: &Path) -> Failure {
    let recording = recording.display();
    Failure::usage(format!(
        "{recording}: a recording is for `frfid init map` only; leave it out"
    ))
}

fn guessed(recording: &Path) -> Result<GuessedMap, Failure> {
    let map = inspect_recording(recording)?.map;
    map.ok_or_else(|| {
        let recording = recording.display();
        Failure::usage(format!(
            "{recording}: found no signals that by their names drive a plant and answer it; see what is in it by \
             frfid inspect {recording}, and write the map by hand (u and y, each a list of source and unit)"
        ))
    })
}
