//! `frfid man`: manual pages from the same text as the help.

use std::io::{self, Write};

use clap::Args;
use clap_mangen::Man;

use crate::console::Console;
use crate::exit::{Exit, Failure};

/// Print the manual page of frfid or of one of its commands
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid man | man -l -
  frfid man run > frfid-run.1")]
pub(crate) struct Arguments {
    /// The command; frfid itself without it
    command: Option<String>,
}

/// `frfid` is the whole command line.
pub(crate) fn run(
    arguments: &Arguments,
    mut frfid: clap::Command,
    console: &mut Console,
) -> Result<Exit, Failure> {
    frfid.build();
    let command = match &arguments.command {
        None => frfid,
        Some(name) => match frfid.find_subcommand(name) {
            Some(command) => command.clone(),
            None => return Err(no_command(name, &frfid)),
        },
    };
    let page = page(command).map_err(|error| Failure::failed(&error))?;
    console.data(&String::from_utf8_lossy(&page))?;
    Ok(Exit::Done)
}

fn no_command(name: &str, frfid: &clap::Command) -> Failure {
    let names: Vec<_> = frfid
        .get_subcommands()
        .map(clap::Command::get_name)
        .collect();
    Failure::usage(format!(
        "no command is called `{name}`; there are {}",
        names.join(", ")
    ))
}

/// The page: examples, which the help begins with, follow the description here, as manual pages
/// have it.
fn page(command: clap::Command) -> io::Result<Vec<u8>> {
    let examples = command
        .get_before_help()
        .map(ToString::to_string)
        .unwrap_or_default();
    let is_frfid = command.has_subcommands();
    let (man, mut page) = (Man::new(command), Vec::new());
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    writeln!(page, ".SH EXAMPLES\n.nf\n{}\n.fi", verbatim(&examples))?;
    man.render_options_section(&mut page)?;
    if is_frfid {
        man.render_subcommands_section(&mut page)?;
        man.render_extra_section(&mut page)?;
    }
    Ok(page)
}

/// The lines of examples without their heading, roff's own characters escaped.
fn verbatim(examples: &str) -> String {
    let lines = examples
        .lines()
        .skip(1)
        .map(|line| line.trim_start().replace('\\', "\\e").replace('-', "\\-"));
    lines.collect::<Vec<_>>().join("\n")
}
