//! `frfid completions`: a script that completes commands and options in a shell.

use clap::Args;
use clap_complete::{Shell, generate};

use crate::console::Console;
use crate::exit::{Exit, Failure};

/// Print a shell's completion script
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid completions bash > ~/.local/share/bash-completion/completions/frfid
  frfid completions zsh > \"${fpath[1]}/_frfid\"
  frfid completions fish > ~/.config/fish/completions/frfid.fish")]
pub(crate) struct Arguments {
    /// The shell
    shell: Shell,
}

/// `frfid` is the whole command line.
pub(crate) fn run(
    arguments: &Arguments,
    mut frfid: clap::Command,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let mut script = Vec::new(); // the generator panics on a broken pipe, so it never gets to see one
    generate(arguments.shell, &mut frfid, "frfid", &mut script);
    console.data(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}
