//! `frfid export`: a result for other tools.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use frfid_files::{EXPORTS, Export, read_result};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, existing_path};

/// Write a result for other tools
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid export frf.json --to csv -o frf.csv
  frfid export frf.json --to npz -o frf.npz     then numpy.load(\"frf.npz\")[\"response\"]")]
pub(crate) struct Arguments {
    /// Result of frfid estimate
    #[arg(value_name = "RESULT.json", value_parser = existing_path())]
    result: PathBuf,
    /// The format
    #[arg(long, value_name = "FORMAT", value_parser = export())]
    to: &'static Export,
    /// The file to write
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

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let (result, output) = (read_result(&arguments.result)?, &arguments.output);
    (arguments.to.write)(output, options.overwrite(), &result)?;
    if options.json {
        console.json(&json!({ "output": output }))?;
    }
    console.wrote(output);
    Ok(Exit::Done)
}
