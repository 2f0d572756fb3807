//! Arguments of the command line as a whole: its help and its commands.

use std::ffi::OsString;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::command::{
    check, compare, completions, demo, design, estimate, export, import, init, inspect, man,
    recover, report, run, schema, shape,
};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::Options;

/// Examples first: they say most in the least time.
const HELP: &str = "{about}\n\n{before-help}{usage-heading} {usage}\n\n{all-args}{after-help}";

/// Frequency response functions of flexible-joint robots and positioning machines, by experiment.
#[derive(Debug, Parser)]
#[command(
    name = "frfid",
    bin_name = "frfid",
    version,
    max_term_width = 100,
    disable_help_subcommand = true,
    before_help = "\
Examples:
  frfid demo -o demo                        the example of the paper, with figures and a report
  frfid init multisine -o experiment.toml   a description to start from
  frfid check experiment.toml               is it sound, and what will it cost?
  frfid design experiment.toml -o plan.mcap
  frfid run plan.mcap -o logs
  frfid estimate logs -o frf.json --report frf.html
  frfid inspect robot.mcap                  what is in it, and what would be made of it
  frfid shape closed_loop.toml -o shaped    a chirp in closed loop, shaped to the desired torque
  frfid compare frf.json other.json",
    after_help = "\
Data go to stdout, messages to stderr. Nothing is overwritten without --force.
Exit codes: 0 done, 1 failed, 2 usage, description or input, 3 done but data was lost or a check failed, 130 interrupted."
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub options: Options,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Arguments),
    Init(init::Arguments),
    Inspect(Box<inspect::Arguments>),
    Check(check::Arguments),
    Schema(schema::Arguments),
    Design(design::Arguments),
    Run(run::Arguments),
    Import(Box<import::Arguments>),
    Shape(shape::Arguments),
    Estimate(Box<estimate::Arguments>),
    Compare(compare::Arguments),
    Report(report::Arguments),
    Export(export::Arguments),
    Recover(recover::Arguments),
    Completions(completions::Arguments),
    Man(man::Arguments),
}

impl Arguments {
    /// Reads the arguments, the first one being the program's name.
    pub(crate) fn parse(args: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        Self::from_arg_matches(&command().try_get_matches_from(args)?)
    }

    /// Does what the arguments say.
    pub(crate) fn run(&self, console: &mut Console) -> Result<Exit, Failure> {
        let options = &self.options;
        match &self.command {
            Command::Demo(arguments) => demo::run(arguments, options, console),
            Command::Init(arguments) => init::run(arguments, options, console),
            Command::Inspect(arguments) => inspect::run(arguments, options, console),
            Command::Check(arguments) => check::run(arguments, options, console),
            Command::Schema(arguments) => schema::run(arguments, console),
            Command::Design(arguments) => design::run(arguments, options, console),
            Command::Run(arguments) => run::run(arguments, options, console),
            Command::Import(arguments) => import::run(arguments, options, console),
            Command::Shape(arguments) => shape::run(arguments, options, console),
            Command::Estimate(arguments) => estimate::run(arguments, options, console),
            Command::Compare(arguments) => compare::run(arguments, options, console),
            Command::Report(arguments) => report::run(arguments, options, console),
            Command::Export(arguments) => export::run(arguments, options, console),
            Command::Recover(arguments) => recover::run(arguments, options, console),
            Command::Completions(arguments) => completions::run(arguments, command(), console),
            Command::Man(arguments) => man::run(arguments, command(), console),
        }
    }
}

/// The whole command line, for parsing, completions and manual pages.
pub(crate) fn command() -> clap::Command {
    Arguments::command()
        .help_template(HELP)
        .mut_subcommands(|command| command.help_template(HELP))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_holds_together() {
        command().debug_assert();
    }
}
