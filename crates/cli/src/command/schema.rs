//! `frfid schema`: the JSON Schema of `experiment.toml`, of robot files and of log maps.

use clap::{Args, ValueEnum};
use frfid_experiment::{map_schema, robot_schema, schema};

use crate::console::Console;
use crate::exit::{Exit, Failure};

/// Print the JSON Schema of experiment.toml, a robot file or a log map, with which editors complete
/// and check it
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid schema > experiment.schema.json
  frfid schema robot > robot.schema.json
  # then, as the first line of experiment.toml:
  #:schema ./experiment.schema.json")]
pub(crate) struct Arguments {
    /// The file that is described
    #[arg(value_name = "FILE", default_value = "experiment")]
    file: Described,
}

/// A file with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Described {
    /// The description of an experiment
    Experiment,
    /// A robot file, which a description names
    Robot,
    /// A log map, for frfid estimate --map
    Map,
}

pub(crate) fn run(arguments: &Arguments, console: &mut Console) -> Result<Exit, Failure> {
    console.document(&match arguments.file {
        Described::Experiment => schema(),
        Described::Robot => robot_schema(),
        Described::Map => map_schema(),
    })?;
    Ok(Exit::Done)
}
