//! `frfid init`: a description of an experiment to start from.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use frfid_experiment::{TEMPLATES, Template};
use frfid_files::write_bytes;
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::Options;

/// Write a description of an experiment to start from
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid init multisine -o experiment.toml
  frfid init chirp                          to look at it first")]
pub(crate) struct Arguments {
    /// Which kind of experiment
    #[arg(value_parser = kinds())]
    kind: &'static Template,
    /// The file to write; stdout without it
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

fn kinds() -> impl TypedValueParser<Value = &'static Template> {
    let kinds = TEMPLATES.map(|template| PossibleValue::new(template.kind).help(template.purpose));
    PossibleValuesParser::new(kinds)
        .try_map(|kind| Template::named(&kind).ok_or("there is no such template"))
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let text = arguments.kind.text();
    match &arguments.output {
        None => console.data(&text)?,
        Some(path) => {
            write_bytes(path, options.overwrite(), text.as_bytes())?;
            if options.json {
                console.json(&json!({ "output": path }))?;
            }
            console.wrote(path);
            console.hint(format_args!("frfid check {}", path.display()));
        }
    }
    Ok(Exit::Done)
}
