//! `frfid export`: a result for other tools.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use frfid_files::{EXPORTS, Export, read_result};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::options::{Options, existing_path};

/// Write a result for other tools
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid export frf.json -o frf.csv
  frfid export frf.json -o frf.npz              then numpy.load(\"frf.npz\")[\"response\"]
  frfid export frf.json --to csv -o frf.txt     another ending than the format's")]
pub(crate) struct Arguments {
    /// Result of frfid estimate
    #[arg(value_name = "RESULT.json", value_parser = existing_path())]
    result: PathBuf,
    /// The format, in place of the one that the ending of the file names
    #[arg(long, value_name = "FORMAT", value_parser = export())]
    to: Option<&'static Export>,
    /// The file to write; its ending names the format
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

/// The formats of the table, with what they hold, for help and errors.
fn export() -> impl TypedValueParser<Value = &'static Export> {
    let known = EXPORTS
        .iter()
        .map(|export| PossibleValue::new(export.name).help(export.describes));
    PossibleValuesParser::new(known).try_map(|name| {
        let export = EXPORTS.iter().find(|export| export.name == name);
        export.ok_or("an unknown format")
    })
}

/// The format that is asked for and that of the ending, which must not contradict each other.
fn format(to: Option<&'static Export>, output: &Path) -> Result<&'static Export, Failure> {
    let (path, named) = (output.display(), Export::of_suffix(output));
    match (to, named) {
        (Some(to), Some(named)) if to.name != named.name => Err(Failure::usage(format!(
            "--to {} and {path} contradict each other: .{} is the ending of another format; leave --to out, or choose another name",
            to.name, named.name
        ))),
        (Some(format), _) | (None, Some(format)) => Ok(format),
        (None, None) => Err(Failure::usage(format!(
            "{path}: found {}, needed: {}; name the file so, or say --to FORMAT",
            ending(output),
            endings()
        ))),
    }
}

/// The ending of a file, in words.
fn ending(path: &Path) -> String {
    match path.extension() {
        Some(ending) => format!("the ending .{}", ending.display()),
        None => "no ending".into(),
    }
}

/// Endings of all formats: `.csv, .npz or .mat`.
fn endings() -> String {
    let names = EXPORTS.map(|export| format!(".{}", export.name));
    let (last, others) = names.split_last().expect("there are formats");
    format!("{} or {last}", others.join(", "))
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let output = &arguments.output;
    let format = format(arguments.to, output)?;
    options.check_free(output)?;
    check(&arguments.result, Needed::Result)?;
    let result = read_result(&arguments.result)?;
    (format.write)(output, options.overwrite(), &result)?;
    if options.json {
        console.json(&json!({ "output": output }))?;
    }
    console.wrote(output);
    Ok(Exit::Done)
}
