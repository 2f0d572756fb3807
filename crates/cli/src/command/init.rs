//! `frfid init`: a description of an experiment, or the log map of a recording, to start from.

use std::path::{Path, PathBuf, absolute};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use frfid_experiment::{GuessedMap, TEMPLATES, Template, description_of_urdf, inspect_recording};
use frfid_files::{path_text, write_bytes};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, existing_path};

/// Write a description of an experiment, or the log map of a recording, to start from
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid init multisine -o experiment.toml
  frfid init chirp                             to look at it first
  frfid init urdf arm.urdf -o experiment.toml  an arm as ROS describes it; gears, motors and friction guessed
  frfid init map robot.mcap -o map.toml        which signal is which, guessed")]
pub(crate) struct Arguments {
    /// Which kind of description
    #[arg(value_parser = kinds())]
    kind: Kind,
    /// The recording, for a map, or the URDF file
    #[arg(value_name = "FILE", value_parser = existing_path(), required_if_eq_any([("kind", "map"), ("kind", "urdf")]))]
    source: Option<PathBuf>,
    /// The file to write; stdout without it
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Link at the base of the arm, where a URDF has several
    #[arg(long, value_name = "LINK")]
    base_link: Option<String>,
    /// Link at the tip of the arm; without it the one to which most moving joints lead
    #[arg(long, value_name = "LINK")]
    tip_link: Option<String>,
}

/// What is written.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Experiment(&'static Template),
    Map,
    Urdf,
}

/// The kinds that are made from a file.
const FROM_FILES: [(&str, &str); 2] = [
    (
        "urdf",
        "the arm in FILE, a URDF, with guesses of motors, gears and friction",
    ),
    (
        "map",
        "which signal of FILE, a recording, is which, guessed from names and types",
    ),
];

fn kinds() -> impl TypedValueParser<Value = Kind> {
    let kinds = TEMPLATES.map(|template| PossibleValue::new(template.kind).help(template.purpose));
    let others = FROM_FILES.map(|(name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(kinds.into_iter().chain(others)).map(|name| kind(&name))
}

/// The kind of a name, which is one of those that are possible.
fn kind(name: &str) -> Kind {
    match Template::named(name) {
        Some(template) => Kind::Experiment(template),
        None if name == "urdf" => Kind::Urdf,
        None => Kind::Map,
    }
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let (text, next) = text(arguments)?;
    match &arguments.output {
        None => console.data(&text)?,
        Some(path) => {
            options.check_output(path, &arguments.source)?;
            write_bytes(path, options.overwrite(), text.as_bytes())?;
            if options.json {
                console.json(&json!({ "output": path_text(path) }))?;
            }
            console.wrote(path);
            console.hint(format_args!("{next} {}", path.display()));
        }
    }
    Ok(Exit::Done)
}

/// What is written, and the command that comes next.
fn text(arguments: &Arguments) -> Result<(String, String), Failure> {
    arguments.check_links()?;
    let file = arguments.source.as_deref().unwrap_or(Path::new(""));
    let check = "frfid check".to_owned();
    match arguments.kind {
        Kind::Experiment(_) if arguments.source.is_some() => Err(no_file_needed(file)),
        Kind::Experiment(template) => Ok((template.text(), check)),
        Kind::Urdf => Ok((arguments.of_urdf(file)?, check)),
        Kind::Map => {
            let next = format!("frfid estimate {} -o frf.json --map", file.display());
            Ok((guessed(file)?.to_toml(), next))
        }
    }
}

fn no_file_needed(file: &Path) -> Failure {
    let file = file.display();
    Failure::usage(format!(
        "{file}: a file is for `frfid init map` and `frfid init urdf` only; leave it out"
    ))
}

impl Arguments {
    /// Refuses links where there is no URDF to have them.
    fn check_links(&self) -> Result<(), Failure> {
        let mut links = self.base_link.iter().chain(&self.tip_link);
        match (self.kind, links.next()) {
            (Kind::Urdf, _) | (_, None) => Ok(()),
            (_, Some(link)) => Err(Failure::usage(format!(
                "{link}: a link is for `frfid init urdf` only; leave it out"
            ))),
        }
    }

    fn of_urdf(&self, file: &Path) -> Result<String, Failure> {
        let output = self.output.as_deref().unwrap_or(Path::new(""));
        let name = seen_from(output, file).display().to_string();
        let (base, tip) = (self.base_link.as_deref(), self.tip_link.as_deref());
        Ok(description_of_urdf(file, &name, base, tip)?)
    }
}

/// A file as it is named in another, which looks it up beside itself.
fn seen_from(from: &Path, file: &Path) -> PathBuf {
    let folder = from.parent().unwrap_or(from);
    let beside = file.strip_prefix(folder).map(Path::to_owned);
    let far = |_| absolute(file).unwrap_or_else(|_| file.to_owned());
    beside.unwrap_or_else(far)
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
