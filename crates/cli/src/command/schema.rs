//! `frfid schema`: the JSON Schema of `experiment.toml`.

use clap::Args;

use crate::console::Console;
use crate::exit::{Exit, Failure};

/// Print the JSON Schema of experiment.toml, with which editors complete and check it
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid schema > experiment.schema.json
  # then, as the first line of experiment.toml:
  #:schema ./experiment.schema.json")]
pub(crate) struct Arguments {}

pub(crate) fn run(_: &Arguments, console: &mut Console) -> Result<Exit, Failure> {
    console.json(&frfid_experiment::schema())?;
    Ok(Exit::Done)
}
