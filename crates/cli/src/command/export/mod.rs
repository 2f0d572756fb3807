//! `frfid export`: a result for other tools, a plan for the players of robots.

mod plan;
mod result;

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use frfid_files::{EXPORTS, FileKind, PLAY_FORMATS};

use crate::command::export::plan::PlanArguments;
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::options::{Options, existing_path};

/// Write a result for other tools, or a plan for a robot's player
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid export frf.json -o frf.csv
  frfid export frf.json -o frf.npz              then numpy.load(\"frf.npz\")[\"response\"]
  frfid export frf.json --to csv -o frf.txt     another ending than the format's
  frfid export plan.mcap --to csv -o played     a file for each run, runs.csv, and plan.html: read it first
  frfid export plan.mcap --campaign --rate 250 -o all.csv    every run in one file")]
pub(crate) struct Arguments {
    /// Result of frfid estimate; or a plan, or a description
    #[arg(value_name = "RESULT.json|PLAN", value_parser = existing_path())]
    input: PathBuf,
    /// The format, in place of the one that the ending of the file names
    #[arg(long, value_name = "FORMAT", value_parser = PossibleValuesParser::new(formats()))]
    to: Option<String>,
    /// The file to write, whose ending names the format; for a plan a folder, or a file for one run or --campaign
    #[arg(long, short, value_name = "OUTPUT")]
    output: PathBuf,
    #[command(flatten)]
    plan: PlanArguments,
}

/// The formats of both tables, with what they hold, for help and errors.
fn formats() -> Vec<PossibleValue> {
    let all = of_results().chain(of_plans());
    let mut names: Vec<&str> = all.map(|(name, _)| name).collect();
    names.sort_unstable();
    names.dedup();
    let value = |name| PossibleValue::new(name).help(described(name));
    names.into_iter().map(value).collect()
}

fn of_results() -> impl Iterator<Item = (&'static str, String)> {
    let formats = EXPORTS.iter();
    formats.map(|format| (format.name, format!("Of a result: {}", format.describes)))
}

fn of_plans() -> impl Iterator<Item = (&'static str, String)> {
    let formats = PLAY_FORMATS.iter();
    formats.map(|format| (format.name, format!("Of a plan: {}", format.describes)))
}

/// What a format holds, of results and of plans.
fn described(name: &str) -> String {
    let mut texts = Vec::new();
    for (other, text) in of_results().chain(of_plans()) {
        if other == name {
            texts.push(text);
        }
    }
    texts.join(". ")
}

/// The ending of a file, in words.
fn ending(path: &Path) -> String {
    match path.extension() {
        Some(ending) => format!("the ending .{}", ending.display()),
        None => "no ending".into(),
    }
}

/// A format that is not one of those for this kind of file.
fn unfit(to: &str, found: &str, names: &str) -> Failure {
    Failure::usage(format!(
        "--to {to}: found {found}, whose formats are {names}; choose one of these"
    ))
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    check(&arguments.input, Needed::Exportable)?;
    match FileKind::of(&arguments.input) {
        Ok(FileKind::Plan | FileKind::Recording | FileKind::Text | FileKind::Empty) => {
            plan::run(arguments, options, console)
        }
        _ => result::run(arguments, options, console),
    }
}
