//! `frfid export`: a result for other tools.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use frfid_files::{read_result, write_frf_csv, write_frf_npz};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, existing_path};

/// Write a result as a table (csv) or as numpy arrays (npz)
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
    #[arg(long, value_enum)]
    to: Format,
    /// The file to write
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// A row for each frequency, a column for each part of each entry
    Csv,
    /// Arrays for numpy, with covariances
    Npz,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let (result, output) = (read_result(&arguments.result)?, &arguments.output);
    match arguments.to {
        Format::Csv => write_frf_csv(output, options.overwrite(), &result)?,
        Format::Npz => write_frf_npz(output, options.overwrite(), &result.frf)?,
    }
    if options.json {
        console.json(&json!({ "output": output }))?;
    }
    console.note(format_args!("wrote {}", output.display()));
    Ok(Exit::Done)
}
